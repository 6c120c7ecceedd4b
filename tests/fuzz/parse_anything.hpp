#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string_view>

#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/helipr_points.hpp"
#include "datasets/formats/kitti_calib.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/npy_file.hpp"
#include "datasets/formats/nuscenes_table.hpp"
#include "datasets/formats/pcd_file.hpp"
#include "datasets/formats/ply_file.hpp"
#include "datasets/formats/point_records.hpp"
#include "datasets/formats/point_times.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/formats/times_file.hpp"
#include "datasets/formats/tracklets.hpp"
#include "datasets/hdf5/scene_flow_sequence.hpp"
#include "datasets/rosbag/bag_sequence.hpp"
#include "datasets/rosbag/ros2_bag.hpp"
#include "datasets/rosbag/ros_messages.hpp"
#include "datasets/simulator/scene.hpp"
#include "datasets/text/errors.hpp"
#include "eval/predictions/prediction_files.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/result_scans.hpp"
#include "eval/result/settings_json.hpp"
#include "eval/tables/published.hpp"
#include "eval/truth/decisions.hpp"
#include "eval/truth/track_list.hpp"
#include "tests/fuzz/memory_file.hpp"
#include "tests/temp_folder.hpp"

/// Every parser of bytes with what must hold of any value it returns. A parser may throw DataError;
/// whatever else happens is a bug. Shared by the replayed corpus and the libFuzzer targets.
namespace mosbench::fuzz {

inline void require(bool holds) {
  if (!holds) std::abort();
}

inline void bin(std::string_view bytes) { require(format_bin(parse_bin(bytes, 4, "f")) == bytes); }

/// The first byte is the number of points.
inline void label(std::string_view bytes) {
  if (bytes.empty()) return;
  const std::size_t point_count = static_cast<unsigned char>(bytes.front());
  const auto labels = parse_labels(bytes.substr(1), point_count, "f");
  require(labels.size() == point_count && format_labels(labels) == bytes.substr(1));
}

/// The first byte is the number of points.
inline void dynamic_scores(std::string_view bytes) {
  if (bytes.empty()) return;
  const std::size_t point_count = static_cast<unsigned char>(bytes.front());
  const auto scores =
      parse_dynamic_scores(bytes.substr(1), point_count, ScoreNumbers::kFloat32, "f");
  require(scores.size() == point_count && format_dynamic_scores(scores) == bytes.substr(1));
}

inline void poses(std::string_view text) {
  const auto parsed = parse_poses(text, "f");
  const auto again = parse_poses(format_poses(parsed), "f");
  require(again.size() == parsed.size());
  for (std::size_t i = 0; i < parsed.size(); ++i) {
    require(parsed[i].matrix().allFinite() && parsed[i].linear().determinant() > 0.5);
    require(parsed[i].matrix() == again[i].matrix());
  }
}

inline void calib(std::string_view text) {
  const Pose parsed = parse_calib(text, "f");
  require(parsed.matrix().allFinite());
  require(parse_calib(format_calib(parsed), "f").matrix() == parsed.matrix());
}

inline void times(std::string_view text) {
  const auto parsed = parse_times(text, "f");
  require(parse_times(format_times(parsed), "f") == parsed);
}

inline void indices(std::string_view text) {
  const auto parsed = parse_indices(text, "f");
  const auto again = parse_indices(format_indices(parsed), "f");
  require(again.size() == parsed.size());
  for (std::size_t i = 0; i < parsed.size(); ++i) {
    require(std::is_sorted(parsed[i].moving.begin(), parsed[i].moving.end()));
    require(again[i].stamp_ns == parsed[i].stamp_ns && again[i].moving == parsed[i].moving);
  }
}

inline void split(std::string_view text) {
  const auto parsed = parse_split(text, "f");
  require(!parsed.empty() && parse_split(format_split(parsed), "f") == parsed);
}

inline void pcd(std::string_view bytes) {
  const PcdHeader header = parse_pcd_header(bytes, "f");
  require(header.body_offset_bytes <= bytes.size());
  require(parse_pcd(bytes, "f").points.size() == header.points);
  require(!header.has_labels || parse_pcd_labels(bytes, "f").size() == header.points);
  require(header.storage != PcdStorage::kBinary ||
          bytes.size() - header.body_offset_bytes >= header.points * header.point_bytes);
}

/// An array, or an archive of arrays.
inline void numpy(std::string_view bytes) {
  if (!bytes.starts_with("PK")) {
    const std::size_t numbers = parse_npy(bytes, "f").numbers.size();
    require(numbers <= bytes.size());
    return;
  }
  for (const ArchiveMember& member : unpack_npz(bytes, "f")) (void)parse_npy(member.bytes, "f");
}

/// The first byte chooses the format, the second is a number of points.
inline void predictions(std::string_view bytes) {
  if (bytes.size() < 2) return;
  const std::size_t point_count = static_cast<unsigned char>(bytes[1]);
  const std::string_view text = bytes.substr(2);
  switch (bytes.front()) {
    case 't':
      return require(parse_point_text(text, point_count, "f").size() == point_count);
    case 'c':
      return require(parse_point_csv(text, point_count, "f").size() == point_count);
    case 'd':
      for (const auto& cloud : parse_dynablox_clouds(text, DynabloxLevel::kObject, "f")) {
        require(!cloud.empty());
      }
      return;
    case 's':
      for (const DynabloxCounts& score : parse_dynablox_counts(text, DynabloxLevel::kPoint, "f")) {
        require(score.counts.points() == score.total_points);
      }
      return;
    default:
      for (const PublishedCell& cell : parse_published(text, "f")) (void)cell.iou();
  }
}

inline void ply(std::string_view bytes) {
  const PlySummary summary = parse_ply_summary(bytes, bytes.size(), "f");
  require(parse_ply(bytes, "f").size() == summary.points);
  if (!summary.has_times) return;
  const StoredTimes stored{parse_ply_times(bytes, "f"), std::nullopt};
  require(stored.times.size() == summary.points);
  const auto times_ns = PointClock(std::span(&stored, 1), 0.1).after_stamp_ns(stored);
  require(times_ns.empty() || times_ns.size() == summary.points);
}

/// The first byte is the number of points.
inline void moe_labels(std::string_view text) {
  if (text.empty()) return;
  const std::size_t point_count = static_cast<unsigned char>(text.front());
  require(parse_moe_labels(text.substr(1), point_count, "f").size() == point_count);
}

/// Poses in any of the formats.
inline void pose_list(std::string_view text) {
  const PoseList list = parse_pose_list(text, std::nullopt, "f");
  require(list.stamps_ns.empty() || list.stamps_ns.size() == list.poses.size());
  for (const Pose& pose : list.poses) require(pose.matrix().allFinite());
}

/// The first byte chooses the type.
inline void ros_message(std::string_view bytes) {
  if (bytes.empty()) return;
  const std::string_view message = bytes.substr(1);
  if (bytes.front() == 't') {
    for (const auto& transform : parse_transforms(message, {kTfMessage}, "f")) {
      require(transform.parent_from_child.matrix().allFinite());
    }
    return;
  }
  const TimedCloud cloud = parse_cloud(message, "f");
  require(cloud.times.empty() || cloud.times.size() == cloud.points.size());
  require(cloud.points.size() <= message.size());
}

/// Messages in CDR, of ROS 2; the first byte chooses the type.
inline void ros2_message(std::string_view bytes) {
  if (bytes.empty()) return;
  const std::string_view message = bytes.substr(1);
  const auto transforms_of = [&](std::string_view type) {
    for (const auto& transform : parse_transforms(message, {type, MessageEncoding::kCdr}, "f")) {
      require(transform.parent_from_child.matrix().allFinite());
    }
  };
  switch (bytes.front()) {
    case 't':
      return transforms_of(kTfMessage);
    case 's':
      return transforms_of(kTransformStamped);
    case 'o':
      return transforms_of(kOdometry);
    case 'p':
      return transforms_of(kPoseStamped);
    case 'w':
      return transforms_of(kPath);
    default:
      break;
  }
  const std::string_view type = bytes.front() == 'l' ? kLivoxMessages[0] : kPointCloud2;
  const TimedCloud cloud = parse_cloud(message, "f", {type, MessageEncoding::kCdr});
  require(cloud.times.empty() || cloud.times.size() == cloud.points.size());
  require(!cloud.labels || cloud.labels->size() == cloud.points.size());
  require(cloud.points.size() <= message.size());
}

inline void bag_metadata(std::string_view text) {
  const BagMetadata metadata = parse_bag_metadata(text, "f");
  require(!metadata.files.empty());
}

/// Calls `read` with a file of these bytes, which its errors must name.
template <typename Read>
void with_file(std::string_view bytes, Read&& read) {
  const MemoryFile file(bytes);
  try {
    read(file.path());
  } catch (const DataError& error) {
    const std::string message = error.what();
    require(message.starts_with(file.path().string()));
    throw DataError("f" + message);
  }
}

inline void read_bag(const std::filesystem::path& file) {
  const BagSequence recording("s", file, {});
  for (std::size_t i = 0; i < recording.size(); ++i) {
    require(recording.read(i).points.size() == recording.point_count(i));
  }
}

/// A whole bag with all its scans: of ROS 1 or in MCAP, as its first bytes say.
inline void bag(std::string_view bytes) { with_file(bytes, read_bag); }

/// The same as `with_file` for libraries that open nothing but files with a name.
template <typename Read>
void with_named_file(const char* name, std::string_view bytes, Read&& read) {
  const TempFolder folder;
  const auto file = folder.write(name, bytes);
  try {
    read(file);
  } catch (const DataError& error) {
    require(std::string_view(error.what()).starts_with(file.string()));
    throw DataError(std::string("f") + error.what());
  }
}

/// A bag in SQLite.
inline void sqlite_bag(std::string_view bytes) { with_named_file("s.db3", bytes, read_bag); }

/// A file of OpenSceneFlow with all its scans.
inline void hdf5(std::string_view bytes) {
  with_named_file("s.h5", bytes, [](const std::filesystem::path& file) {
    const auto opened = open_scene_flow_file("s", file, {});
    const Sequence& drive = *opened;
    for (std::size_t i = 0; i < drive.size(); ++i) {
      const Frame frame = drive.read(i);
      require(frame.points.size() == drive.point_count(i));
      require(frame.truth.has_value() == drive.has_truth(i));
      require(!frame.truth || frame.truth->size() == frame.points.size());
    }
  });
}

/// The first byte chooses the LiDAR, or poses.
inline void helipr(std::string_view bytes) {
  if (bytes.empty()) return;
  const std::string_view rest = bytes.substr(1);
  if (bytes.front() == 'p') {
    for (const HeliprPose& pose : parse_helipr_poses(rest, "f")) {
      require(pose.map_from_sensor.matrix().allFinite());
    }
    return;
  }
  const auto sensor = static_cast<HeliprSensor>(static_cast<unsigned char>(bytes.front()) % 4);
  const HeliprScan scan = parse_helipr_scan(rest, sensor, 0, "f");
  require(scan.points.size() * helipr_point_bytes(sensor, 0) == rest.size());
  require(scan.times_ns.size() == scan.points.size());
  if (sensor != HeliprSensor::kAeva) return;
  const std::string written = format_helipr_aeva(scan.points, scan.radial_velocity_m_s, 0);
  require(written.size() == rest.size());
  const HeliprScan again = parse_helipr_scan(written, sensor, 0, "f");
  require(format_helipr_aeva(again.points, again.radial_velocity_m_s, 0) == written);
}

inline void tracklets(std::string_view text) {
  const auto parsed = parse_tracklets(text, "f");
  const std::string written = format_tracklets(parsed);
  require(format_tracklets(parse_tracklets(written, "f")) == written);
}

inline void tracking_labels(std::string_view text) {
  const auto parsed = parse_tracking_labels(text, "f");
  const std::string written = format_tracking_labels(parsed);
  require(format_tracking_labels(parse_tracking_labels(written, "f")) == written);
}

inline void kitti_oxts(std::string_view text) {
  const auto parsed = parse_oxts(text, "f");
  require(format_oxts(parse_oxts(format_oxts(parsed), "f")) == format_oxts(parsed));
  require(poses_of_oxts(parsed).size() == parsed.size());
}

inline void kitti_stamps(std::string_view text) {
  const auto parsed = parse_kitti_stamps(text, "f");
  require(parse_kitti_stamps(format_kitti_stamps(parsed), "f") == parsed);
}

inline void kitti_calib(std::string_view text) {
  const KittiMounting parsed = parse_tracking_calib(text, "f");
  require(parsed.lidar_from_imu.matrix().allFinite() && parsed.view.width_px > 0.0);
  (void)parsed.view.sees({10.0, 0.0, 0.0});
}

/// Rows with the keys that any table of nuScenes has.
inline void nuscenes_table(std::string_view text) {
  std::istringstream bytes{std::string(text)};
  parse_nuscenes_table(bytes, "f", [](const NuscenesRow& row) {
    (void)row.text("token");
    (void)row.flag("is_key_frame");
    (void)row.integer("timestamp");
    (void)row.texts("attribute_tokens");
    for (const double number : row.numbers("translation", 3)) require(std::isfinite(number));
  });
}

inline void scene(std::string_view text) {
  const std::string formatted = format_scene(parse_scene(text, "f"));
  require(format_scene(parse_scene(formatted, "f")) == formatted);
}

inline void config(std::string_view text) {
  Settings parsed = methods().front().defaults;
  try {
    apply_settings_text(text, "f", parsed);
  } catch (const UsageError& error) {
    throw DataError(error.what());
  }
  Settings again = methods().front().defaults;
  apply_settings_text(to_json(parsed).dump(), "f", again);
  require(to_json(again) == to_json(parsed));
}

/// A result.json.
inline void result(std::string_view bytes) {
  with_file(bytes, [](const std::filesystem::path& file) {
    const std::string formatted = format_result(read_result(file));
    require(format_result(read_result(MemoryFile(formatted).path())) == formatted);
  });
}

inline void tracks(std::string_view text) {
  const std::string formatted = format_tracks(parse_tracks(text, "f"));
  require(format_tracks(parse_tracks(formatted, "f")) == formatted);
}

inline void decisions(std::string_view text) {
  const std::vector<Decision> parsed = parse_decisions(text, "f");
  // Bytes that are no UTF-8 are replaced when they are written.
  require(parse_decisions(format_decisions(parsed), "f").size() == parsed.size());
}

struct Parser {
  const char* name;  ///< of its corpus folder and its libFuzzer target
  void (*parse)(std::string_view);
  std::size_t mutations = 3000;  ///< that the replay tries; fewer where each takes a process
};
inline constexpr std::array<Parser, 33> kParsers = {{{"bin", bin},
                                                     {"nuscenes_table", nuscenes_table},
                                                     {"tracklets", tracklets},
                                                     {"tracking_labels", tracking_labels},
                                                     {"kitti_oxts", kitti_oxts},
                                                     {"kitti_stamps", kitti_stamps},
                                                     {"kitti_calib", kitti_calib},
                                                     {"helipr", helipr},
                                                     {"label", label},
                                                     {"dynamic_scores", dynamic_scores},
                                                     {"poses", poses},
                                                     {"calib", calib},
                                                     {"times", times},
                                                     {"indices", indices},
                                                     {"split", split},
                                                     {"pcd", pcd},
                                                     {"ply", ply},
                                                     {"numpy", numpy},
                                                     {"moe_labels", moe_labels},
                                                     {"pose_list", pose_list},
                                                     {"ros_message", ros_message},
                                                     {"ros2_message", ros2_message},
                                                     {"bag_metadata", bag_metadata},
                                                     {"bag", bag},
                                                     {"mcap", bag},
                                                     {"sqlite_bag", sqlite_bag},
                                                     {"hdf5", hdf5, 600},
                                                     {"scene", scene},
                                                     {"config", config},
                                                     {"tracks", tracks},
                                                     {"decisions", decisions},
                                                     {"result", result},
                                                     {"predictions", predictions}}};

/// Whether the parser gave a value; false when it threw DataError. Anything else escapes.
inline bool gives_value(void (*parse)(std::string_view), std::string_view bytes) {
  try {
    parse(bytes);
  } catch (const DataError& error) {
    require(std::string_view(error.what()).starts_with("f"));
    return false;
  }
  return true;
}

}  // namespace mosbench::fuzz
