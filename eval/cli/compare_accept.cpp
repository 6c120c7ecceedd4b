#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <iterator>

#include "datasets/disk/claim.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/text/errors.hpp"
#include "eval/cli/compare_kinds.hpp"
#include "eval/statistics/statistics_report.hpp"
#include "eval/store/store.hpp"

namespace mosbench {
namespace {

/// Says what changes against the baseline before, over the chosen sequences.
Answer change(const CompareFlags& options, const ResultSet& newer,
              const std::vector<ResultSet>& known) {
  if (known.size() > 1 && options.even_if) return {"several runs were there before\n"};
  // Of several runs, loading one names what they differ in.
  ResultSet baseline = known.size() == 1 ? known.front() : load_result_set(options.baseline);
  std::erase_if(baseline.sequences,
                [&](const Result& result) { return !is_chosen(options, result.sequence); });
  if (baseline.sequences.empty()) return {"none of the sequences was in the baseline before\n"};
  const PairedRuns paired = pair_runs(baseline, newer);
  if (!paired.unlike.empty() && !options.even_if) {
    throw DataError(options.baseline,
                    "is a baseline of another kind than " + options.newer.string() + ": " +
                        unlike_text(paired.unlike),
                    "one of the same kind; --even-if replaces it anyway");
  }
  if (paired.scans.empty()) return {"no scan in common with the baseline before\n"};
  Answer answer = difference_answer(baseline, newer, paired);
  const GateResult result = judged(options, baseline, newer, paired);
  answer.sheets.push_back(gate_sheet(result));
  if (!result.costs.empty()) answer.sheets.push_back(cost_sheet(result));
  return answer;
}

/// A baseline is one run: sequences that stay must be of the kind of those that come.
void check_stays_one_run(const CompareFlags& options, const ResultSet& newer,
                         const std::vector<ResultSet>& known) {
  std::vector<Result> all = newer.sequences;
  for (const ResultSet& run : known) {
    std::ranges::copy_if(run.sequences, std::back_inserter(all), [&](const Result& result) {
      return !is_chosen(options, result.sequence);
    });
  }
  if (sorted_into_runs(std::move(all), options.baseline).size() == 1) return;
  throw DataError(options.baseline,
                  "keeps sequences of another kind than " + options.newer.string(),
                  "the same method, settings and protocol, or no --sequences");
}

}  // namespace

Answer accept_newer(const CompareFlags& options) {
  const ResultSet newer = chosen_run(options, options.newer);
  refuse_stale({newer}, options.allow_stale);
  refuse_overlap(newer, options.baseline);
  restore_folder(resolved(options.baseline));
  const FolderLock lock(options.baseline);
  const std::vector<ResultSet> known = accepted_runs(options.baseline);
  Answer answer = known.empty() ? Answer{.standing = standing_of(newer),
                                         .sheets = {{.lead = {"a new baseline"}}}}
                                : change(options, newer, known);
  check_stays_one_run(options, newer, known);
  std::optional<Acceptance> why;
  if (options.accept != "true") {
    why = {options.accept, fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)))};
  }
  const bool changed = accept_baseline(newer, options.baseline, why,
                                       options.sequences.empty() ? Others::kRemove : Others::kKeep);
  answer.text += fmt::format(
      fmt::runtime(changed ? "accepted {} as {}{}\n" : "{} is in {} already: nothing changed{}\n"),
      options.newer.string(), options.baseline.string(),
      !why      ? ""
      : changed ? ": " + why->why
                : ", and no reason is kept");
  return answer;
}

}  // namespace mosbench
