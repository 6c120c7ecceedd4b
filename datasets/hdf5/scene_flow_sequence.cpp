#include "datasets/hdf5/scene_flow_sequence.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "datasets/disk/folder_listing.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/hdf5/flow_truth.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr const char* kExpectedGroups =
    "groups of OpenSceneFlow, named by stamps, with lidar (N, 3 or more)";

std::string arrow(const Hdf5Group& group, std::string_view name) {
  return fmt::format("{}/{}", shown_in_line(group.name), name);
}

bool is_rotation(const Eigen::Matrix3d& rotation) {
  const Eigen::Matrix3d deviation =
      (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs();
  return (deviation.array() <= kRotationTolerance).all() && rotation.determinant() > 0.0;
}

/// An array with one value per point, or of points in rows of one.
bool is_list_of(const Hdf5Array& array, std::uint64_t points) {
  const bool is_flat = array.shape.size() == 1 || (array.shape.size() == 2 && array.shape[1] == 1);
  return is_flat && array.shape[0] == points;
}

}  // namespace

SceneFlowSequence::SceneFlowSequence(std::string name, const std::filesystem::path& file,
                                     const Reading& asked)
    : file_(file, scene_flow::kAll),
      moving_speed_m_s_(asked.moving_speed_m_s.value_or(kFlowMovingSpeed_m_s)) {
  Recording& recording = mutable_recording();
  recording.name = SequenceName(std::move(name), file);
  recording.files = {file};
  recording.reading.scan_files = file.filename().string();
  list_scans();
  take_poses(asked);
  state_truth(asked);
}

/// Labels that `convert` wrote stand in place of the flow.
void SceneFlowSequence::state_truth(const Reading& asked) {
  bool by_labels = false;
  std::size_t by_flow = 0, by_any_flow = 0;
  for (std::size_t k = 0; k < scans_.size(); ++k) {
    if (has_labels(k)) {
      by_labels = true;
    } else if (has_flow(k)) {
      ++by_flow;
      if (find_array(*scans_[k].group, scene_flow::kValid) == nullptr) ++by_any_flow;
    }
  }
  if (by_labels && by_flow == 0 && asked.moving_speed_m_s) {
    throw UsageError(fmt::format(
        "{}: the truth of {} is its array {}, without speeds, expected no such flag, or files with "
        "flow",
        option("moving_speed_m_s"), file_.path().string(), scene_flow::kLabel));
  }
  const std::string flow = fmt::format("flow, moving from {:g} m/s on", moving_speed_m_s_);
  const std::string labels(scene_flow::kLabel);
  mutable_recording().reading.truth = !by_labels    ? flow
                                      : by_flow > 0 ? fmt::format("{}, else {}", labels, flow)
                                                    : labels;
  if (by_any_flow > 0) {
    mutable_recording().remarks.push_back(
        fmt::format("{} flow without {}: all of it is taken for valid",
                    counted(by_any_flow, "scan has", "scans have"), scene_flow::kValid));
  }
}

/// Takes groups in the order of their stamps. A drive that was cut may leave a group without
/// arrays.
void SceneFlowSequence::list_scans() {
  std::vector<const Hdf5Group*> empty;
  for (const Hdf5Group& group : file_.groups()) {
    const auto stamp = stem_number(group.name);
    if (!stamp || group.name.size() > 19) {
      throw DataError(file_.path(),
                      "group " + shown_in_line(group.name) + " is not named by a stamp",
                      kExpectedGroups);
    }
    if (group.arrays.empty()) {
      empty.push_back(&group);
    } else {
      scans_.push_back(scan_of(group, *stamp));
    }
  }
  if (scans_.empty()) throw DataError(file_.path(), "holds no scans", kExpectedGroups);
  std::ranges::sort(scans_, {}, &Scan::stamp_ns);
  const auto same = std::ranges::adjacent_find(scans_, {}, &Scan::stamp_ns);
  if (same != scans_.end()) {
    throw DataError(file_.path(),
                    fmt::format("groups {} and {} have the same stamp", same->group->name,
                                std::next(same)->group->name),
                    "a stamp per scan");
  }
  if (!empty.empty()) {
    mutable_recording().remarks.push_back(
        fmt::format("{} groups without arrays are left out, the first is {}", empty.size(),
                    shown_in_line(empty.front()->name)));
  }
  convert_stamps();
}

