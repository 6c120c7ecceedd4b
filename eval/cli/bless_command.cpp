#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "datasets/files/errors.hpp"
#include "eval/cli/commands.hpp"
#include "eval/statistics/baseline.hpp"
#include "eval/statistics/paired_runs.hpp"
#include "eval/statistics/statistics_report.hpp"

namespace mosbench {
namespace {

constexpr const char* kBlessFooter =
    R"(Copies the results of NEW to BASELINE as those that `mosbench compare` measures against from now on,
without what depends on the clock and the machine, and prints what changes against the results that
lay there. Accept them by committing the folder. Results of another protocol, method, setting, other scans
or input than those of the baseline replace it only with --even-if.

Examples:
  mosbench bless results/runs/room results/baseline/room
  mosbench bless results/runs/room-10cm results/baseline/room --even-if)";

struct BlessFlags {
  std::filesystem::path newer, baseline;
  bool even_if = false;
};

/// What changes against the baseline that lies there.
std::string change(const BlessFlags& options, const ResultSet& newer) {
  const std::vector<ResultSet> known = accepted_runs(options.baseline);
  if (known.empty()) {
    std::string text = "a new baseline\n";
    for (const std::string& warning : warnings(newer)) text += warning + '\n';
    return text;
  }
  if (known.size() > 1 && options.even_if) return "several runs lay there before\n";
  // Of several runs, loading one names what they differ in.
  const ResultSet baseline = known.size() == 1 ? known.front() : load_result_set(options.baseline);
  const PairedRuns paired = pair_runs(baseline, newer);
  if (!paired.unlike.empty() && !options.even_if) {
    throw DataError(options.baseline,
                    "is a baseline of another kind than " + options.newer.string() + ": " +
                        unlike_text(paired.unlike),
                    "one of the same kind; --even-if replaces it all the same");
  }
  if (paired.scans.empty()) return "no scan in common with the baseline before\n";
  return difference_text(baseline, newer, paired);
}

std::string bless(const BlessFlags& options) {
  const ResultSet newer = load_result_set(options.newer);
  const std::string text = change(options, newer);
  accept_baseline(newer, options.baseline);
  return text +
         fmt::format("accepted {} as {}\n", options.newer.string(), options.baseline.string());
}

}  // namespace

void add_bless_command(CLI::App& app, std::string& answer) {
  auto options = std::make_shared<BlessFlags>();
  CLI::App* command = app.add_subcommand("bless", "Accept results as the new baseline");
  command->add_option("NEW", options->newer, "Results of one run")->required();
  command->add_option("BASELINE", options->baseline, "Folder of accepted results")->required();
  command->add_flag("--even-if", options->even_if, "Replace a baseline of another kind, too");
  command->footer(kBlessFooter);
  command->callback([options, &answer] { answer = bless(*options); });
}

}  // namespace mosbench
