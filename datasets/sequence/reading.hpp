#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/sequence/scan_range.hpp"

namespace mosbench {

/// The sensor that the poses of a file belong to.
enum class PoseFrame : std::uint8_t {
  kLidar,
  kCamera  ///< the camera of Tr in calib.txt
};
inline constexpr std::array<std::string_view, 2> kPoseFrameNames = {"lidar", "camera"};

enum class PoseDirection : std::uint8_t { kMapFromSensor, kSensorFromMap };
inline constexpr std::array<std::string_view, 2> kPoseDirectionNames = {"map-from-sensor",
                                                                        "sensor-from-map"};

/// The motion of the sensor by which scans are corrected whose points have times.
enum class Deskew : std::uint8_t {
  kNone,
  kVelocity,  ///< that since the scan before
  kPoses      ///< that between the poses around each point
};
inline constexpr std::array<std::string_view, 3> kDeskewNames = {"none", "velocity", "poses"};
inline std::string_view to_string(Deskew deskew) {
  return kDeskewNames[static_cast<std::size_t>(deskew)];
}

/// Where the times of points come from when the scans do not say.
enum class PointTimes : std::uint8_t {
  kColumn,   ///< the fifth float32 of each point in .bin files, a field of .pcd and .ply files, in
             ///< the unit that `PointClock` finds
  kAzimuth,  ///< the direction of each point, as the sensor of KITTI turns
  kSeconds,  ///< as kColumn, and of a bag's field, in this unit; the others follow as in TimeUnit
  kMilliseconds,
  kMicroseconds,
  kNanoseconds,
  kSteps
};
inline constexpr std::array<std::string_view, 7> kPointTimesNames = {
    "column", "azimuth", "s", "ms", "us", "ns", "steps"};

/// Whether something is searched and left out.
enum class Drop : std::uint8_t { kOff, kAuto };
inline constexpr std::array<std::string_view, 2> kDropNames = {"off", "auto"};

/// Where poses come from: the data set, a file of the user or a folder with one per sequence, later
/// odometry, or nowhere, as the sensor stands still. Without poses every scan has the identity.
struct OwnPoses {};
struct PoseFile {
  std::filesystem::path path;
};
struct ByOdometry {};
struct StaticPoses {};
using PosesFrom = std::variant<OwnPoses, PoseFile, ByOdometry, StaticPoses>;
/// What stands for StaticPoses in options, and in PosesDone::source.
inline constexpr std::string_view kStaticPoses = "static";
/// The same of scans that are read without poses.
inline constexpr std::string_view kNoPoses = "none";

/// One disturbance of a list.
struct PerturbStep {
  std::string_view kind;  ///< the name in `perturb_kinds()`
  double strength;        ///< in the kind's unit
};

/// Disturbances in the order in which they are applied, and what they share.
struct Perturbation {
  std::vector<PerturbStep> steps;
  std::uint64_t seed = 1;                ///< of everything random
  std::optional<std::size_t> jump_scan;  ///< where poses jump; without it, the middle scan
  std::size_t beams_of = 64;             ///< of the sensor
  std::optional<double> beams_top_deg, beams_bottom_deg;  ///< elevations of the outer beams
  double sensor_range_m = 120.0;  ///< of the weakest target that is seen in clear air
};

/// Returns the text that says the same with every shared key that one of the kinds uses, for
/// records: equal texts disturb equally.
std::string to_string(const Perturbation& perturbation);

/// What the user asked about how a sequence is to be read.
struct Reading {
  /// Of each sequence; its poses, truth and times of points are found as if all were read.
  std::optional<ScanRange> scans = std::nullopt;
  PosesFrom poses = OwnPoses{};
  std::optional<PoseFormat> pose_format = std::nullopt;  ///< recognised when not set
  /// When not set, KITTI rows are the camera's if calib.txt holds a Tr other than the identity and
  /// no mark beside the file says otherwise; all others are the lidar's.
  std::optional<PoseFrame> pose_frame = std::nullopt;
  /// When not set, only poses of PoseFormat::kRollout are sensor_from_map.
  std::optional<PoseDirection> pose_direction = std::nullopt;
  /// Scans between stamped poses farther apart than this are left out.
  double max_pose_gap_s = 0.5;
  double pose_offset_s = 0.0;  ///< added to the stamps of poses, to read them by the scans' clock
  std::optional<std::string> topic = std::nullopt;      ///< of a bag's PointCloud2
  std::optional<std::string> lidars = std::nullopt;     ///< see `lidar_names`
  std::optional<std::string> map_frame = std::nullopt;  ///< of a bag's tf tree
  /// Of a bag's poses; searched when not set.
  std::optional<std::string> pose_topic = std::nullopt;
  /// When not set: by the poses, except that odometry registers scans as its own setting says.
  std::optional<Deskew> deskew = std::nullopt;
  std::optional<PointTimes> point_times = std::nullopt;  ///< when not set, those of a bag's points
  /// Of truth that has speeds: from which one on a point moves; when not set, 0.5, and 0.05 m until
  /// the next scan where the truth is a flow.
  std::optional<double> moving_speed_m_s = std::nullopt;
  /// float32 per point in .bin files; when not set 4, and scans that clearly have others are
  /// refused.
  std::optional<std::size_t> bin_columns = std::nullopt;
  bool refine_poses = false;  ///< whether scans are registered to correct them
  /// Whether points of KITTI's HDL-64E are raised by the angle that its calibration misses.
  bool hdl64_correction = false;
  Drop drop_ego = Drop::kOff;    ///< points of the vehicle itself
  Drop drop_scans = Drop::kOff;  ///< scans without points, and those with the points of another
  /// Disturbances of what is read.
  std::optional<Perturbation> perturb = std::nullopt;