SceneFlowSequence::Scan SceneFlowSequence::scan_of(const Hdf5Group& group,
                                                   std::uint64_t stamp) const {
  if (find_array(group, scene_flow::kLidar) == nullptr) {
    throw DataError(file_.path(), "group " + shown_in_line(group.name) + " has no lidar",
                    kExpectedGroups);
  }
  if (stamp > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
    throw DataError(file_.path(), "group " + group.name + " is later than any stamp",
                    "nanoseconds or microseconds");
  }
  Scan scan{&group, static_cast<std::int64_t>(stamp), check_points(group), {}};
  if (find_array(group, scene_flow::kPose) != nullptr) {
    scan.map_from_sensor = pose_in(group, scene_flow::kPose);
  }
  return scan;
}

/// Stamps of Argoverse 2 are nanoseconds, those of Waymo and nuScenes microseconds: scans are
/// between 5 ms and 5 s apart. One scan alone is told by its digits.
void SceneFlowSequence::convert_stamps() {
  constexpr std::int64_t kLongestUs = 5'000'000, kThousand = 1000;
  constexpr std::int64_t kLatestUs = 100'000'000'000'000'000;
  std::vector<std::int64_t> steps;
  for (std::size_t k = 0; k + 1 < scans_.size(); ++k) {
    steps.push_back(scans_[k + 1].stamp_ns - scans_[k].stamp_ns);
  }
  bool is_us = scans_.front().stamp_ns < kLatestUs;
  if (!steps.empty()) {
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::ranges::nth_element(steps, middle);
    is_us = *middle < kLongestUs;
  }
  mutable_recording().reading.stamps = is_us ? "us" : "ns";
  if (!is_us) return;
  for (Scan& scan : scans_) {
    if (scan.stamp_ns > std::numeric_limits<std::int64_t>::max() / kThousand) {
      throw DataError(file_.path(), "group " + scan.group->name + " is later than any stamp",
                      "microseconds, as its neighbours");
    }
    scan.stamp_ns *= kThousand;
  }
}

/// Throws DataError for a scan without pose: among all scans, or among those whose flow holds the
/// sensor's own motion.
void SceneFlowSequence::require_poses(bool of_all) const {
  const auto flows_by_poses = [&](std::size_t scan) {
    return has_flow(scan) && !has_labels(scan) &&
           find_array(*scans_[scan].group, scene_flow::kEgoMotion) == nullptr;
  };
  for (std::size_t k = 0; k < scans_.size(); ++k) {
    const bool of_flow = flows_by_poses(k) || (k > 0 && flows_by_poses(k - 1));
    if (scans_[k].map_from_sensor || !(of_all || of_flow)) continue;
    const std::string lack =
        fmt::format("group {} has no pose", shown_in_line(scans_[k].group->name));
    if (of_flow) {
      throw DataError(file_.path(), lack, "pose (4, 4) or ego_motion where there is flow");
    }
    throw MissingPoses(
        file_.path(), lack,
        fmt::format("pose (4, 4) in each group, in a file given by {}, or found by odometry",
                    option("poses")));
  }
}

void SceneFlowSequence::take_poses(const Reading& asked) {
  Recording& recording = mutable_recording();
  require_poses(asked.has_own_poses());
  for (std::size_t k = 0; k < scans_.size(); ++k) {
    ScanEntry& entry = recording.scans.emplace_back();
    entry.stem = scans_[k].group->name;
    entry.stamp_ns = scans_[k].stamp_ns;
    entry.points = scans_[k].points;
    entry.has_truth = has_flow(k) || has_labels(k);
  }
  if (!asked.has_own_poses()) {
    places_ = place_scans(file_.path().parent_path(), "poses.txt", asked, recording);
    return;
  }
  SensorPoses own = own_poses("pose of each group", file_.path());
  own.done.frame.reset();
  for (const Scan& scan : scans_) own.map_from_sensor.push_back(scan.map_from_sensor);
  places_ = place_scans(std::move(own), recording);
}

