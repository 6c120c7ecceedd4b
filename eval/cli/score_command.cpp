#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "core/base/thread_pool.hpp"
#include "datasets/disk/folder_lock.hpp"
#include "datasets/text/errors.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/dataset_flags.hpp"
#include "eval/cli/help_text.hpp"
#include "eval/engine/run_plan.hpp"
#include "eval/job/presets.hpp"
#include "eval/protocols/benchmark_split.hpp"
#include "eval/results/machine.hpp"
#include "eval/tables/score_report.hpp"

namespace mosbench {
namespace {

constexpr const char* kScoreFooter =
    R"(Scores the predictions of any method as `mosbench run` scores its own. They are searched for in
DIR/<sequence>/{predictions,labels}, DIR/<sequence>, DIR/sequences/<sequence>/predictions,
DIR/<sequence>.{txt,csv} and, for one sequence, DIR/{predictions,labels} and DIR itself, which may
be a file. The format is recognised and printed; `mosbench list formats` shows all. Every scan with
truth needs a prediction; a missing file, one of the wrong size or one without a scan is an error,
unless --allow-missing leaves such scans out and marks the result. Under a protocol that is over a
split of scans (helimos-test, mapmos), only those scans are scored and another --split is refused.

--protocol all prints the number of every protocol for the same labels, and why they differ.
--out writes result.json files, which stats, compare and table read.

Examples:
  mosbench score ~/sipailou-livox-kitti --predictions motionbev --protocol sipailou --split test
  mosbench score ~/doals --predictions results/runs/doals --protocol doals-dynablox --range 0.5,20
  mosbench score ~/doals/station/sequence_1 --predictions clouds.csv --level object
  mosbench score ~/HeLiMOS/KAIST05/Deskewed_LiDAR --predictions 4dmos --protocol helimos-test \
    --method 4DMOS --setting delayed --out results/runs/4dmos-delayed
  mosbench score ~/kitti/sequences/08 --predictions mapmos/08/predictions --mask 0,50 --json
  mosbench score ~/kitti/sequences/08 --predictions mine --protocol all)";

struct ScoreFlags {
  std::filesystem::path input;
  std::string dataset = "auto";
  std::vector<std::string> sequences;
  ScoreTask task;
  std::optional<std::string> protocol, range, format, mask, id_map;
  std::string level = "object";
  MethodName method{"unnamed", ""};
  ReadingOptions reading;
  std::optional<std::filesystem::path> out;
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

/// Reads MIN,MAX for any protocol.
RangeGate mask_option(const std::string& text) {
  return range_option(text, protocol_named("mapmos"));
}

std::vector<ScoreRule> all_rules(const ScoreFlags& options) {
  std::vector<ScoreRule> rules;
  for (const Protocol& protocol : protocols()) {
    const bool ranged = options.range && protocol.range_rule != RangeRule::kNone;
    rules.push_back(
        {&protocol, ranged ? range_option(*options.range, protocol) : protocol.default_range});
  }
  return rules;
}

ScoreRule one_rule(const ScoreFlags& options, const Dataset& dataset) {
  const Protocol& protocol =
      protocol_named(options.protocol.value_or(std::string(default_preset(dataset.kind).protocol)));
  return {&protocol,
          options.range ? range_option(*options.range, protocol) : protocol.default_range};
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
  if (options.format) settled.format = prediction_format_named(*options.format);
  if (options.mask) settled.mask = mask_option(*options.mask);
  if (options.id_map) settled.id_map = parse_id_map(*options.id_map);
  settled.level = dynablox_level_named(options.level);
  return settled;
}

Answer score_all(const ScoreFlags& options, const Dataset& dataset, ScoreTask task) {
  if (options.out)
    throw UsageError("--out: keeps the results of one protocol, expected no --protocol all");
  task.rules = all_rules(options);
  const std::vector<SequenceScores> scores = score_dataset(dataset, task);
  return side_by_side_answer(dataset, task.rules, scores);
}

Answer score(const ScoreFlags& options) {
  keep_freed_memory();
  Dataset dataset = open_dataset(
      options.input, {dataset_kind_option(options.dataset), options.sequences, options.reading});
  ScoreTask task = options.task;
  task.options = prediction_options(options);
  if (options.protocol == "all") {
    if (task.split) keep_split(*task.split, dataset);
    return score_all(options, dataset, std::move(task));
  }
  task.rules = {one_rule(options, dataset)};
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
    write_scores(dataset, options.reading, task, options.method, scores, *options.out);
  }
  return score_answer(dataset, task, scores, !split_asked);
}

void add_prediction_options(CLI::App& command, ScoreFlags& options) {
  command.add_option("--predictions", options.task.predictions, "Folder or file of predictions")
      ->type_name("PATH")
      ->required();
  command.add_option("--format", options.format, "Format of the predictions (default: recognised)")
      ->type_name("FORMAT");
  command
      .add_option("--mask", options.mask,
                  "Range in metres within which the method wrote labels (default: detected)")
      ->type_name("MIN,MAX");
  command
      .add_option("--id-map", options.id_map, "Meaning of the predicted ids, such as 0:0,1:9,2:251")
      ->type_name("MAP");
  command.add_option("--level", options.level, "Of Dynablox's files")
      ->type_name(type_of_names({"point", "cluster", "object"}))
      ->capture_default_str();
  command.add_flag("--allow-missing", options.task.options.allow_missing,
                   "Leave out scans whose prediction is missing or faulty; marks the result");
}

}  // namespace

CommandRun add_score(CLI::App& command) {
  auto options = std::make_shared<ScoreFlags>();
  options->task.threads = hardware_threads();
  add_dataset_flags(command, options->input, options->dataset, options->sequences,
                    options->reading);
  add_prediction_options(command, *options);
  command
      .add_option("--protocol", options->protocol, "How to score, or all (default: by data set)")
      ->type_name("PROTOCOL");
  command.add_option("--split", options->task.split, "Only the scans of this split")
      ->type_name("NAME");
  command
      .add_option("--range", options->range,
                  "In metres, for protocols that limit it (default: that of the protocol)")
      ->type_name("MIN,MAX");
  command.add_option("--method", options->method.name, "Name of the method, kept by --out")
      ->type_name("NAME");
  command.add_option("--setting", options->method.setting, "Setting of the method, kept by --out")
      ->type_name("TEXT");
  command.add_option("--out", options->out, "Write DIR/<sequence>/result.json")->type_name("DIR");
  add_threads_flag(command, options->task.threads);
  command.footer(kScoreFooter);
  return [options] { return score(*options); };
}

}  // namespace mosbench
