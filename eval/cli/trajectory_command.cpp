#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "datasets/files/calib_file.hpp"
#include "datasets/files/errors.hpp"
#include "eval/cli/commands.hpp"
#include "eval/results/answer_text.hpp"
#include "eval/trajectory/trajectory_scores.hpp"

namespace mosbench {
namespace {

constexpr const char* kTrajectoryFooter =
    R"(ESTIMATE and TRUTH are files of poses (KITTI: 12 numbers a row; TUM: stamp and quaternion; Dynablox
rollouts), or two folders with files of the same names. Rows are paired by stamps if both files have
them, else one by one.

Prints the errors of KITTI's odometry benchmark, those of segments of 5 to 50 m for paths that are too
short for it, and the absolute and relative pose errors (APE, RPE). Every answer states the alignment.

The truth of KITTI is in the camera frame. For an estimate in the LiDAR frame add
  --camera truth --calib calib.txt

Examples:
  mosbench trajectory poses.txt --truth truth.txt
  mosbench trajectory results --truth poses --camera truth --calib dataset/sequences/00/calib.txt
  mosbench trajectory poses.tum --truth truth.tum --align rigid --delta-m 10 --all-pairs)";

struct TrajectoryFlags {
  std::filesystem::path estimate, truth;
  std::optional<std::filesystem::path> calib;
  std::string camera = "neither", alignment = "none";
  std::optional<std::string> format;
  double max_time_difference_s = 0.01;
  RelativePairs relative;
  bool per_pose = false, csv = false, json = false;
};

TrajectoryOptions trajectory_options(const TrajectoryFlags& flags) {
  TrajectoryOptions options;
  options.max_time_difference_s = flags.max_time_difference_s;
  if (flags.format) options.format = pose_format_from_string(*flags.format);
  if (flags.camera == "estimate") options.camera = CameraFrame::kEstimate;
  if (flags.camera == "truth") options.camera = CameraFrame::kTruth;
  if ((options.camera == CameraFrame::kNeither) != !flags.calib) {
    throw UsageError(
        "--camera and --calib: say together which file is the camera's and where the lidar is");
  }
  if (flags.calib) options.camera_from_lidar = read_calib(*flags.calib);
  return options;
}

std::string trajectory_answer(const TrajectoryFlags& flags) {
  const ScoringRules rules{.alignment = *path_alignment_from_string(flags.alignment),
                           .relative = flags.relative};
  std::vector<TrajectoryScore> scores;
  for (const TrajectoryPair& pair :
       read_trajectory_pairs(flags.estimate, flags.truth, trajectory_options(flags))) {
    scores.push_back(score_of(pair, rules));
  }
  if (flags.csv) return trajectory_csv(scores);
  if (flags.json) return json_text(trajectory_json(scores, rules, flags.per_pose));
  return trajectory_text(scores, rules);
}

}  // namespace

CommandRun add_trajectory(CLI::App& command) {
  auto flags = std::make_shared<TrajectoryFlags>();
  command.add_option("ESTIMATE", flags->estimate, "File or folder of estimated poses")
      ->type_name("PATH")
      ->required();
  command.add_option("--truth", flags->truth, "File or folder of true poses")
      ->type_name("PATH")
      ->required();
  command.add_option("--align", flags->alignment, "Alignment before APE and RPE (default: none)")
      ->check(CLI::IsMember({"none", "origin", "rigid", "similarity"}));
  command
      .add_option("--camera", flags->camera,
                  "Which of the two is in the camera frame (default: neither)")
      ->check(CLI::IsMember({"neither", "estimate", "truth"}));
  command.add_option("--calib", flags->calib, "calib.txt of KITTI with the Tr of the LiDAR")
      ->type_name("FILE");
  command.add_option("--format", flags->format, "Of both files (default: recognised)")
      ->check(CLI::IsMember({"kitti", "tum", "dynablox"}));
  command
      .add_option("--max-time-difference-s", flags->max_time_difference_s,
                  "Between the stamps of a pair (default: 0.01)")
      ->check(CLI::Range(0.0, 1e6));
  CLI::Option* scans = command
                           .add_option("--delta", flags->relative.delta_scans,
                                       "Scans between the poses of RPE (default: 1)")
                           ->check(CLI::Range(1, 1000000));
  command
      .add_option("--delta-m", flags->relative.delta_m,
                  "Metres of the estimated path between the poses of RPE")
      ->check(CLI::Range(1e-3, 1e9))
      ->excludes(scans);
  command.add_flag("--all-pairs", flags->relative.all, "Start a pair of RPE at every pose");
  command.add_flag("--per-pose", flags->per_pose, "With --json: errors of every pose and segment");
  command.add_flag("--csv", flags->csv, "Print the absolute errors of every pose as CSV");
  command.add_flag("--json", flags->json, "Print JSON instead of a table");
  command.footer(kTrajectoryFooter);
  return [flags] { return Answer{trajectory_answer(*flags)}; };
}

}  // namespace mosbench
