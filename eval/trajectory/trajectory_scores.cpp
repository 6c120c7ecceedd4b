#include "eval/trajectory/trajectory_scores.hpp"

#include <fmt/format.h>

#include <numbers>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

// First poses farther apart than this are hardly in the same frame.
constexpr double kFarStart_m = 5.0;

std::vector<Eigen::Vector3d> positions_m(const std::vector<Pose>& poses) {
  std::vector<Eigen::Vector3d> positions;
  for (const Pose& pose : poses) positions.emplace_back(pose.translation());
  return positions;
}

constexpr double kDegrees = 180 / std::numbers::pi;

/// The segments of all sequences, or the mean of the sequences' means.
struct Overall {
  std::optional<MeanSegmentError> pooled, mean_of_sequences;
};

Overall overall(std::span<const TrajectoryScore> scores,
                std::vector<SegmentError> TrajectoryScore::*segments) {
  std::vector<SegmentError> all, means;
  for (const TrajectoryScore& score : scores) {
    const std::vector<SegmentError>& own = score.*segments;
    all.insert(all.end(), own.begin(), own.end());
    if (const auto mean = mean_of(own)) {
      means.push_back({0, 0, 0.0, mean->translation, mean->rotation_rad_per_m});
    }
  }
  return {mean_of(all), mean_of(means)};
}

/// Adds the translation in percent and the rotation in degrees per 100 m.
void add_segments(const std::optional<MeanSegmentError>& mean, std::vector<Cell>& row) {
  std::optional<double> translation, rotation;
  if (mean) translation = 100 * mean->translation;
  if (mean) rotation = 100 * kDegrees * mean->rotation_rad_per_m;
  row.insert(row.end(), {or_missing(translation), or_missing(rotation)});
}

void add_roots(const PoseErrors& errors, std::vector<Cell>& row) {
  std::optional<double> translation_m, rotation_deg;
  if (const auto summary = summary_of(errors.translation_m)) translation_m = summary->rmse;
  if (const auto summary = summary_of(errors.rotation_rad)) rotation_deg = kDegrees * summary->rmse;
  row.insert(row.end(), {or_missing(translation_m), or_missing(rotation_deg)});
}

std::vector<Cell> row_of(const TrajectoryScore& score) {
  std::vector<Cell> row = {score.name, std::uint64_t{score.poses}, score.path_m,
                           std::uint64_t{score.kitti.size()}};
  add_segments(mean_of(score.kitti), row);
  add_segments(mean_of(score.brief), row);
  add_roots(score.absolute, row);
  add_roots(score.relative, row);
  return row;
}

std::vector<Cell> overall_row(const char* name, const std::optional<MeanSegmentError>& kitti,
                              const std::optional<MeanSegmentError>& brief) {
  std::vector<Cell> row = {name, "", "", kitti ? Cell(std::uint64_t{kitti->segments}) : Cell()};
  add_segments(kitti, row);
  add_segments(brief, row);
  return row;
}

std::string relative_name(const RelativePairs& pairs) {
  const std::string delta =
      pairs.delta_m ? fmt::format("{} m", *pairs.delta_m) : counted(pairs.delta_scans, "scan");
  return delta + (pairs.all ? ", from every pose" : ", one after the other");
}

ordered_json mean_json(const std::optional<MeanSegmentError>& mean) {
  if (!mean) return nullptr;
  return {{"segments", mean->segments},
          {"translation", mean->translation},
          {"rotation_rad_per_m", mean->rotation_rad_per_m}};
}

ordered_json summary_json(const std::vector<double>& errors) {
  const auto summary = summary_of(errors);
  if (!summary) return nullptr;
  return {{"count", summary->count},   {"rmse", summary->rmse},     {"mean", summary->mean},
          {"median", summary->median}, {"std", summary->deviation}, {"min", summary->least},
          {"max", summary->most},      {"sse", summary->squares}};
}

ordered_json errors_json(const PoseErrors& errors) {
  return {{"translation_m", summary_json(errors.translation_m)},
          {"rotation_rad", summary_json(errors.rotation_rad)}};
}

ordered_json segments_json(const std::vector<SegmentError>& errors) {
  ordered_json rows = ordered_json::array();
  for (const SegmentError& error : errors) {
    rows.push_back({{"first", error.first},
                    {"last", error.last},
                    {"length_m", error.length_m},
                    {"translation", error.translation},
                    {"rotation_rad_per_m", error.rotation_rad_per_m}});
  }
  return rows;
}

ordered_json score_json(const TrajectoryScore& score, bool per_pose) {
  ordered_json json = {{"name", score.name},
                       {"poses", score.poses},
                       {"path_m", score.path_m},
                       {"kitti", mean_json(mean_of(score.kitti))},
                       {"short_segments", mean_json(mean_of(score.brief))},
                       {"scale", score.scale},
                       {"absolute", errors_json(score.absolute)},
                       {"relative", errors_json(score.relative)},
                       {"remarks", score.remarks}};
  if (per_pose) {
    json["per_pose"] = {{"translation_m", score.absolute.translation_m},
                        {"rotation_rad", score.absolute.rotation_rad}};
    json["per_segment"] = segments_json(score.kitti);
  }
  return json;
}

