#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <memory>

#include "core/base/thread_pool.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/breakdown/run_diff.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/dataset_flags.hpp"
#include "eval/results/tell.hpp"
#include "eval/runs/run_plan.hpp"

namespace mosbench {
namespace {

constexpr const char* kDiffFooter =
    R"(Lists the scans whose counts differ between two runs, most changed first. With --data it also lists
the moving objects of which they find different parts; A and B then must hold label files, as the
folders of `mosbench run` do, and the data set must hold the truth that was scored.

Examples:
  mosbench diff results/runs/online results/runs/delayed
  mosbench diff results/runs/online results/runs/delayed --data ~/kitti --top 20 --json)";

struct DiffFlags {
  std::filesystem::path first, second;
  std::optional<std::filesystem::path> root;
  std::string dataset = "auto";
  std::size_t top = 10;
  bool json = false;
};

/// Returns null, and says so on stderr, when the data set does not have it.
const Sequence* sequence_named(const Dataset& dataset, const std::string& name) {
  for (const auto& sequence : dataset.sequences) {
    if (sequence->name() == name) return sequence.get();
  }
  tell(
      fmt::format("{}: has no sequence {}; its objects are left out", dataset.root.string(), name));
  return nullptr;
}

/// Returns the counted scans of a result. Throws DataError unless they have the truth that was
/// scored.
std::vector<std::size_t> scans_of(const Dataset& dataset, const Sequence& sequence,
                                  const SequenceResult& result) {
  std::map<std::string, std::size_t> labelled;
  for (const std::size_t k : scans_with_truth(sequence)) labelled[sequence.stem(k)] = k;
  std::vector<std::size_t> scans;
  for (const ScanRow* row : counted_scans(result)) {
    const auto scan = labelled.find(row->stem);
    const auto refuse = [&](const char* what) {
      throw DataError(
          dataset.root,
          fmt::format("has {} for scan {} of sequence {}", what, row->stem, sequence.name()),
          "the data set of the runs in --data");
    };
    if (scan == labelled.end()) refuse("no truth");
    if (row->truth_hash && hash_of_labels(sequence.read_truth(scan->second)) != row->truth_hash) {
      refuse("another truth");
    }
    scans.push_back(scan->second);
  }
  return scans;
}

/// Throws DataError unless labels are those that a run wrote and counted.
void check_labels(const Sequence& sequence, const std::vector<std::size_t>& scans,
                  const OpenedPredictions& opened, const SequenceResult& result) {
  // Results of `mosbench score` do not say what its labels were.
  if (result.header.contains("predictions")) return;
  for (const std::size_t k : scans) {
    const auto row = std::ranges::find(result.scans, sequence.stem(k), &ScanRow::stem);
    if (row == result.scans.end() || are_labels_of(*row, opened.labels->read(k))) continue;
    throw DataError(opened.path / (row->stem + ".label"), "does not give the counts in result.json",
                    "the label file of that run");
  }
}

SequenceBreakdown break_down_run(const Sequence& sequence, const std::vector<std::size_t>& scans,
                                 const ResultSet& run, const BreakdownTask& task) {
  const bool only_sequence = run.sequences.size() == 1;
  const OpenedPredictions opened = open_predictions(run.path, sequence, scans, only_sequence, {});
  const auto result = std::ranges::find(run.sequences, sequence.name(),
                                        [](const auto& one) { return one.sequence.text(); });
  check_labels(sequence, scans, opened, *result);
  return break_down(sequence, scans, *opened.labels, task);
}

std::vector<ObjectDisagreement> objects_of(const DiffFlags& options, const ResultSet& first,
                                           const ResultSet& second) {
  const Dataset dataset =
      open_dataset(*options.root, {dataset_kind_option(options.dataset), {}, {}});
  const BreakdownTask task{first.front().protocol, first.front().range, hardware_threads()};
  std::vector<ObjectDisagreement> objects;
  bool any = false;
  for (const SequenceResult& result : first.sequences) {
    const bool in_both = std::ranges::find(second.sequences, result.sequence,
                                           &SequenceResult::sequence) != second.sequences.end();
    if (counted_scans(result).empty() || !in_both) continue;
    const Sequence* sequence = sequence_named(dataset, result.sequence);
    if (sequence == nullptr) continue;
    any = true;
    const std::vector<std::size_t> scans = scans_of(dataset, *sequence, result);
    for (ObjectDisagreement& object :
         disagreeing_objects(break_down_run(*sequence, scans, first, task),
                             break_down_run(*sequence, scans, second, task))) {
      objects.push_back(std::move(object));
    }
  }
  if (any) return objects;
  throw DataError(dataset.root, "has none of the sequences that both runs hold",
                  "the data set of the runs in --data");
}

/// Without truth there are no right and wrong points to compare.
void check_has_truth(const ResultSet& run) {
  const bool scored = std::ranges::any_of(run.sequences, [](const SequenceResult& sequence) {
    return !counted_scans(sequence).empty();
  });
  if (scored) return;
  throw DataError(run.front().file, "has no scan with truth, by which points are right or wrong",
                  "a run over labelled scans; the colour disagreement of mosbench report shows "
                  "where labels differ without truth");
}

std::string diff(const DiffFlags& options) {
  const ResultSet first = load_result_set(options.first);
  const ResultSet second = load_result_set(options.second);
  for (const ResultSet* run : {&first, &second}) check_has_truth(*run);
  const PairedRuns paired = pair_runs(first, second);
  if (paired.scans.empty()) {
    throw DataError(options.second, "shares no counted scan with " + options.first.string(),
                    "results over the same scans");
  }
  const auto objects =
      options.root ? objects_of(options, first, second) : std::vector<ObjectDisagreement>{};
  if (!options.json) {
    return diff_text(names_apart(options.first, options.second), paired, objects, options.top);
  }
  return json_text(diff_json(paired, objects, options.top));
}

}  // namespace

CommandRun add_diff(CLI::App& command) {
  auto options = std::make_shared<DiffFlags>();
  command.add_option("A", options->first, "Results of a run")->type_name("DIR")->required();
  command.add_option("B", options->second, "Results of another run")->type_name("DIR")->required();
  command.add_option("--data", options->root, "Data set of both; also lists objects")
      ->type_name("DIR");
  add_dataset_kind_flag(command, options->dataset);
  command.add_option("--top", options->top, "How many scans and objects to list")
      ->capture_default_str();
  command.add_flag("--json", options->json, "Print JSON instead of tables");
  command.footer(kDiffFooter);
  return [options] { return Answer{diff(*options)}; };
}

}  // namespace mosbench
