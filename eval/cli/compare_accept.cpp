#include <fmt/format.h>

#include "datasets/disk/claim.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/text/errors.hpp"
#include "eval/cli/compare_command.hpp"
#include "eval/statistics/paired_runs.hpp"
#include "eval/statistics/statistics_report.hpp"
#include "eval/store/store.hpp"

namespace mosbench {
namespace {

/// Says what changes against the baseline before.
Answer change(const CompareFlags& options, const ResultSet& newer) {
  const std::vector<ResultSet> known = accepted_runs(options.baseline);
  if (known.empty()) {
    return {.standing = standing_of(newer), .sheets = {{.lead = {"a new baseline"}}}};
  }
  if (known.size() > 1 && options.even_if) return {"several runs were there before\n"};
  // Of several runs, loading one names what they differ in.
  const ResultSet baseline = known.size() == 1 ? known.front() : load_result_set(options.baseline);
  const PairedRuns paired = pair_runs(baseline, newer);
  if (!paired.unlike.empty() && !options.even_if) {
    throw DataError(options.baseline,
                    "is a baseline of another kind than " + options.newer.string() + ": " +
                        unlike_text(paired.unlike),
                    "one of the same kind; --even-if replaces it anyway");
  }
  if (paired.scans.empty()) return {"no scan in common with the baseline before\n"};
  return difference_answer(baseline, newer, paired);
}

}  // namespace

Answer accepted(const CompareFlags& options) {
  const ResultSet newer = load_result_set(options.newer);
  refuse_overlap(newer, options.baseline);
  restore_folder(resolved(options.baseline));
  const FolderLock lock(options.baseline);
  Answer answer = change(options, newer);
  accept_baseline(newer, options.baseline);
  answer.text +=
      fmt::format("accepted {} as {}\n", options.newer.string(), options.baseline.string());
  return answer;
}

}  // namespace mosbench
