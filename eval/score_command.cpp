#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "datasets/errors.hpp"
#include "eval/benchmark_split.hpp"
#include "eval/commands.hpp"
#include "eval/prediction_files.hpp"
#include "eval/presets.hpp"
#include "eval/run_plan.hpp"
#include "eval/score_table.hpp"
#include "eval/simulated.hpp"

namespace mosbench {
namespace {

constexpr const char* kFooter =
    R"(Prints the numbers of `mosbench run` for label files of any origin. They are looked for in
DIR/<sequence>/{predictions,labels}, DIR/sequences/<sequence>/predictions and, for one sequence,
DIR/{predictions,labels} and DIR itself; scan <stem>.bin belongs to <stem>.label. Every scan with truth
needs one; a missing file, one of the wrong size or one without scan is an error. Under a protocol
that is over a split of scans (helimos-test, mapmos) only those scans are scored.

Examples:
  mosbench score ~/sipailou-livox-kitti --predictions motionbev --protocol sipailou --split test
  mosbench score ~/doals --predictions results/runs/doals --protocol doals-dynablox --range 0.5,20
  mosbench score ~/kitti/sequences/08 --predictions mapmos/sequences/08/predictions --json)";

struct ScoreOptions {
  std::filesystem::path input;
  std::filesystem::path predictions;
  std::string dataset = "auto";
  std::vector<std::string> sequences;
  std::optional<std::string> protocol, range, split;
  bool json = false;
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

/// Which scans of a sequence have to be scored: those of the chosen split or of the split that the
/// protocol picks scans by, else all.
bool is_wanted(const ScoreOptions& options, const Dataset& dataset, const Protocol& protocol,
               std::size_t position, const std::string& stem) {
  if (!options.split && benchmark_scans(protocol, dataset.splits) == nullptr) return true;
  const auto stems = stems_in_split(dataset.splits.front(), position);
  return !stems || stems->contains(stem);
}

Confusion score_one(const Sequence& sequence, std::size_t k, const Protocol& protocol,
                    const RangeGate& range, const PredictionFolder& predictions) {
  if (protocol.range_rule == RangeRule::kNone) {
    const std::vector<std::uint32_t> truth = sequence.read_truth(k);
    return score_scan(protocol, truth, predictions.read(sequence.stem(k), truth.size()), {}, range);
  }
  const Frame frame = sequence.read(k);
  return score_scan(protocol, frame.truth.value(),
                    predictions.read(frame.stem, frame.points.size()), frame.points, range);
}

ScoredSequence score_sequence(const ScoreOptions& options, const Dataset& dataset,
                              std::size_t position, const Protocol& protocol,
                              const RangeGate& range) {
  const Sequence& sequence = *dataset.sequences[position];
  std::vector<std::size_t> wanted;
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    if (sequence.has_truth(k) &&
        is_wanted(options, dataset, protocol, position, sequence.stem(k))) {
      wanted.push_back(k);
    }
  }
  ScoredSequence scored{sequence.name(), {}, std::nullopt};
  if (wanted.empty()) return scored;
  const PredictionFolder predictions =
      find_predictions(options.predictions, sequence, dataset.sequences.size() == 1);
  predictions.check(sequence, wanted);
  for (const std::size_t k : wanted) {
    scored.scans.push_back(
        {sequence.stem(k), score_one(sequence, k, protocol, range, predictions)});
  }
  return scored;
}

std::string score(const ScoreOptions& options) {
  Dataset dataset =
      open_dataset(options.input, {dataset_kind_option(options.dataset), options.sequences, {}});
  const Protocol& protocol =
      protocol_named(options.protocol.value_or(std::string(default_preset(dataset.kind).protocol)));
  const RangeGate range =
      options.range ? range_option(*options.range, protocol) : protocol.default_range;
  if (options.split) {
    keep_split(*options.split, dataset);
  } else if (benchmark_scans(protocol, dataset.splits) != nullptr) {
    keep_split(std::string(protocol.default_split), dataset);
  }
  std::vector<ScoredSequence> sequences;
  std::size_t scored_scans = 0;
  for (std::size_t i = 0; i < dataset.sequences.size(); ++i) {
    sequences.push_back(score_sequence(options, dataset, i, protocol, range));
    scored_scans += sequences.back().scans.size();
  }
  if (scored_scans == 0) {
    throw DataError(dataset.root, "no scan to score has truth", "labels beside the scans");
  }
  std::vector<ScoreRow> rows = score_rows(protocol, dataset.splits, sequences);
  if (options.split) {
    std::erase_if(rows, [](const ScoreRow& row) { return row.kind == ScoreRow::Kind::kSequence; });
  }
  if (options.json) {
    nlohmann::ordered_json json = {{"dataset", std::string(to_string(dataset.kind))},
                                   {"protocol", std::string(protocol.name)},
                                   {"min_range_m", range.min_m},
                                   {"max_range_m", range.max_m}};
    if (const auto origin = simulated_origin_json(dataset)) json["simulated"] = *origin;
    json.update(rows_json(rows));
    return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
  }
  return fmt::format("protocol {}: {}\n{}{}\n{}", protocol.name, protocol.summary,
                     benchmark_notice(protocol, dataset.splits), simulated_notice(dataset),
                     format_rows(protocol, rows));
}

}  // namespace

void add_score_command(CLI::App& app, std::string& answer) {
  auto options = std::make_shared<ScoreOptions>();
  CLI::App* command = app.add_subcommand("score", "Score label files of any origin");
  command->add_option("DATA", options->input, "Root of a data set, or one sequence folder")
      ->required();
  command->add_option("--predictions", options->predictions, "Folder of the label files")
      ->required();
  command->add_option("--protocol", options->protocol, "How to score (default: by data set)");
  command
      ->add_option("--dataset", options->dataset, "auto, doals, sipailou, helimos or semantickitti")
      ->capture_default_str();
  command->add_option("--sequences", options->sequences, "Names to score, a,b (default: all)")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--split", options->split, "Only the scans of this split");
  command->add_option("--range", options->range,
                      "MIN,MAX in metres, for protocols that limit it (default: the protocol's)");
  command->add_flag("--json", options->json, "Print JSON instead of a table");
  command->footer(kFooter);
  command->callback([options, &answer] { answer = score(*options); });
}

}  // namespace mosbench
