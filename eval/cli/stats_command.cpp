#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "datasets/text/errors.hpp"
#include "eval/cli/commands.hpp"
#include "eval/statistics/statistics_report.hpp"

namespace mosbench {
namespace {

constexpr const char* kStatsFooter =
    R"(RUN and SECOND are folders that `mosbench run` or `mosbench score --out` wrote, or single
result.json files. With one run: IoU, precision, recall and F1 of each sequence and of all, with 95
% intervals. With two: what the second changes, paired scan by scan, with interval, p-value and the
smallest change that this number of scans can show. The runs may differ in method, setting and
poses; protocol, scans and truth must be the same.

Examples:
  mosbench stats results/runs/kitti
  mosbench stats results/runs/kitti results/runs/kitti-delayed
  mosbench stats results/runs/kitti --as csv > scans.csv
  mosbench stats results/runs/kitti --per-scan --json)";

struct StatsFlags {
  std::filesystem::path first;
  std::optional<std::filesystem::path> second;
  bool per_scan = false;
};

Answer of_two(const StatsFlags& options) {
  if (options.per_scan) throw UsageError("--per-scan: shows one run, expected no SECOND");
  const ResultSet first = load_result_set(options.first);
  const ResultSet second = load_result_set(*options.second);
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

}  // namespace

CommandRun add_stats(CLI::App& command) {
  auto options = std::make_shared<StatsFlags>();
  command.add_option("RUN", options->first, "Results of a run")->type_name("DIR")->required();
  command.add_option("SECOND", options->second, "Results of another run on the same scans")
      ->type_name("DIR");
  command.add_flag("--per-scan", options->per_scan, "With --json: also the counts of each scan");
  command.footer(kStatsFooter);
  return [options] {
    return options->second ? of_two(*options)
                           : statistics_answer(load_result_set(options->first), options->per_scan);
  };
}

}  // namespace mosbench
