#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "datasets/disk/folder_lock.hpp"
#include "datasets/disk/folder_relation.hpp"
#include "datasets/disk/replace_folder.hpp"
#include "datasets/text/errors.hpp"
#include "eval/cli/commands.hpp"
#include "eval/statistics/paired_runs.hpp"
#include "eval/statistics/statistics_report.hpp"
#include "eval/store/baseline.hpp"

namespace mosbench {
namespace {

constexpr const char* kBlessFooter =
    R"(Copies the results of NEW to BASELINE, so that `mosbench compare` measures against them from now on,
and prints what changes against the baseline before. What depends on the clock and the machine is
left out. Commit the folder to accept the results. A baseline of another protocol, method, setting,
scans or input is replaced only with --even-if. Whenever bless is stopped, the old or the new
baseline is whole.

Examples:
  mosbench bless results/runs/highway results/baseline/highway-online
  mosbench bless results/runs/highway-10cm results/baseline/highway-online --even-if)";

struct BlessFlags {
  std::filesystem::path newer, baseline;
  bool even_if = false;
};

/// Says what changes against the baseline before.
Answer change(const BlessFlags& options, const ResultSet& newer) {
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

Answer bless(const BlessFlags& options) {
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

}  // namespace

CommandRun add_bless(CLI::App& command) {
  auto options = std::make_shared<BlessFlags>();
  command.add_option("NEW", options->newer, "Results of one run")->type_name("DIR")->required();
  command.add_option("BASELINE", options->baseline, "Folder of accepted results")
      ->type_name("DIR")
      ->required();
  command.add_flag("--even-if", options->even_if, "Also replace a baseline of another kind");
  command.footer(kBlessFooter);
  return [options] { return bless(*options); };
}

}  // namespace mosbench