ordered_json overall_json(const Overall& all) {
  return {{"pooled", mean_json(all.pooled)},
          {"mean_of_sequences", mean_json(all.mean_of_sequences)}};
}

}  // namespace

TrajectoryScore score_of(const TrajectoryPair& pair, const ScoringRules& rules) {
  const auto estimate = aligned(pair.estimate, pair.truth, rules.alignment);
  if (!estimate) {
    throw DataError(fmt::format(
        "{}: the positions lie on a line, so that {} alignment is undefined, expected --align none "
        "or origin",
        pair.name, to_string(rules.alignment)));
  }
  TrajectoryScore score{.name = pair.name,
                        .poses = pair.truth.size(),
                        .path_m = path_lengths_m(pair.truth).back(),
                        .kitti = segment_errors(pair.truth, pair.estimate, kitti_segments()),
                        .brief = segment_errors(pair.truth, pair.estimate, short_segments()),
                        .scale = estimate->scale,
                        .absolute = absolute_errors(pair.truth, estimate->poses),
                        .relative = relative_errors(pair.truth, estimate->poses, rules.relative),
                        .truth_m = positions_m(pair.truth),
                        .estimate_m = positions_m(estimate->poses),
                        .remarks = pair.remarks};
  const double apart_m =
      (pair.truth.front().translation() - estimate->poses.front().translation()).norm();
  if (rules.alignment == PathAlignment::kNone && apart_m > kFarStart_m) {
    score.remarks.push_back(fmt::format(
        "the first poses are {:.1f} m apart, which --align origin would take out", apart_m));
  }
  return score;
}

Sheet trajectory_sheet(std::span<const TrajectoryScore> scores, const ScoringRules& rules) {
  Sheet sheet{.columns = {{"sequence", Unit::kText},
                          {"poses"},
                          {"path m", Unit::kNumber, 1},
                          {"segments"},
                          {"KITTI %"},
                          {"deg/100 m"},
                          {"5-50 m %"},
                          {"deg/100 m", Unit::kNumber, {}, "short_deg_100_m"},
                          {"APE m", Unit::kNumber, 4},
                          {"APE deg", Unit::kNumber, 4},
                          {"RPE m", Unit::kNumber, 4},
                          {"RPE deg", Unit::kNumber, 4}}};
  for (const TrajectoryScore& score : scores) sheet.rows.push_back(row_of(score));
  if (scores.size() > 1) {
    const Overall kitti = overall(scores, &TrajectoryScore::kitti);
    const Overall brief = overall(scores, &TrajectoryScore::brief);
    sheet.rows.emplace_back();
    sheet.rows.push_back(overall_row("all segments", kitti.pooled, brief.pooled));
    sheet.rows.push_back(
        overall_row("mean of sequences", kitti.mean_of_sequences, brief.mean_of_sequences));
  }
  sheet.notes = {
      "KITTI: segments of 100 to 800 m from every tenth pose; 5-50 m: of 5, 10, 20 and 50 m from "
      "every pose, not comparable with KITTI's. Neither is aligned.",
      fmt::format("APE and RPE: root mean square; alignment {}; RPE over {}.",
                  to_string(rules.alignment), relative_name(rules.relative))};
  for (const TrajectoryScore& score : scores) {
    if (rules.alignment == PathAlignment::kSimilarity) {
      sheet.notes.push_back(fmt::format("{}: scaled by {:.6f}", score.name, score.scale));
    }
    for (const std::string& remark : score.remarks) {
      sheet.notes.push_back(fmt::format("{}: {}", score.name, remark));
    }
  }
  return sheet;
}

ordered_json trajectory_json(std::span<const TrajectoryScore> scores, const ScoringRules& rules,
                             bool per_pose) {
  ordered_json sequences = ordered_json::array();
  for (const TrajectoryScore& score : scores) sequences.push_back(score_json(score, per_pose));
  return {{"alignment", to_string(rules.alignment)},
          {"relative_pairs", relative_name(rules.relative)},
          {"kitti", overall_json(overall(scores, &TrajectoryScore::kitti))},
          {"short_segments", overall_json(overall(scores, &TrajectoryScore::brief))},
          {"sequences", sequences}};
}

Sheet pose_records(std::span<const TrajectoryScore> scores) {
  Sheet sheet{.columns = {{"sequence", Unit::kText}, {"pose"}, {"ape_m"}, {"ape_rad"}}};
  for (const TrajectoryScore& score : scores) {
    for (std::size_t i = 0; i < score.poses; ++i) {
      sheet.rows.push_back({score.name, std::uint64_t{i}, score.absolute.translation_m[i],
                            score.absolute.rotation_rad[i]});
    }
  }
  return sheet;
}

}  // namespace mosbench
