#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "datasets/files.hpp"
#include "eval/baseline.hpp"
#include "eval/commands.hpp"
#include "eval/paired_runs.hpp"
#include "eval/statistics.hpp"

namespace mosbench {
namespace {

constexpr const char* kFooter =
    R"(Copies the results of NEW to BASELINE as those that `mosbench compare` measures against from now on,
without what depends on the clock and the machine, and prints what changes against the results that
lay there. Accept them by committing the folder.

Example:
  mosbench bless results/runs/room results/baseline/room)";

struct BlessOptions {
  std::filesystem::path newer, baseline;
};

std::string change(const ResultSet& newer, const std::filesystem::path& folder) {
  if (!is_there(folder)) return "a new baseline\n";
  const ResultSet baseline = load_result_set(folder);
  const PairedRuns paired = pair_runs(baseline, newer);
  if (paired.scans.empty()) return "no scan in common with the baseline before\n";
  return difference_text(baseline, newer, paired);
}

std::string bless(const BlessOptions& options) {
  const ResultSet newer = load_result_set(options.newer);
  std::string text = change(newer, options.baseline);
  accept_baseline(newer, options.baseline);
  return text +
         fmt::format("accepted {} as {}\n", options.newer.string(), options.baseline.string());
}

}  // namespace

void add_bless_command(CLI::App& app, std::string& answer) {
  auto options = std::make_shared<BlessOptions>();
  CLI::App* command = app.add_subcommand("bless", "Accept results as the new baseline");
  command->add_option("NEW", options->newer, "Results of one run")->required();
  command->add_option("BASELINE", options->baseline, "Folder of accepted results")->required();
  command->footer(kFooter);
  command->callback([options, &answer] { answer = bless(*options); });
}

}  // namespace mosbench
