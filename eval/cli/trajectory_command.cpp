#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "datasets/formats/pose_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/answer/render.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/result/output.hpp"
#include "eval/trajectory/trajectory_scores.hpp"

namespace mosbench {
namespace {

struct TrajectoryFlags {
  std::filesystem::path estimate, truth;
  std::optional<std::filesystem::path> other, plot, calib;
  std::string alignment = "none";
  TrajectoryOptions reading;
  RelativePairs relative;
  bool per_pose = false;
};

/// "truth:calib.txt": which path is the camera's, and where the lidar is.
void take_camera(const std::string& text, TrajectoryFlags& flags) {
  const std::size_t colon = text.find(':');
  const std::string whose = text.substr(0, colon);
  if ((whose != "estimate" && whose != "truth") || colon == std::string::npos) {
    throw UsageError(fmt::format(
        "--camera: '{}' is not known, expected estimate:CALIB or truth:CALIB, which say together "
        "which file is the camera's and where the lidar is",
        text));
  }
  flags.reading.camera = whose == "truth" ? CameraFrame::kTruth : CameraFrame::kEstimate;
  flags.calib = text.substr(colon + 1);
}

/// How poses are read: "pose_format=tum,max_time_difference_s=0.02".
void take_reading(const std::string& text, TrajectoryOptions& options) {
  for (const auto& [key, value] : key_values("--read", text)) {
    const auto number = parse_double(value);
    if (key == "pose_format" && pose_format_from_string(value)) {
      options.format = pose_format_from_string(value);
    } else if (key == "max_time_difference_s" && number && *number >= 0.0 && *number <= 1e6) {
      options.max_time_difference_s = *number;
    } else {
      throw UsageError(
          fmt::format("--read {}={}: is not known, expected pose_format=kitti, tum or dynablox, or "
                      "max_time_difference_s=0 to 1e6",
                      key, value));
    }
  }
}

/// Which poses of RPE make a pair: "10" scans apart, "10m" along the estimated path, with ",all"
/// one from every pose on.
void take_delta(std::string text, RelativePairs& pairs) {
  const std::string typed = text;
  constexpr std::string_view kEvery = ",all";
  pairs.all = text.ends_with(kEvery);
  if (pairs.all) text.resize(text.size() - kEvery.size());
  const bool in_metres = text.ends_with('m');
  if (in_metres) text.pop_back();
  const auto delta = parse_double(text);
  if (in_metres && delta && *delta >= 1e-3 && *delta <= 1e9) {
    pairs.delta_m = *delta;
  } else if (!in_metres && delta && *delta >= 1 && *delta <= 1e6 && *delta == std::floor(*delta)) {
    pairs.delta_scans = static_cast<decltype(pairs.delta_scans)>(*delta);
  } else {
    throw UsageError(fmt::format(
        "--delta: '{}' is no distance, expected scans (1 to 1000000) or metres, as in 10m, and "
        "behind it at most ,all",
        typed));
  }
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
  ScoredEstimates scored{read_trajectory_pairs(estimates, flags.truth, flags.reading), {}};
  for (const TrajectoryPair& pair : scored.pairs) {
    if (flags.plot)
      check_output(plot_file(*flags.plot, pair.name, scored.pairs.size()), Format::kPng);
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

/// Adds the charts of every sequence, and writes them where --out says.
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
    throw UsageError("--out " + flags.plot->string() + ": is a file of poses, expected another");
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

/// Of the truth and of all estimates, each once.
std::vector<NamedMark> marks_of(const ScoredEstimates& first,
                                const std::optional<ScoredEstimates>& second) {
  std::vector<NamedMark> marks;
  for (const ScoredEstimates* scored : {&first, second ? &*second : nullptr}) {
    if (scored == nullptr) continue;
    for (const TrajectoryPair& pair : scored->pairs) {
      for (const NamedMark& mark : pair.marks) {
        if (std::ranges::find(marks, mark.place, &NamedMark::place) == marks.end()) {
          marks.push_back(mark);
        }
      }
    }
  }
  return marks;
}

Answer trajectory_answer(const TrajectoryFlags& flags, const CLI::App& command) {
  check_truth(flags, command);
  if (flags.other && flags.relative.delta_m) {
    throw UsageError(
        "--delta: metres cut each estimate by its own path, expected scans for two estimates");
  }
  if (flags.plot) check_plot(flags);
  const ScoringRules rules{.alignment = *path_alignment_from_string(flags.alignment),
                           .relative = flags.relative};
  const ScoredEstimates first = scored_estimates(flags.estimate, flags, rules);
  std::optional<ScoredEstimates> second;
  if (flags.other) second = scored_estimates(*flags.other, flags, rules);
  Answer answer =
      second ? answer_of_two(first, *second, flags, rules) : answer_of_one(first, flags, rules);
  answer.standing = standing_of(marks_of(first, second));
  draw(first.scores, second ? &second->scores : nullptr, flags, rules.alignment, answer);
  return answer_beside(flags.plot.value_or(""), std::move(answer));
}

}  // namespace

CommandRun add_trajectory(CLI::App& command) {
  auto flags = std::make_shared<TrajectoryFlags>();
  add(command, "ESTIMATE PATH", flags->estimate, "File or folder of estimated poses, or data set")
      ->required();
  add(command, "OTHER PATH", flags->other, "Second file or folder of estimated poses, to compare");
  add(command, "--truth PATH", flags->truth,
      "File or folder of true poses, or data set (required)");
  add(command, "--align", flags->alignment, "Alignment before APE and RPE (default: none)")
      ->check(CLI::IsMember({"none", "origin", "rigid", "similarity"}));
  const auto camera = [flags](const std::string& text) { take_camera(text, *flags); };
  add(command, "--camera WHOSE:CALIB", camera,
      "The path in the camera frame, estimate or truth, and KITTI's calib.txt with the Tr of "
      "the LiDAR (default: both are the LiDAR's)");
  const auto read = [flags](const std::string& text) { take_reading(text, flags->reading); };
  add(command, "--read KEY=VALUE,...", read,
      "pose_format=kitti, tum or dynablox, of both files (default: recognised); "
      "max_time_difference_s, between the stamps of a pair (default: 0.01)");
  const auto delta = [flags](const std::string& text) { take_delta(text, flags->relative); };
  add(command, "--delta N|METRESm[,all]", delta,
      "Scans between the poses of RPE, or metres of the estimated path, as in 10m; ,all behind "
      "it starts a pair at every pose (default: 1)");
  const auto by = [flags](const std::string&) { flags->per_pose = true; };
  add(command, "--by", by, "With --json: also the errors of every pose and segment")
      ->check(CLI::IsMember({"pose"}));
  add(command, "-o,--out FILE", flags->plot, "PNG file to draw the paths and their errors to");
  return [flags, &command] {
    if (flags->calib) flags->reading.camera_from_lidar = read_calib(*flags->calib);
    return trajectory_answer(*flags, command);
  };
}

}  // namespace mosbench