/// Returns the number of points, which every array has that tells something of them.
std::size_t SceneFlowSequence::check_points(const Hdf5Group& group) const {
  const auto refuse = [&](const Hdf5Array& array, const std::string& expected) {
    throw DataError(
        file_.path(),
        fmt::format("{} has shape ({})", arrow(group, array.name), fmt::join(array.shape, ", ")),
        expected);
  };
  const Hdf5Array& lidar = *find_array(group, scene_flow::kLidar);
  if (lidar.shape.size() != 2 || lidar.shape[1] < 3 || lidar.shape[1] > 64) {
    refuse(lidar, "(N, 3 or more)");
  }
  const std::uint64_t points = lidar.shape[0];
  for (const Hdf5Array& array : group.arrays) {
    if (array.name == scene_flow::kLidar) continue;
    if (array.name == scene_flow::kPose || array.name == scene_flow::kEgoMotion) {
      if (array.shape != std::vector<std::uint64_t>{4, 4}) refuse(array, "(4, 4)");
    } else if (array.name == scene_flow::kFlow) {
      if (array.shape != std::vector<std::uint64_t>{points, 3}) {
        refuse(array, fmt::format("({}, 3)", points));
      }
    } else if (!is_list_of(array, points)) {
      refuse(array, fmt::format("({})", points));
    }
  }
  return points;
}

Pose SceneFlowSequence::pose_in(const Hdf5Group& group, std::string_view name) const {
  const std::vector<double> numbers = file_.reals(group, *find_array(group, name));
  const Eigen::Matrix4d matrix =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
  if (!matrix.allFinite() || !is_rotation(matrix.topLeftCorner<3, 3>()) ||
      matrix.row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)) {
    throw DataError(file_.path(), arrow(group, name) + " is no pose",
                    "a rotation, a translation and the row 0 0 0 1");
  }
  Pose pose = Pose::Identity();
  pose.matrix() = matrix;
  return pose;
}

bool SceneFlowSequence::has_labels(std::size_t scan) const {
  return find_array(*scans_[scan].group, scene_flow::kLabel) != nullptr;
}

/// The flow of the last scan leads nowhere.
bool SceneFlowSequence::has_flow(std::size_t scan) const {
  return scan + 1 < scans_.size() && find_array(*scans_[scan].group, scene_flow::kFlow) != nullptr;
}

/// Far from the origin float32 moves a sensor by steps that would pass for motion of the points.
void SceneFlowSequence::refuse_coarse_pose(const Scan& scan, double time_s) const {
  constexpr double kMostShare = 0.2;  // of the speed that counts as motion
  if (find_array(*scan.group, scene_flow::kPose)->number.bytes != sizeof(float)) return;
  const auto far_m = static_cast<float>(scan.map_from_sensor->translation().cwiseAbs().maxCoeff());
  const float step_m = float_step_m(far_m);
  if (step_m <= kMostShare * moving_speed_m_s_ * time_s) return;
  throw DataError(file_.path(),
                  fmt::format("{} is float32, {} m apart at {:.0f} m, too coarse for flow",
                              arrow(*scan.group, scene_flow::kPose), step_m, far_m),
                  "float64, or ego_motion");
}

/// The motion by which the flow was computed, where the file keeps it.
SensorStep SceneFlowSequence::step_after(std::size_t scan) const {
  const Scan& from = scans_[scan];
  const Scan& to = scans_[scan + 1];
  const double time_s = static_cast<double>(to.stamp_ns - from.stamp_ns) * 1e-9;
  if (find_array(*from.group, scene_flow::kEgoMotion) != nullptr) {
    return {pose_in(*from.group, scene_flow::kEgoMotion), time_s};
  }
  refuse_coarse_pose(from, time_s);
  refuse_coarse_pose(to, time_s);
  return {to.map_from_sensor->inverse() * *from.map_from_sensor, time_s};
}

std::vector<Point> SceneFlowSequence::points_of(const Scan& scan, std::vector<Point> reused) const {
  const Hdf5Array& lidar = *find_array(*scan.group, scene_flow::kLidar);
  const std::vector<float> numbers = file_.floats(*scan.group, lidar);
  const std::size_t columns = lidar.shape[1];
  reused.resize(scan.points);
  for (std::size_t i = 0; i < scan.points; ++i) {
    const float* row = numbers.data() + i * columns;
    reused[i] = {row[0], row[1], row[2], columns > 3 ? row[3] : 0.0F};
  }
  return reused;
}

