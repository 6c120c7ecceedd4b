#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "eval/cli/commands.hpp"
#include "eval/cli/method_options.hpp"
#include "eval/cli/run_report.hpp"
#include "eval/runs/run_execute.hpp"
#include "eval/runs/run_plan.hpp"

namespace mosbench {
namespace {

constexpr const char* kRunFooter =
    R"(Writes DIR/<sequence>/labels/<stem>.label (uint32 per point, 9 static, 251 moving) and
DIR/<sequence>/result.json, and prints IoU, precision and recall, if there is truth, and ms per scan.
--scores adds DIR/<sequence>/scores/<stem>.score (float32 per point): what the method compares with
its threshold; larger means more likely to move. `mosbench report` then colours points by it.

The same command again skips the sequences that are finished and starts an interrupted one again
from its first scan, because the method's memory spans the whole past. A sequence appears under DIR
when it is finished; until then it is written to DIR/<sequence>.partial. Results of other settings,
another program or other input are kept unless --overwrite is given. DIR may hold sequences of one
data set, one method and one setting only.

Settings: defaults < --preset < --config FILE < --set. FILE holds a JSON object such as
  {"voxel_size_m": 0.25, "max_range_m": 50.0, "delay_scans": 10}
`mosbench list methods` shows all settings, `mosbench list presets` the presets.

--odometry finds the poses before the method sees a scan and writes them to DIR/<sequence>/poses.txt;
its settings are part of the configuration. Poses that it doubts are named in the remarks.

Examples:
  mosbench run ~/sipailou-livox-kitti
  mosbench run ~/doals --preset doals-120m --sequences station/sequence_1,station/sequence_2
  mosbench run ~/HeLiMOS/KAIST05/Deskewed_LiDAR --preset helimos-delayed --protocol helimos-test
  mosbench run ~/kitti/sequences/08 --set max_range_m=30,voxel_size_m=0.2 --out results/runs/08-near
  mosbench run ~/kitti/sequences/08 --scores --out results/runs/08-scores
  mosbench run ~/folder-with-a-bag --odometry simple --odometry-set min_range_m=1
  mosbench run sim/00 --config near.json --variant release-2025 --threads 4 --json)";

void add_odometry_flags(CLI::App& command, OdometryOptions& odometry) {
  constexpr const char* kGroup = "Poses found from the scans";
  command
      .add_option("--odometry", odometry.kind,
                  "simple or kiss: find the poses instead of reading them")
      ->group(kGroup);
  command.add_option("--odometry-preset", odometry.preset, "Settings that its authors published")
      ->group(kGroup);
  command.add_option("--odometry-config", odometry.config_file, "JSON object of its settings")
      ->group(kGroup);
  command.add_option("--odometry-set", odometry.assignments, "key=value, one per flag")
      ->allow_extra_args(false)
      ->group(kGroup);
}

std::string run(const RunOptions& options) {
  const RunPlan plan = plan_run(options);
  const std::vector<SequenceOutcome> outcomes = execute_run(plan);
  return options.json ? run_report_json(plan, outcomes) : run_report_text(plan, outcomes);
}

}  // namespace

CommandRun add_run(CLI::App& command) {
  auto options = std::make_shared<RunOptions>();
  add_method_options(command, *options);
  command.add_option("--protocol", options->protocol, "How to score (default: by preset)")
      ->type_name("PROTOCOL");
  command
      .add_option("--range", options->range,
                  "In metres, for protocols that limit it (default: that of the run)")
      ->type_name("MIN,MAX");
  command
      .add_option("--out", options->out,
                  "Folder of the results (default: results/runs/<data>-<preset>-<variant>)")
      ->type_name("DIR");
  add_odometry_flags(command, options->odometry);
  command.add_flag("--scores", options->scores, "Also write the score of every point");
  command.add_flag("--overwrite", options->overwrite, "Run again and replace what is in --out");
  command.add_flag("--json", options->json, "Print JSON instead of a table");
  command.footer(kRunFooter);
  return [options] { return Answer{run(*options)}; };
}

}  // namespace mosbench
