#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <optional>

#include "datasets/formats/calib_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/shell_text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/answer/render.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/output_file.hpp"
#include "eval/cli/suggested_command.hpp"
#include "eval/cli/trajectory_plot.hpp"
#include "eval/trajectory/path_comparison.hpp"
#include "eval/trajectory/trajectory_scores.hpp"

namespace mosbench {
namespace {

constexpr const char* kTrajectoryFooter =
    R"(ESTIMATE and TRUTH are files of poses (KITTI: 12 numbers a row; TUM: stamp and quaternion; Dynablox
rollouts), folders with files of the same names as `mosbench odometry` writes them, folders of
`mosbench run --odometry`, or data sets, whose poses are the LiDAR's. Rows are paired by stamps if
both sides have them, else one by one.

Prints the errors of KITTI's odometry benchmark, those of segments of 5 to 50 m for paths that are
too short for it, and the absolute and relative pose errors (APE, RPE). Every answer states the
alignment.

With OTHER, a second estimate of the same poses, also prints how much better or worse it is:
differences paired by segments, their 95 % intervals and p-values, and the difference that as many
poses would show.

--plot draws the paths from above and the distance to the truth over the way, as PNG; of folders
with several sequences to FILE/<sequence>.png.

A poses.txt of KITTI is in the camera frame. For an estimate in the LiDAR frame add
  --camera truth --calib calib.txt

Examples:
  mosbench trajectory poses.txt --truth ~/kitti/sequences/04
  mosbench trajectory results --truth poses --camera truth --calib dataset/sequences/00/calib.txt
  mosbench trajectory simple.txt kiss.txt --truth truth.txt --align origin --plot paths.png
  mosbench trajectory poses.tum --truth truth.tum --align rigid --delta-m 10 --all-pairs)";

