#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "eval/answer/answer_text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/method_options.hpp"
#include "eval/cli/odometry_flags.hpp"
#include "eval/cli/run_methods.hpp"
#include "eval/cli/run_report.hpp"
#include "eval/engine/run_execute.hpp"
#include "eval/engine/run_plan.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/report/written_products.hpp"
#include "eval/results/simulated.hpp"

namespace mosbench {
namespace {

constexpr const char* kRunFooter =
    R"(Writes DIR/<sequence>/labels/<stem>.label (uint32 per point, 9 static, 251 moving) and
DIR/<sequence>/result.json, and prints IoU, precision and recall, if there is truth, and ms per
scan. --scores adds DIR/<sequence>/scores/<stem>.score (float32 per point): what the method compares
with its threshold; larger means more likely to move. `mosbench report` then colours points by it,
and `mosbench curve` draws precision over recall. Of hmm-mos-plus it also adds
DIR/<sequence>/reasons/<stem>.reason (a byte per point): why it moves; `report` and `render
--reasons` colour points by that.

--write adds to DIR/<sequence>, from the labels: boxes.json and boxes.txt (boxes), boxes around what
moves with track and velocity, the second in KITTI's format; moving/<stem>.ply (moving-cloud), the
moving points of each scan; static.ply (static-cloud), a map of what stands still, a point per 0.1
m; static.pcd (static-cloud-pcd), the same map for PCL. The same command again keeps what is there,
and refuses what was changed meanwhile: remove it to have it made again. docs/formats/files.md
describes the files.

The same command again skips the sequences that are finished and starts an interrupted one again
from its first scan, because a label may depend on every earlier scan. A sequence appears under DIR
when it is finished; until then it is written to DIR/<sequence>.partial. Results of other settings,
another program or other input are kept unless --overwrite is given. DIR may hold sequences of one
data set, one method and one setting only. Input counts as the same while names, sizes, inodes and
times of its files are; otherwise, and with --verify, all of it is read and compared.

--method all, or a list as in dynablox,yoon, runs one method after the other on each sequence, each
to DIR/<method>/<sequence>, with the same protocol. Scans are read once: as many of a sequence as
fit in 2 GiB, or in a quarter of the machine's memory, are kept for the next method and not counted
as its memory. Poses of --odometry are found once, but for --drop-moving. all is every method of
`mosbench list methods` but hmm-mos-reference. All of it is checked before the first scan: a setting
of --set, --config or --variant that one of the methods lacks is refused; --set METHOD.KEY=VALUE
sets one method's. A method that fails then leaves the others as they are; the exit code is that of
the first in the list that failed. `mosbench rank DIR` compares them.

--method exec:COMMAND starts a program of yours for each sequence, hands it the scans with their
poses over stdin, and takes its labels from stdout (docs/formats/exec.md has the messages,
tests/examples/exec a client in Python and one in C++). In a list it comes last, as the command may
hold commas. Finished sequences are kept, also when the program behind the command has changed:
--overwrite runs them again.

Settings: defaults < --preset < --config FILE < --set. FILE holds a JSON object such as
  {"voxel_size_m": 0.25, "max_range_m": 50.0, "delay_scans": 10}
`mosbench list methods` shows all settings, `mosbench list presets` the presets; --preset best is
method hmm-mos-plus with its defaults, and with the voxels, the range and the protocol of the data
set's own preset.

--moving ever is for truth by object, as that of DOALS, where who stops stays moving: hmm-mos-plus
then calls moving what arrived in free space in the last 10 s, with ever:3 in the last 3 s, also
where it stands since. It is short for --set seed_age_s=10,object_age_s=10,fresh_age_s=10,
max_aged_share=1. Where truth is by speed, or parked cars come into view, it costs precision.

--odometry finds the poses before the method sees a scan and writes them to
DIR/<sequence>/poses.txt; its settings are part of the configuration. Poses that it doubts are
counted on stderr and in the remarks, in capitals where they are the most; unlike that of `mosbench
odometry`, the exit code stays 0, because the labels are written. With --drop-moving the method
runs, online, beside the odometry, and what it finds moving in a scan stays out of the map that the
next scans are registered to.

Examples:
  mosbench run ~/sipailou-livox-kitti
  mosbench run ~/kitti/sequences/08 --preset best
  mosbench run ~/doals --preset best --moving ever
  mosbench run ~/doals --preset doals-120m --sequences station/sequence_1,station/sequence_2
  mosbench run ~/HeLiMOS/KAIST05/Deskewed_LiDAR --preset helimos-delayed --protocol helimos-test
  mosbench run ~/kitti/sequences/08 --set max_range_m=30,voxel_size_m=0.2 --out results/runs/08-near
  mosbench run ~/kitti/sequences/08 --scores --out results/runs/08-scores
  mosbench run ~/kitti/sequences/08 --write boxes,static-cloud
  mosbench run ~/kitti/sequences/08 --method all --out results/runs/08
  mosbench run ~/kitti/sequences/08 --method hmm-mos,dynablox --set dynablox.level=point
  mosbench run ~/kitti/sequences/08 --method "exec:python3 my_network.py" --set timeout_s=120
  mosbench run ~/drive.bag --odometry simple --odometry-set min_range_m=1
  mosbench run ~/kitti/2011_09_26 --sequences 0005 --point-times azimuth --deskew poses
  mosbench run sim/00 --config near.json --variant release-2025 --threads 4 --json)";

struct RunFlags {
  RunOptions options;
  std::vector<std::string> products;
};

Answer run(const RunFlags& flags) {
  const RunOptions& options = flags.options;
  if (options.method && names_several_methods(*options.method)) {
    return run_methods(options, flags.products);
  }
  const RunPlan plan = plan_run(options);
  const std::vector<SequenceOutcome> outcomes = execute_run(plan);
  for (const SequenceOutcome& outcome : outcomes) write_products(outcome.folder, flags.products);
  return {.standing = standing_of(plan.dataset),
          .sheets = {run_sheet(plan, outcomes)},
          .json = json_text(run_report_json(plan, outcomes))};
}

}  // namespace

CommandRun add_run(CLI::App& command) {
  auto flags = std::make_shared<RunFlags>();
  RunOptions* options = &flags->options;
  add_method_options(command, *options);
  command.add_option("--protocol", options->protocol, "How to score (default: by preset)")
      ->type_name("PROTOCOL");
  command
      .add_option("--range", options->range,
                  "Scoring range in metres, for protocols with a limit (default: the method's)")
      ->type_name("MIN,MAX");
  command
      .add_option("--out", options->out,
                  "Folder of the results (default: results/runs/<data>-<preset>-<variant>, with "
                  "--odometry also -<kind>)")
      ->type_name("DIR");
  add_odometry_flags(command, options->odometry);
  command.add_flag("--scores", options->scores,
                   "Also write the score of every point, and of hmm-mos-plus why it moves");
  command
      .add_option(
          "--write", flags->products,
          "Also write, from the labels: " + fmt::format("{}", fmt::join(product_names(), ", ")))
      ->type_name("WHAT,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(product_names()));
  command.add_flag("--overwrite", options->overwrite, "Run again and replace what is in --out");
  command.add_flag("--verify", options->verify,
                   "Read all input of finished sequences again, not only its sizes and times");
  command.footer(kRunFooter);
  return [flags] { return run(*flags); };
}

}  // namespace mosbench