  /// Whether several LiDARs may be merged.
  bool is_rig() const { return lidars && lidars->find(',') != std::string::npos; }
  /// Whether the times of points that scans hold are wanted by name.
  bool takes_column() const { return point_times && *point_times != PointTimes::kAzimuth; }
  /// Whether points with times are to be moved.
  bool undistorts() const { return deskew != Deskew::kNone; }
  /// Returns the stamp of a pose by the clock of the scans.
  std::int64_t moved_ns(std::int64_t pose_ns) const;
  bool has_own_poses() const { return std::holds_alternative<OwnPoses>(poses); }
  bool is_by_odometry() const { return std::holds_alternative<ByOdometry>(poses); }
  bool is_static() const { return std::holds_alternative<StaticPoses>(poses); }
  /// Returns the file or folder of PoseFile; null for poses from elsewhere.
  const std::filesystem::path* pose_file() const {
    const auto* file = std::get_if<PoseFile>(&poses);
    return file == nullptr ? nullptr : &file->path;
  }
};

/// What a text is that is no number and no choice: "FILE", "TOPIC".
struct FieldText {
  std::string_view type;
};
/// From the time since boot to that since 1970.
inline constexpr double kLongestOffset_s = 4e9;

/// The legal values of a quantity, and what to call one.
struct FieldQuantity {
  std::string_view type;      ///< "SECONDS"
  std::string_view noun;      ///< "time"
  std::string_view expected;  ///< "seconds"
  double lowest = 0.0;
  bool lowest_is_legal = true;
  double highest = std::numeric_limits<double>::infinity();
};

struct FieldCount {
  std::size_t lowest, highest;
};

template <typename Record>
concept IsReading = std::same_as<std::remove_const_t<Record>, Reading>;

/// The one list of what can be asked: flags, keys of YAML and of result.json, keywords of Python
/// and help follow from it. Calls visit(name, field, what is legal, meaning).
template <IsReading Asked, typename Visit>
void visit_fields(Asked& reading, Visit&& visit) {
  visit(
      "scans", reading.scans, FieldText{"RANGE"},
      "Only scans FROM:TO:STEP of each sequence, counted from 0, TO not among them; each part may "
      "be left out, and N means :N (default: all)");
  visit("poses", reading.poses, FieldText{"FILE"},
        "Pose file to take instead of the sequence's own, a folder with one per sequence, or "
        "static: the sensor stands still");
  visit("refine_poses", reading.refine_poses, FieldText{},
        "Correct the poses by registering each scan to those before");
  visit("pose_format", reading.pose_format, kPoseFormatNames,
        "Rows of 12 numbers, stamped rows with a quaternion, or Dynablox's rollout CSV (default: "
        "recognised)");
  visit("pose_frame", reading.pose_frame, kPoseFrameNames,
        "Sensor that the poses are of; Tr of calib.txt turns those of the camera into the lidar's "
        "(default: camera if calib.txt has a Tr and the poses are KITTI rows, unless `mosbench "
        "odometry` wrote them)");
  visit("pose_direction", reading.pose_direction, kPoseDirectionNames,
        "sensor-from-map poses are inverted (default: sensor-from-map for dynablox only)");
  visit("max_pose_gap_s", reading.max_pose_gap_s, FieldQuantity{"SECONDS", "time", "seconds"},
        "Scans between stamped poses farther apart are left out");
  visit("pose_offset_s", reading.pose_offset_s,
        FieldQuantity{"SECONDS", "time", "seconds", -kLongestOffset_s, true, kLongestOffset_s},
        "Added to the stamps of poses whose clock is not that of the scans");
  visit("topic", reading.topic, FieldText{"TOPIC"}, "PointCloud2 topic of a bag");
  visit("lidars", reading.lidars, FieldText{"NAME,..."},
        "Topics of a bag, or folders of scans beside mounts.txt (per LiDAR name tx ty tz qx qy qz "
        "qw of vehicle_from_lidar, metres): one LiDAR, or up to six that are merged, the first of "
        "which gives stamps and poses");
  visit("map_frame", reading.map_frame, FieldText{"FRAME"}, "Map frame in the tf tree of a bag");
  visit("pose_topic", reading.pose_topic, FieldText{"TOPIC"},
        "Topic of poses of a bag (default: found)");
  visit("deskew", reading.deskew, kDeskewNames,
        "Move points that have times to where the sensor saw them at the stamp, by the motion "
        "since the scan before or by the poses around (default: poses; to register scans: "
        "velocity)");
  visit(
      "point_times", reading.point_times, kPointTimesNames,
      "When points were measured: a column (fifth of .bin files, or a field), whose unit is found "
      "or told, or azimuth as KITTI's sensor turns (default: fields of bags, .pcd and .ply)");
  visit("moving_speed_m_s", reading.moving_speed_m_s,
        FieldQuantity{"M/S", "speed", "m/s above 0", 0.0, false},
        "Speed from which on points of truth by flow or boxes move: opensceneflow, kitti-raw, "
        "kitti-tracking (default: 0.5)");
  visit("bin_columns", reading.bin_columns, FieldCount{kFewestBinColumns, kMostBinColumns},
        "float32 per point in .bin files: 4, 3 (no intensity), 5 (ring of nuScenes, times) or more "
        "(default: 4, and files that clearly hold others are refused)");
  visit("hdl64_correction", reading.hdl64_correction, FieldText{},
        "Raise points by the 0.205 degrees that KITTI's calibration of its HDL-64E misses");
  visit("drop_scans", reading.drop_scans, kDropNames,
        "Leave out scans without points, and scans that repeat the points of an earlier one: auto "
        "finds them (default: off)");
  visit("drop_ego", reading.drop_ego, kDropNames,
        "Leave out points of the vehicle itself and of what is mounted on it: auto finds them by "
        "poses that move 8 m (default: off)");
  visit("perturb", reading.perturb, FieldText{"KIND=STRENGTH,...,seed=N"},
        "Disturb what is read, in this order, see `mosbench list perturbations`");
}

/// How the poses of a sequence came about. What is empty does not apply.
struct PosesDone {
  std::string source;  ///< a file, a part of the data set, or a kind of odometry
  std::optional<PoseFormat> format = std::nullopt;
  std::string pairing = {};  ///< of rows and scans
  std::optional<PoseDirection> direction = std::nullopt;
  std::optional<PoseFrame> frame = std::nullopt;  ///< the camera's were turned into the lidar's
  bool frame_by_mark = false;                     ///< whether a mark beside the file says so
  bool refined = false;                           ///< whether registration corrected them
  /// Added to their stamps; nothing where no stamps look them up.
  std::optional<double> offset_s = std::nullopt;
  std::optional<double> fitting_offset_s = std::nullopt;  ///< that would fit better
  std::string origin = {};                                ///< of poses that were converted
  std::string odometry = {}, map = {};  ///< its settings, and what its map leaves out
};

/// What the times that the points of a bag have were used for.
enum class BagUndistortion : std::uint8_t {
  kOtherTimes,
  kNoTimes,
  kAsTold,
  kButLast,
  kAll,
  kNoUnit
};

/// How a sequence was read, for results. What is empty does not apply.
struct ReadingDone {
  std::string scans = {};  ///< the range, and how many of how many these are
  std::string scan_files = {};
  std::string lidars = {};                                ///< that are merged
  std::optional<std::size_t> bin_columns = std::nullopt;  ///< unless the usual
  std::string point_times = {};
  std::string stamps = {};  ///< their unit
  std::string truth = {};
  PosesDone poses = {};
  std::optional<BagUndistortion> undistortion = std::nullopt;  ///< of bags
  bool hdl64_correction = false;
  std::string drop_scans = {}, drop_ego = {};  ///< what was left out
  std::optional<Deskew> deskew = std::nullopt;
  std::optional<Perturbation> perturb = std::nullopt;
};

std::string_view to_string(BagUndistortion undistortion);

/// Returns the topics or folders of Reading::lidars. Throws UsageError unless these are one to six.
std::vector<std::string> lidar_names(const Reading& asked);

/// The same for a LiDAR whose poses are those of another.
inline Reading without_poses(Reading asked) {
  asked.poses = ByOdometry{};
  return asked;
}

/// Returns what stands in results and on pages: (what, how) in a fixed order.
using ReadingMembers = std::vector<std::pair<std::string, std::string>>;
ReadingMembers members_of(const PosesDone& poses);
ReadingMembers members_of(const ReadingDone& reading);

}  // namespace mosbench