struct TrajectoryFlags {
  std::filesystem::path estimate, truth;
  std::optional<std::filesystem::path> other, plot;
  std::optional<std::filesystem::path> calib;
  std::string camera = "neither", alignment = "none";
  std::optional<std::string> format;
  double max_time_difference_s = 0.01;
  RelativePairs relative;
  bool per_pose = false;
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

/// The estimates of all sequences with their scores.
struct ScoredEstimates {
  std::vector<TrajectoryPair> pairs;
  std::vector<TrajectoryScore> scores;
};

/// Where the paths of one of so many sequences are drawn.
std::filesystem::path plot_file(const std::filesystem::path& out, const std::string& sequence,
                                std::size_t sequences) {
  return sequences == 1 ? out : out / (sequence + ".png");
}

ScoredEstimates scored_estimates(const std::filesystem::path& estimates,
                                 const TrajectoryFlags& flags, const ScoringRules& rules) {
  ScoredEstimates scored{read_trajectory_pairs(estimates, flags.truth, trajectory_options(flags)),
                         {}};
  for (const TrajectoryPair& pair : scored.pairs) {
    if (flags.plot) check_output(plot_file(*flags.plot, pair.name, scored.pairs.size()));
  }
  for (const TrajectoryPair& pair : scored.pairs) scored.scores.push_back(score_of(pair, rules));
  return scored;
}

Answer answer_of_one(const ScoredEstimates& one, const TrajectoryFlags& flags,
                     const ScoringRules& rules) {
  return {.sheets = {trajectory_sheet(one.scores, rules)},
          .records = pose_records(one.scores),
          .json = json_text(trajectory_json(one.scores, rules, flags.per_pose))};
}

Answer answer_of_two(const ScoredEstimates& first, const ScoredEstimates& second,
                     const TrajectoryFlags& flags, const ScoringRules& rules) {
  check_same_truth(first.pairs, second.pairs);
  const std::vector<PathDifference> differences = compare_paths(first.scores, second.scores);
  Answer answer{
      .sheets = {trajectory_sheet(first.scores, rules), trajectory_sheet(second.scores, rules),
                 path_differences_sheet(differences)},
      .records = path_difference_records(differences),
      .json = json_text({{"first", trajectory_json(first.scores, rules, flags.per_pose)},
                         {"second", trajectory_json(second.scores, rules, flags.per_pose)},
                         {"confidence", kConfidence},
                         {"difference", path_differences_json(differences)}})};
  answer.sheets[0].lead = {"first: " + flags.estimate.string()};
  answer.sheets[1].lead = {"second: " + flags.other->string()};
  return answer;
}

/// Adds the charts of every sequence, and writes them where --plot says.
void draw(const std::vector<TrajectoryScore>& first, const std::vector<TrajectoryScore>* second,
          const TrajectoryFlags& flags, PathAlignment alignment, Answer& answer) {
  for (std::size_t s = 0; s < first.size(); ++s) {
    std::vector<const TrajectoryScore*> estimates = {&first[s]};
    if (second != nullptr) estimates.push_back(&(*second)[s]);
    const Answer one{.charts = trajectory_charts(estimates, alignment)};
    if (flags.plot) {
      write_output(plot_file(*flags.plot, first[s].name, first.size()), render(one, Format::kPng));
    }
    answer.charts.insert(answer.charts.end(), one.charts.begin(), one.charts.end());
  }
}

void check_plot(const TrajectoryFlags& flags) {
  for (const auto& input : {flags.estimate, flags.truth, flags.other.value_or("")}) {
    std::error_code ignored;
    if (!std::filesystem::equivalent(input, *flags.plot, ignored)) continue;
    throw UsageError("--plot " + flags.plot->string() + ": is a file of poses, expected another");
  }
}

/// Says what to type, as two files may be an estimate with its truth or two estimates.
void check_truth(const TrajectoryFlags& flags, const CLI::App& command) {
  if (!flags.truth.empty()) return;
  const std::string given = given_words(command, std::mem_fn(&CLI::Option::nonpositional));
  const std::string first = shell_word(flags.estimate.string());
  if (!flags.other) {
    throw UsageError(fmt::format(
        "--truth: is missing, expected mosbench trajectory {} --truth TRUE_POSES{}", first, given));
  }
  throw UsageError(
      fmt::format("--truth: is missing, expected, where {1} holds the true poses,\n"
                  "  mosbench trajectory {0} --truth {1}{2}\n"
                  "or, for two estimates, mosbench trajectory {0} {1} --truth TRUE_POSES{2}",
                  first, shell_word(flags.other->string()), given));
}

Answer trajectory_answer(const TrajectoryFlags& flags, const CLI::App& command) {
  check_truth(flags, command);
  if (flags.other && flags.relative.delta_m) {
    throw UsageError(
        "--delta-m: cuts each estimate by its own path, expected --delta for two estimates");
  }
  if (flags.plot) check_plot(flags);
  const ScoringRules rules{.alignment = *path_alignment_from_string(flags.alignment),
                           .relative = flags.relative};
  const ScoredEstimates first = scored_estimates(flags.estimate, flags, rules);
  std::optional<ScoredEstimates> second;
  if (flags.other) second = scored_estimates(*flags.other, flags, rules);
  Answer answer =
      second ? answer_of_two(first, *second, flags, rules) : answer_of_one(first, flags, rules);
  draw(first.scores, second ? &second->scores : nullptr, flags, rules.alignment, answer);
  return answer_beside(flags.plot.value_or(""), std::move(answer));
}

}  // namespace

CommandRun add_trajectory(CLI::App& command) {
  auto flags = std::make_shared<TrajectoryFlags>();
  command.add_option("ESTIMATE", flags->estimate, "File or folder of estimated poses, or data set")
      ->type_name("PATH")
      ->required();
  command.add_option("OTHER", flags->other, "Second file or folder of estimated poses, to compare")
      ->type_name("PATH");
  command
      .add_option("--truth", flags->truth, "File or folder of true poses, or data set (required)")
      ->type_name("PATH");
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
  command.add_option("--plot", flags->plot, "PNG file to draw the paths and their errors to")
      ->type_name("FILE");
  command.footer(kTrajectoryFooter);
  return [flags, &command] { return trajectory_answer(*flags, command); };
}

}  // namespace mosbench
