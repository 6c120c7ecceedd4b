#include "eval/report/report_path.hpp"

#include <cmath>
#include <optional>

#include "datasets/text/errors.hpp"
#include "eval/trajectory/alignment.hpp"
#include "eval/trajectory/pose_errors.hpp"
#include "eval/trajectory/trajectory.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

/// To the millimetre, which no chart shows.
double rounded_m(double value_m) { return std::round(value_m * 1e3) / 1e3; }

ordered_json numbers(const std::vector<double>& values_m) {
  ordered_json json = ordered_json::array();
  for (const double value_m : values_m) json.push_back(rounded_m(value_m));
  return json;
}

ordered_json seen_from_above(const std::vector<Pose>& poses) {
  ordered_json json = ordered_json::array();
  for (const Pose& pose : poses) {
    json.push_back({rounded_m(pose.translation().x()), rounded_m(pose.translation().y())});
  }
  return json;
}

std::vector<Pose> poses_of(const Sequence& sequence) {
  std::vector<Pose> poses;
  for (std::size_t k = 0; k < sequence.size(); ++k) poses.push_back(sequence.map_from_sensor(k));
  return poses;
}

bool are_same_scans(const Sequence& one, const Sequence& other) {
  bool same = one.size() == other.size();
  for (std::size_t k = 0; same && k < one.size(); ++k) same = one.stem(k) == other.stem(k);
  return same;
}

/// The poses that the data set itself has for the scans of a run that took others. Nothing if the
/// run took these, or if they cannot be read.
std::optional<std::vector<Pose>> poses_passed_over(const Result& result, const ResultScans& scans) {
  Reading reading = reading_of(result);
  if (reading.has_own_poses()) return std::nullopt;
  reading.poses = OwnPoses{};
  reading.pose_format.reset();
  reading.pose_frame.reset();
  reading.pose_direction.reset();
  try {
    const Dataset own =
        open_dataset(scans.dataset().root, {scans.dataset().kind, {result.sequence}, reading});
    const Sequence& sequence = *own.sequences.front();
    if (are_same_scans(sequence, scans.sequence())) return poses_of(sequence);
  } catch (const DataError&) {  // most runs take other poses because there are none
  }
  return std::nullopt;
}

}  // namespace

ordered_json path_of(const Result& result, const ResultScans& scans) {
  const std::vector<Pose> of_run = poses_of(scans.sequence());
  const auto own = poses_passed_over(result, scans);
  if (!own) return {{"run_m", seen_from_above(of_run)}};
  const std::vector<Pose> moved = aligned(of_run, *own, PathAlignment::kOrigin).value().poses;
  return {{"run_m", seen_from_above(moved)},
          {"own_m", seen_from_above(*own)},
          {"way_m", numbers(path_lengths_m(*own))},
          {"off_m", numbers(absolute_errors(*own, moved).translation_m)}};
}

}  // namespace mosbench
