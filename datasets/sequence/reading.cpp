#include "datasets/sequence/reading.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

bool has(const Perturbation& perturbation, std::string_view prefix) {
  return std::ranges::any_of(
      perturbation.steps, [&](const PerturbStep& step) { return step.kind.starts_with(prefix); });
}

/// Collects what is not empty.
class Members {
 public:
  void add(const char* what, std::string_view how) {
    if (!how.empty()) members_.emplace_back(what, how);
  }
  void add(const ReadingMembers& more) {
    members_.insert(members_.end(), more.begin(), more.end());
  }
  ReadingMembers take() { return std::move(members_); }

 private:
  ReadingMembers members_;
};

std::string_view frame_text(const PosesDone& poses) {
  if (!poses.frame) return "";
  if (*poses.frame == PoseFrame::kCamera)
    return "camera, turned into the lidar's by Tr of calib.txt";
  return poses.frame_by_mark ? "lidar, as the .frame beside the file says" : "lidar";
}

std::string_view direction_text(const PosesDone& poses) {
  if (!poses.direction) return "";
  return *poses.direction == PoseDirection::kSensorFromMap ? "sensor_from_map, inverted"
                                                           : "map_from_sensor";
}

}  // namespace

std::int64_t Reading::moved_ns(std::int64_t pose_ns) const {
  std::int64_t moved = 0;
  const bool is_beyond = __builtin_add_overflow(pose_ns, std::llround(pose_offset_s * 1e9), &moved);
  if (!is_beyond) return moved;
  return pose_ns < 0 ? std::numeric_limits<std::int64_t>::min()
                     : std::numeric_limits<std::int64_t>::max();
}

std::vector<std::string> lidar_names(const Reading& asked) {
  constexpr std::size_t kMost = 6;
  const std::string all = asked.lidars.value_or("");
  std::vector<std::string> names;
  for (const std::string_view part : split_at_commas(all)) {
    if (part.empty() || names.size() == kMost || std::ranges::find(names, part) != names.end()) {
      throw UsageError(fmt::format("{}: expected the names of one to six LiDARs, each once",
                                   option("lidars", all)));
    }
    names.emplace_back(part);
  }
  return names;
}

std::string to_string(const Perturbation& perturbation) {
  std::vector<std::string> parts;
  for (const PerturbStep& step : perturbation.steps) {
    parts.push_back(fmt::format("{}={}", step.kind, step.strength));
  }
  if (has(perturbation, "pose_jump") && perturbation.jump_scan) {
    parts.push_back(fmt::format("pose_jump_scan={}", *perturbation.jump_scan));
  }
  if (has(perturbation, "beams")) {
    parts.push_back(fmt::format("beams_of={}", perturbation.beams_of));
    if (perturbation.beams_top_deg) {
      parts.push_back(fmt::format("beams_top_deg={},beams_bottom_deg={}",
                                  *perturbation.beams_top_deg, *perturbation.beams_bottom_deg));
    }
  }
  if (has(perturbation, "rain") || has(perturbation, "fog")) {
    parts.push_back(fmt::format("sensor_range_m={}", perturbation.sensor_range_m));
  }
  parts.push_back(fmt::format("seed={}", perturbation.seed));
  return fmt::format("{}", fmt::join(parts, ","));
}

std::string_view to_string(BagUndistortion undistortion) {
  constexpr std::array<std::string_view, 6> kTexts = {
      "not by the points' times",
      "none, the points have no times",
      "none, as told",
      "by the points' times, but for scans at the ends of the poses",
      "by the points' times",
      "none, the points' times are not used"};
  return kTexts[static_cast<std::size_t>(undistortion)];
}

ReadingMembers members_of(const PosesDone& poses) {
  Members members;
  members.add("poses", poses.source);
  if (poses.format) members.add("pose_format", to_string(*poses.format));
  members.add("pose_pairing", poses.pairing);
  if (poses.offset_s.value_or(0.0) != 0.0)
    members.add("pose_offset_s", fmt::format("{}", *poses.offset_s));
  members.add("pose_direction", direction_text(poses));
  members.add("pose_frame", frame_text(poses));
  members.add("pose_origin", poses.origin);
  members.add("pose_odometry", poses.odometry);
  members.add("pose_map", poses.map);
  if (poses.refined) members.add("pose_refinement", "registration to the scans before");
  return members.take();
}

ReadingMembers members_of(const ReadingDone& reading) {
  Members members;
  members.add("scans", reading.scans);
  members.add("drop_scans", reading.drop_scans);
  members.add("scan_files", reading.scan_files);
  members.add("lidars", reading.lidars);
  if (reading.bin_columns) members.add("bin_columns", std::to_string(*reading.bin_columns));
  members.add("point_times", reading.point_times);
  members.add("stamps", reading.stamps);
  members.add("truth", reading.truth);
  members.add(members_of(reading.poses));
  if (reading.undistortion) members.add("undistortion", to_string(*reading.undistortion));
  if (reading.hdl64_correction) members.add("hdl64_correction", "points raised by 0.205 degrees");
  members.add("drop_ego", reading.drop_ego);
  if (reading.deskew) members.add("deskew", to_string(*reading.deskew));
  if (reading.perturb) members.add("perturb", to_string(*reading.perturb));
  return members.take();
}

}  // namespace mosbench
