#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "core/base/thread_pool.hpp"
#include "datasets/disk/claim.hpp"
#include "datasets/doctor/doctor.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/protocols/benchmark_split.hpp"
#include "eval/result/machine.hpp"
#include "eval/static_map/map_score.hpp"
#include "eval/tables/score_report.hpp"

namespace mosbench {
namespace {

struct ScoreFlags : DataWords {
  ScoreTask task;
  std::optional<std::string> protocol, range, format, id_map;
  std::optional<std::string> method;
  std::optional<std::filesystem::path> out;
  bool overwrite = false;
  std::optional<std::filesystem::path> map;  ///< cleaned of what moved, instead of predictions
  double same_within_m = kSameWithin_m;
};

void keep_split(const std::string& name, Dataset& dataset) {
  std::string known;
  for (const Split& split : dataset.splits) {
    if (split.name == name) {
      dataset.splits = {Split(split)};
      return;
    }
    known += (known.empty() ? "" : ", ") + split.name;
  }
  throw UsageError(fmt::format("--split: '{}' is not in {}, expected {}", name,
                               dataset.root.string(), known.empty() ? "no --split" : known));
}

/// Reads "label-masked:MIN,MAX", "dynablox-clouds:LEVEL", "dynablox:LEVEL" for any file of
/// Dynablox, or the name of a format alone.
void take_format(const std::string& text, PredictionOptions& options) {
  const std::size_t colon = text.find(':');
  const std::string name = text.substr(0, colon);
  const std::string more = colon == std::string::npos ? "" : text.substr(colon + 1);
  // With a range, and as any file of Dynablox, the format is recognised.
  if (!more.empty() && name == describe(PredictionFormat::kMaskedLabel).name) {
    options.mask = parsed_range(more);
    return;
  }
  if (more.empty() || name != "dynablox") options.format = prediction_format_named(name);
  if (more.empty()) return;
  if (name.starts_with("dynablox")) {
    options.level = dynablox_level_named(more);
  } else {
    throw UsageError(
        fmt::format("--format {}: format {} takes nothing behind a colon", text, name));
  }
}

/// "4DMOS, delayed" is a method and its setting.
MethodName method_name(const std::string& text) {
  const std::size_t comma = text.find(", ");
  if (comma == std::string::npos) return {text, ""};
  return {text.substr(0, comma), text.substr(comma + 2)};
}

std::vector<ScoreRule> all_rules(const std::optional<std::string>& range) {
  std::vector<ScoreRule> rules;
  for (const Protocol& protocol : protocols()) {
    rules.push_back(
        rule_of(protocol, protocol.range_rule != RangeRule::kNone ? range : std::nullopt));
  }
  return rules;
}

/// Returns the split to score, or nothing for all scans. A protocol that is over the scans of a
/// split takes no other.
std::optional<std::string> settle_split(const ScoreTask& task, const Dataset& dataset) {
  const Protocol& protocol = *task.rules.front().protocol;
  const Split* benchmark = benchmark_scans(protocol, dataset.splits);
  if (benchmark == nullptr) return task.split;
  if (!task.split || *task.split == benchmark->name) return benchmark->name;
  throw UsageError(
      fmt::format("--split: '{}' is not the split of protocol {}, expected {}, or a protocol over "
                  "all labelled scans (`mosbench list protocols`)",
                  *task.split, protocol.name, benchmark->name));
}

PredictionOptions prediction_options(const ScoreFlags& options) {
  PredictionOptions settled = options.task.options;
  if (options.format) take_format(*options.format, settled);
  if (options.id_map) settled.id_map = parse_id_map(*options.id_map);
  return settled;
}

Answer score_all(const ScoreFlags& options, const Dataset& dataset, ScoreTask task) {
  if (options.out)
    throw UsageError("--out: keeps the results of one protocol, expected no --protocol all");
  task.rules = all_rules(options.range);
  const std::vector<SequenceScores> scores = score_dataset(dataset, task);
  return side_by_side_answer(dataset, task.rules, scores);
}

Answer score_of_map(const ScoreFlags& options) {
  const MapScore score = score_map(*options.map, options.input, options.same_within_m);
  return {.sheets = {map_score_sheet(score)}, .json = json_text(map_score_json(score))};
}

Answer score(const ScoreFlags& options) {
  if (options.map) return score_of_map(options);
  if (options.task.predictions.empty()) {
    throw UsageError("--predictions is required, or --map; see mosbench score --help");
  }
  keep_freed_memory();
  Dataset dataset = open_dataset(options);
  ScoreTask task = options.task;
  task.options = prediction_options(options);
  for (const auto& sequence : dataset.sequences) add_doubts_of_scans(dataset.kind, *sequence);
  if (options.protocol == "all") {
    if (task.split) keep_split(*task.split, dataset);
    return score_all(options, dataset, std::move(task));
  }
  task.rules = {rule_of(options.protocol, options.range, dataset.kind)};
  const bool split_asked = task.split.has_value();
  task.split = settle_split(task, dataset);
  if (task.split) keep_split(*task.split, dataset);
  std::optional<FolderLock> lock;
  if (options.out) {
    lock.emplace(*options.out);
    check_scored_folders(dataset, *options.out);
  }
  const std::vector<SequenceScores> scores = score_dataset(dataset, task);
  if (options.out) {
    const auto method = options.method ? std::optional(method_name(*options.method)) : std::nullopt;
    write_scores(dataset, options.reading, task, method, scores, *options.out, options.overwrite);
  }
  return score_answer(dataset, task, scores, !split_asked);
}

void add_prediction_options(CLI::App& command, ScoreFlags& options) {
  add(command, "--predictions PATH", options.task.predictions, "Folder or file of predictions");
  add(command, "--map FILE", options.map,
      "Score a map that was cleaned of what moved, instead of predictions; DATA then holds "
      "its points with intensity 1 where they are dynamic");
  add(command, "--same-within-m", options.same_within_m,
      "Largest distance of a point of the map that stands for one of the truth, m")
      ->check(number_in(1e-6, 1e3))
      ->capture_default_str()
      ->group(kRareGroup);
  add(command, "--format FORMAT", options.format,
      "Format of the predictions (default: recognised); label-masked:MIN,MAX also says "
      "within which range in metres the labels are, dynablox:LEVEL which column counts "
      "(point, cluster or object)");
  add(command, "--id-map MAP", options.id_map,
      "Meaning of the predicted ids, such as 0:0,1:9,2:251");
  command.add_flag("--allow-missing", options.task.options.allow_missing,
                   "Leave out scans whose prediction is missing or faulty; marks the result");
}

}  // namespace

CommandRun add_score(CLI::App& command) {
  auto options = std::make_shared<ScoreFlags>();
  options->task.threads = hardware_threads();
  add_dataset_flags(command, *options);
  add_prediction_options(command, *options);
  add(command, "--protocol PROTOCOL", options->protocol,
      "How to score, or all (default: by data set)");
  add(command, "--split NAME", options->task.split, "Only the scans of this split");
  add(command, "--range MIN,MAX", options->range,
      "In metres, for protocols that limit it (default: that of the protocol)");
  add(command, "--method NAME", options->method,
      "Name of the method, kept by --out; \"NAME, SETTING\" also keeps its setting (default: that "
      "of the run that wrote the labels)");
  add(command, "--out DIR", options->out, "Write DIR/<sequence>/result.json");
  command.add_flag("--overwrite", options->overwrite, "Replace other scores in --out");
  add_threads_flag(command, options->task.threads);
  return [options] { return score(*options); };
}

}  // namespace mosbench
