#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include "core/base/thread_pool.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/breakdown/run_diff.hpp"
#include "eval/cli/compare_kinds.hpp"
#include "eval/result/result_scans.hpp"
#include "eval/result/tell.hpp"
#include "eval/statistics/statistics_report.hpp"

namespace mosbench {
namespace {

/// Returns what the new run changes, paired scan by scan. Throws DataError unless both are under
/// one protocol, over the same scans and truth.
Answer paired_difference(const CompareFlags& options) {
  const ResultSet first = chosen_run(options, options.baseline);
  const ResultSet second = chosen_run(options, options.newer);
  PairedRuns paired = pair_runs(first, second);
  std::erase_if(paired.unlike,
                [](const Unlike& unlike) { return unlike.kind == Unlike::Kind::kSetting; });
  std::vector<Unlike> refused = paired.unlike;
  std::erase_if(refused, [](const Unlike& unlike) { return unlike.kind == Unlike::Kind::kPoses; });
  if (!refused.empty()) {
    throw DataError(second.path, "is not like " + first.path.string() + ": " + unlike_text(refused),
                    "the same protocol, scans and truth");
  }
  return difference_answer(first, second, paired);
}

/// Labels of a run for the scans of another one, found by their stems.
class LabelsByStem : public Predictions {
 public:
  LabelsByStem(const ResultScans& run, const Sequence& sequence) : run_(run), sequence_(sequence) {
    for (std::size_t k = 0; k < run.sequence().size(); ++k) scans_[run.sequence().stem(k)] = k;
  }
  bool has(std::size_t scan_index) const override {
    const auto scan = scans_.find(sequence_.stem(scan_index));
    return scan != scans_.end() && run_.has(scan->second);
  }
  std::vector<std::uint32_t> read(std::size_t scan_index) const override {
    return run_.labels().read(scans_.at(sequence_.stem(scan_index)));
  }

 private:
  const ResultScans& run_;
  const Sequence& sequence_;
  std::map<std::string, std::size_t> scans_;
};

[[noreturn]] void refuse_scan(const ResultScans& run, const char* why, const std::string& stem) {
  throw DataError(
      run.result().file,
      fmt::format("has {} for scan {} of sequence {}", why, stem, run.result().sequence.text()),
      "runs over the same scans and truth, to list objects of");
}

/// Returns the counted scans of the first run. Throws DataError unless their truth is what both
/// runs were scored by, and the second has labels of them.
std::vector<std::size_t> scans_of(const ResultScans& first, const Predictions& second,
                                  const Result& result) {
  std::set<std::string> counted;
  for (const ScanRow* row : counted_scans(result)) counted.insert(row->stem);
  std::vector<std::size_t> scans;
  for (const std::size_t k : first.scored_scans()) {
    const ScanRow& row = first.rows()[k];
    if (!counted.contains(row.stem)) continue;
    if (row.truth_hash && hash_of_labels(first.sequence().read_truth(k)) != row.truth_hash) {
      refuse_scan(first, "another truth", row.stem);
    }
    if (!second.has(k)) refuse_scan(first, "labels that the other run lacks", row.stem);
    scans.push_back(k);
  }
  return scans;
}

/// Both runs are broken down over the scans as the first one read them, with its poses.
std::vector<ObjectDisagreement> objects_of(const Result& first, const Result& second,
                                           const std::optional<std::filesystem::path>& root) {
  const ResultScans scans(first, root);
  const ResultScans others(second, root);
  const LabelsByStem labels(others, scans.sequence());
  const std::vector<std::size_t> counted = scans_of(scans, labels, first);
  const BreakdownTask task{first.protocol, first.range, hardware_threads()};
  return disagreeing_objects(break_down(scans.sequence(), counted, scans.labels(), task),
                             break_down(scans.sequence(), counted, labels, task));
}

/// The names of the sequences in --data.
std::set<std::string> sequences_in(const CompareFlags& options) {
  std::optional<DatasetKind> kind = dataset_kind_option(options.dataset);
  std::set<std::string> names;
  for (const SequenceFolder& found : find_sequences(*options.data, {kind}, kind)) {
    names.insert(found.name);
  }
  return names;
}

/// Without --data the scans are where the first run read them.
std::vector<ObjectDisagreement> objects_of(const CompareFlags& options, const ResultSet& first,
                                           const ResultSet& second) {
  const auto there = options.data ? std::optional(sequences_in(options)) : std::nullopt;
  std::vector<ObjectDisagreement> objects;
  bool any = false;
  for (const Result& result : first.sequences) {
    const auto other = std::ranges::find(second.sequences, result.sequence, &Result::sequence);
    if (counted_scans(result).empty() || other == second.sequences.end()) continue;
    if (there && !there->contains(result.sequence)) {
      tell(fmt::format("{}: has no sequence {}; its objects are left out", options.data->string(),
                       result.sequence.text()));
      continue;
    }
    any = true;
    std::ranges::move(objects_of(result, *other, options.data), std::back_inserter(objects));
  }
  if (any) return objects;
  throw DataError(options.data.value_or(options.newer),
                  "has none of the sequences that both runs hold",
                  "the data set of the runs in --data");
}

/// Without truth there are no right and wrong points to compare.
void check_has_truth(const ResultSet& run) {
  const bool scored = std::ranges::any_of(
      run.sequences, [](const Result& sequence) { return !counted_scans(sequence).empty(); });
  if (scored) return;
  throw DataError(run.front().file, "has no scan with truth, by which points are right or wrong",
                  "a run over labelled scans; the colour disagreement of mosbench report shows "
                  "where labels differ without truth");
}

/// Returns the scans or objects on which the runs disagree.
Answer scans_and_objects(const CompareFlags& options) {
  const ResultSet first = chosen_run(options, options.baseline);
  const ResultSet second = chosen_run(options, options.newer);
  for (const ResultSet* run : {&first, &second}) check_has_truth(*run);
  const PairedRuns paired = pair_runs(first, second);
  check_shares_scans(paired, options);
  const auto objects = options.shows("object") ? objects_of(options, first, second)
                                               : std::vector<ObjectDisagreement>{};
  return {.standing = standing_of(first, "first", second, "second"),
          .sheets = diff_sheets(options.baseline, options.newer, paired, objects, options.top),
          .json = json_text(diff_json(paired, objects, options.top))};
}

}  // namespace

Answer difference_by(const CompareFlags& options) {
  if (!options.shows("sequence")) return scans_and_objects(options);
  if (options.by.size() == 1) return paired_difference(options);
  throw UsageError("--by sequence: goes with nothing else, expected it alone, or scan,object");
}

}  // namespace mosbench
