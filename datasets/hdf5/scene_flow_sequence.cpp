#include "datasets/hdf5/scene_flow_sequence.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "datasets/disk/folder_listing.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/hdf5/flow_truth.hpp"
#include "datasets/hdf5/hdf5_file.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/numbers.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr const char* kExpectedGroups =
    "groups of OpenSceneFlow, named by stamps, with lidar (N, 3 or more)";

std::string arrow(const Hdf5Group& group, std::string_view name) {
  return fmt::format("{}/{}", shown_in_line(group.name), name);
}

/// An array with one value per point, or of points in rows of one.
bool is_list_of(const Hdf5Array& array, std::uint64_t points) {
  const bool is_flat = array.shape.size() == 1 || (array.shape.size() == 2 && array.shape[1] == 1);
  return is_flat && array.shape[0] == points;
}

/// The scans of an .h5 file of OpenSceneFlow, a group each, by stamp. A scan is labelled when it
/// has a flow to the next one, from which truth is computed by speed; or `mos_label`.
class SceneFlowSequence : public Sequence {
 public:
  /// Throws DataError.
  SceneFlowSequence(std::string name, const std::filesystem::path& file, const Reading& asked)
      : file_(file, scene_flow::kAll), moving_speed_m_s_(asked.moving_speed_m_s) {
    Recording& recording = mutable_recording();
    recording.name = SequenceName(std::move(name), file);
    recording.files = {file};
    recording.reading.scan_files = file.filename().string();
    if (!file_.mark().empty()) recording.mark = parse_mark(file_.mark(), file);
    recording.is_marked_inside = recording.mark.is_set() || others_have_marks(file);
    list_scans();
    take_poses(asked);
    state_truth(asked);
  }

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    const std::size_t place = places_.at(scan_index);
    frame.points = points_of(scans_[place], std::move(frame.points));
    describe(scan_index, frame);
    frame.truth.reset();
    if (has_labels(place)) {
      frame.truth = values_as<std::uint32_t>(scans_[place], scene_flow::kLabel);
    } else if (has_flow(place)) {
      FlowTruth flow = flow_truth(place, frame.points);
      frame.motions = std::move(flow.motions);
      frame.truth = std::move(flow.labels);
    }
  }

  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override {
    if (!has_truth(scan_index)) refuse_truth(scan_index);
    const std::size_t place = places_.at(scan_index);
    if (has_labels(place)) return values_as<std::uint32_t>(scans_[place], scene_flow::kLabel);
    return flow_truth(place, points_of(scans_[place], {})).labels;
  }

 private:
  /// A group, in the order of stamps.
  struct Scan {
    const Hdf5Group* group = nullptr;
    std::int64_t stamp_ns = 0;
    std::size_t points = 0;
    std::optional<Pose> map_from_sensor;  ///< the file's own

    const Hdf5Array* find(std::string_view name) const { return find_array(*group, name); }
  };

  struct FlowTruth {
    PointMotions motions;
    std::vector<std::uint32_t> labels;
  };

  /// Takes groups in the order of their stamps. A drive that was cut may leave a group without
  /// arrays.
  void list_scans() {
    std::vector<const Hdf5Group*> empty;
    for (const Hdf5Group& group : file_.groups()) {
      const auto stamp = stem_number(group.name);
      if (!stamp || group.name.size() > 19) {
        refuse("group " + shown_in_line(group.name) + " is not named by a stamp", kExpectedGroups);
      }
      if (group.arrays.empty()) empty.push_back(&group);
      if (!group.arrays.empty()) scans_.push_back(scan_of(group, *stamp));
    }
    if (scans_.empty()) refuse("holds no scans", kExpectedGroups);
    std::ranges::sort(scans_, {}, &Scan::stamp_ns);
    const auto same = std::ranges::adjacent_find(scans_, {}, &Scan::stamp_ns);
    if (same != scans_.end()) {
      refuse(fmt::format("groups {} and {} have the same stamp", same->group->name,
                         std::next(same)->group->name),
             "a stamp per scan");
    }
    if (!empty.empty()) {
      mutable_recording().doubts.push_back(
          fmt::format("{} groups without arrays are left out, the first is {}", empty.size(),
                      shown_in_line(empty.front()->name)));
    }
    convert_stamps();
  }

  /// Stamps of Argoverse 2 are nanoseconds, those of Waymo and nuScenes microseconds: scans are
  /// between 5 ms and 5 s apart. One scan alone is told by its digits.
  void convert_stamps() {
    constexpr double kLongestUs = 5e6;
    constexpr std::int64_t kThousand = 1000, kLatestUs = 100'000'000'000'000'000;
    std::vector<double> steps;
    for (std::size_t k = 0; k + 1 < scans_.size(); ++k) {
      steps.push_back(static_cast<double>(scans_[k + 1].stamp_ns - scans_[k].stamp_ns));
    }
    const bool is_us = steps.empty()
                           ? scans_.front().stamp_ns < kLatestUs
                           : quantile(std::move(steps), 0.5, QuantileRule::kUpper) < kLongestUs;
    mutable_recording().reading.stamps = is_us ? "us" : "ns";
    if (!is_us) return;
    for (Scan& scan : scans_) {
      if (scan.stamp_ns > std::numeric_limits<std::int64_t>::max() / kThousand) {
        refuse("group " + scan.group->name + " is later than any stamp",
               "microseconds, as its neighbours");
      }
      scan.stamp_ns *= kThousand;
    }
  }

  /// Throws DataError for a scan without pose: among all scans, or among those whose flow holds the
  /// sensor's own motion.
  void require_poses(bool of_all) const {
    const auto flows_by_poses = [&](std::size_t scan) {
      return has_flow(scan) && !has_labels(scan) &&
             scans_[scan].find(scene_flow::kEgoMotion) == nullptr;
    };
    for (std::size_t k = 0; k < scans_.size(); ++k) {
      const bool of_flow = flows_by_poses(k) || (k > 0 && flows_by_poses(k - 1));
      if (scans_[k].map_from_sensor || !(of_all || of_flow)) continue;
      const std::string lack =
          fmt::format("group {} has no pose", shown_in_line(scans_[k].group->name));
      if (of_flow) {
        refuse(lack, "pose (4, 4) or ego_motion where there is flow");
      }
      MissingPoses missing(
          file_.path(), lack,
          fmt::format("pose (4, 4) in each group, in a file given by {}, or found by odometry",
                      option("poses")));
      missing.of_some = std::ranges::any_of(
          scans_, [](const auto& scan) { return scan.map_from_sensor.has_value(); });
      throw missing;
    }
  }

  void take_poses(const Reading& asked) {
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

  /// Labels that `convert` wrote stand in place of the flow.
  void state_truth(const Reading& asked) {
    bool by_labels = false;
    std::size_t by_flow = 0, by_any_flow = 0;
    for (std::size_t k = 0; k < scans_.size(); ++k) {
      if (has_labels(k)) {
        by_labels = true;
      } else if (has_flow(k)) {
        ++by_flow;
        if (scans_[k].find(scene_flow::kValid) == nullptr) ++by_any_flow;
      }
    }
    if (by_labels && by_flow == 0 && asked.moving_speed_m_s) {
      throw UsageError(
          fmt::format("{}: the truth of {} is its array {}, without speeds, expected no such flag, "
                      "or files with flow",
                      option("moving_speed_m_s"), file_.path().string(), scene_flow::kLabel));
    }
    const std::string flow =
        moving_speed_m_s_
            ? fmt::format("flow, moving from {:g} m/s on", *moving_speed_m_s_)
            : fmt::format("flow, moving from {:g} m to the next scan on", kFlowMovingStep_m);
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

  Scan scan_of(const Hdf5Group& group, std::uint64_t stamp) const {
    if (find_array(group, scene_flow::kLidar) == nullptr) {
      refuse("group " + shown_in_line(group.name) + " has no lidar", kExpectedGroups);
    }
    if (stamp > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
      refuse("group " + group.name + " is later than any stamp", "nanoseconds or microseconds");
    }
    Scan scan{&group, static_cast<std::int64_t>(stamp), check_points(group), {}};
    if (find_array(group, scene_flow::kPose) != nullptr) {
      scan.map_from_sensor = pose_in(group, scene_flow::kPose);
    }
    return scan;
  }

  Pose pose_in(const Hdf5Group& group, std::string_view name) const {
    const std::vector<double> numbers = file_.reals(group, *find_array(group, name));
    const Eigen::Matrix4d matrix =
        Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
    if (!matrix.allFinite() || !is_rotation(matrix.topLeftCorner<3, 3>()) ||
        matrix.row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)) {
      refuse(arrow(group, name) + " is no pose", "a rotation, a translation and the row 0 0 0 1");
    }
    Pose pose = Pose::Identity();
    pose.matrix() = matrix;
    return pose;
  }

  /// Returns the number of points, which every array has that tells something of them.
  std::size_t check_points(const Hdf5Group& group) const {
    const auto refuse_shape = [&](const Hdf5Array& array, const std::string& expected) {
      refuse(
          fmt::format("{} has shape ({})", arrow(group, array.name), fmt::join(array.shape, ", ")),
          expected);
    };
    const Hdf5Array& lidar = *find_array(group, scene_flow::kLidar);
    if (lidar.shape.size() != 2 || lidar.shape[1] < 3 || lidar.shape[1] > 64) {
      refuse_shape(lidar, "(N, 3 or more)");
    }
    const std::uint64_t points = lidar.shape[0];
    for (const Hdf5Array& array : group.arrays) {
      if (array.name == scene_flow::kLidar) continue;
      if (array.name == scene_flow::kPose || array.name == scene_flow::kEgoMotion) {
        if (array.shape != std::vector<std::uint64_t>{4, 4}) refuse_shape(array, "(4, 4)");
      } else if (array.name == scene_flow::kFlow) {
        if (array.shape != std::vector<std::uint64_t>{points, 3}) {
          refuse_shape(array, fmt::format("({}, 3)", points));
        }
      } else if (!is_list_of(array, points)) {
        refuse_shape(array, fmt::format("({})", points));
      }
    }
    return points;
  }

  /// The flow of the last scan leads nowhere.
  bool has_flow(std::size_t scan) const {
    return scan + 1 < scans_.size() && scans_[scan].find(scene_flow::kFlow) != nullptr;
  }

  bool has_labels(std::size_t scan) const {
    return scans_[scan].find(scene_flow::kLabel) != nullptr;
  }

  double moving_step_m(double time_s) const {
    return moving_speed_m_s_ ? *moving_speed_m_s_ * time_s : kFlowMovingStep_m;
  }

  /// Far from the origin float32 moves a sensor by steps that would pass for motion of the points.
  void refuse_coarse_pose(const Scan& scan, double time_s) const {
    constexpr double kMostShare = 0.2;  // of the step that counts as motion
    if (scan.find(scene_flow::kPose)->number.bytes != sizeof(float)) return;
    const auto far_m =
        static_cast<float>(scan.map_from_sensor->translation().cwiseAbs().maxCoeff());
    const float step_m = float_step_m(far_m);
    if (step_m <= kMostShare * moving_step_m(time_s)) return;
    refuse(fmt::format("{} is float32, {} m apart at {:.0f} m, too coarse for flow",
                       arrow(*scan.group, scene_flow::kPose), step_m, far_m),
           "float64, or ego_motion");
  }

  /// The motion by which the flow was computed, where the file keeps it.
  SensorStep step_after(std::size_t scan) const {
    const Scan& from = scans_[scan];
    const Scan& to = scans_[scan + 1];
    const double time_s = static_cast<double>(to.stamp_ns - from.stamp_ns) * 1e-9;
    if (from.find(scene_flow::kEgoMotion) != nullptr) {
      return {pose_in(*from.group, scene_flow::kEgoMotion), time_s};
    }
    refuse_coarse_pose(from, time_s);
    refuse_coarse_pose(to, time_s);
    return {to.map_from_sensor->inverse() * *from.map_from_sensor, time_s};
  }

  std::vector<Point> points_of(const Scan& scan, std::vector<Point> reused) const {
    const Hdf5Array& lidar = *scan.find(scene_flow::kLidar);
    const std::vector<float> numbers = file_.floats(*scan.group, lidar);
    const std::size_t columns = lidar.shape[1];
    reused.resize(scan.points);
    for (std::size_t i = 0; i < scan.points; ++i) {
      const float* row = numbers.data() + i * columns;
      reused[i] = {row[0], row[1], row[2], columns > 3 ? row[3] : 0.0F};
    }
    return reused;
  }

  std::vector<std::int64_t> values(const Scan& scan, std::string_view name) const {
    const Hdf5Array* array = scan.find(name);
    return array == nullptr ? std::vector<std::int64_t>{} : file_.integers(*scan.group, *array);
  }

  /// Throws DataError for numbers that `Value` cannot hold.
  template <typename Value>
  std::vector<Value> values_as(const Scan& scan, std::string_view name) const {
    std::vector<Value> held;
    for (const std::int64_t value : values(scan, name)) {
      if (!std::in_range<Value>(value)) {
        refuse(fmt::format("{}[{}] is {}", arrow(*scan.group, name), held.size(), value),
               fmt::format("0 to {}", std::numeric_limits<Value>::max()));
      }
      held.push_back(static_cast<Value>(value));
    }
    return held;
  }

  std::vector<std::uint8_t> flags(const Scan& scan, std::string_view name) const {
    std::vector<std::uint8_t> flags;
    for (const std::int64_t value : values(scan, name)) flags.push_back(value != 0 ? 1 : 0);
    return flags;
  }

  /// The objects' numbers are the labels' instances.
  FlowTruth flow_truth(std::size_t scan_place, std::span<const Point> points) const {
    const Scan& scan = scans_[scan_place];
    const Hdf5Array& flow = *scan.find(scene_flow::kFlow);
    std::vector<std::int64_t> valid = values(scan, scene_flow::kValid);
    if (valid.empty()) valid.assign(points.size(), 1);
    const SensorStep step = step_after(scan_place);
    const auto moved_m = displacements(points, file_.floats(*scan.group, flow), valid, step);
    FlowTruth truth;
    truth.motions.velocities_m_s = velocities(moved_m, step);
    truth.motions.classes = values_as<std::uint8_t>(scan, scene_flow::kClass);
    truth.motions.on_ground = flags(scan, scene_flow::kGround);
    truth.motions.evaluated = flags(scan, scene_flow::kEvaluated);
    truth.labels = flow_labels(moved_m, truth.motions, moving_step_m(step.time_s));
    constexpr std::int64_t kInstances = 65536;
    const std::vector<std::int64_t> objects = values(scan, scene_flow::kInstance);
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (truth.labels[i] == 0 || objects[i] <= 0 || objects[i] >= kInstances) continue;
      truth.labels[i] |= static_cast<std::uint32_t>(objects[i]) << 16U;
    }
    return truth;
  }

  [[noreturn]] void refuse(const std::string& wrong, const std::string& expected) const {
    throw DataError(file_.path(), wrong, expected);
  }

  Hdf5File file_;
  std::optional<double> moving_speed_m_s_;  ///< in place of a displacement
  std::vector<Scan> scans_;                 ///< all of the file
  std::vector<std::size_t> places_;         ///< of the recording's scans in scans_
};

}  // namespace

std::unique_ptr<Sequence> open_scene_flow_file(std::string name, const std::filesystem::path& file,
                                               const Reading& asked) {
  return std::make_unique<SceneFlowSequence>(std::move(name), file, asked);
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