std::vector<std::int64_t> SceneFlowSequence::values(const Scan& scan, std::string_view name) const {
  const Hdf5Array* array = find_array(*scan.group, name);
  return array == nullptr ? std::vector<std::int64_t>{} : file_.integers(*scan.group, *array);
}

/// Throws DataError for numbers that `Value` cannot hold.
template <typename Value>
std::vector<Value> SceneFlowSequence::values_as(const Scan& scan, std::string_view name) const {
  std::vector<Value> held;
  for (const std::int64_t value : values(scan, name)) {
    if (!std::in_range<Value>(value)) {
      throw DataError(file_.path(),
                      fmt::format("{}[{}] is {}", arrow(*scan.group, name), held.size(), value),
                      fmt::format("0 to {}", std::numeric_limits<Value>::max()));
    }
    held.push_back(static_cast<Value>(value));
  }
  return held;
}

std::vector<std::uint8_t> SceneFlowSequence::flags(const Scan& scan, std::string_view name) const {
  std::vector<std::uint8_t> flags;
  for (const std::int64_t value : values(scan, name)) flags.push_back(value != 0 ? 1 : 0);
  return flags;
}

PointMotions SceneFlowSequence::motions_of(std::size_t scan_place,
                                           std::span<const Point> points) const {
  const Scan& scan = scans_[scan_place];
  const Hdf5Array& flow = *find_array(*scan.group, scene_flow::kFlow);
  std::vector<std::int64_t> valid = values(scan, scene_flow::kValid);
  if (valid.empty()) valid.assign(points.size(), 1);
  PointMotions motions;
  motions.velocities_m_s =
      velocities(points, file_.floats(*scan.group, flow), valid, step_after(scan_place));
  motions.classes = values_as<std::uint8_t>(scan, scene_flow::kClass);
  motions.on_ground = flags(scan, scene_flow::kGround);
  motions.evaluated = flags(scan, scene_flow::kEvaluated);
  return motions;
}

/// Adds the objects' numbers as instances to the labels by speed.
std::vector<std::uint32_t> SceneFlowSequence::labels_of(std::size_t scan_place,
                                                        const PointMotions& motions) const {
  constexpr std::int64_t kInstances = 65536;
  std::vector<std::uint32_t> labels = flow_labels(motions, moving_speed_m_s_);
  const std::vector<std::int64_t> objects = values(scans_[scan_place], scene_flow::kInstance);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (labels[i] == 0 || objects[i] <= 0 || objects[i] >= kInstances) continue;
    labels[i] |= static_cast<std::uint32_t>(objects[i]) << 16U;
  }
  return labels;
}

std::vector<std::uint32_t> SceneFlowSequence::stored_labels(const Scan& scan) const {
  return values_as<std::uint32_t>(scan, scene_flow::kLabel);
}

void SceneFlowSequence::read(std::size_t scan_index, Frame& frame) const {
  const std::size_t place = places_.at(scan_index);
  frame.points = points_of(scans_[place], std::move(frame.points));
  describe(scan_index, frame);
  frame.truth.reset();
  if (has_labels(place)) {
    frame.truth = stored_labels(scans_[place]);
  } else if (has_flow(place)) {
    frame.motions = motions_of(place, frame.points);
    frame.truth = labels_of(place, *frame.motions);
  }
}

std::vector<std::uint32_t> SceneFlowSequence::read_truth(std::size_t scan_index) const {
  if (!has_truth(scan_index)) refuse_truth(scan_index);
  const std::size_t place = places_.at(scan_index);
  if (has_labels(place)) return stored_labels(scans_[place]);
  return labels_of(place, motions_of(place, points_of(scans_[place], {})));
}

std::vector<std::string> evaluated_scans(const std::filesystem::path& file) {
  const Hdf5File opened(file, std::span(&scene_flow::kEvaluated, 1));
  std::vector<std::string> scans;
  for (const Hdf5Group& group : opened.groups()) {
    if (!group.arrays.empty()) scans.push_back(group.name);
  }
  std::ranges::sort(scans);
  return scans;
}

}  // namespace mosbench
