#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Writes the frames of one sequence in some layout.
class SequenceWriter {
 public:
  virtual ~SequenceWriter() = default;
  /// Writes one scan; every index is written once. Files of single scans may be written in any
  /// order and by several threads, messages of a bag only in order.
  virtual void write(std::size_t scan_index, const Frame& frame) = 0;
  /// Writes what has to wait for the last frame, poses last; before, the folder cannot be opened.
  virtual void finish() = 0;
};

/// The kinds of bags that are written.
enum class BagKind : std::uint8_t { kNone, kRos1, kMcap, kDb3 };
std::string_view to_string(BagKind kind);

struct WriteOptions {
  std::size_t scans = 0;
  /// Tr of calib.txt in layouts that have it: the poses of the frames are those of the camera.
  Pose camera_from_lidar = Pose::Identity();
  /// Of DOALS a ROS 1 bag instead of files; of a recording one of ROS 2.
  BagKind bag = BagKind::kNone;
  /// Of the bag's chunks: none, lz4, of ROS 1 bz2 and of MCAP zstd; of kDb3's messages none, zstd.
  std::string compression = "lz4";
  bool radial_velocities = false;  ///< whether all frames have them
  std::string mark = {};           ///< see `format_mark`; bags and .h5 keep it inside
};

/// Returns whether a label is one of what moves, 251 to 259.
bool is_moving(std::uint32_t label);

/// Returns the stamp of a scan; of one without, as many tenths of a second as its index says, which
/// lie as far apart as those of most sensors.
std::int64_t stamp_or_period_ns(std::size_t scan_index, std::optional<std::int64_t> stamp_ns);

/// Numbers of scans by the name of their split.
using SplitNumbers = std::map<std::string, std::set<std::uint64_t>>;

/// Returns the name of the file that appears when all of a sequence is on the disk.
const char* last_file_of(const WriteOptions& options);

/// Writes `file`, an .h5 file of OpenSceneFlow: a group per frame by its stamp with lidar, pose and
/// ground_mask. Frames with motions get flow, flow_is_valid where they have truth,
/// flow_category_indices and flow_instance_id, the last one none; other truth becomes mos_label.
/// Frames may come in any order and from several threads. Frames without stamps get ones 0.1 s
/// apart. Throws DataError also for stamps that do not increase.
std::unique_ptr<SequenceWriter> write_as_scene_flow(const std::filesystem::path& file,
                                                    const WriteOptions& options);

/// Writes velodyne/, labels/ for frames with truth, times.txt when all frames have stamps,
/// calib.txt and poses.txt.
std::unique_ptr<SequenceWriter> write_as_kitti(const std::filesystem::path& folder,
                                               const WriteOptions& options);

/// Returns the files that the writer of the same layout may write of a sequence.
std::vector<std::filesystem::path> files_of_kitti(const Sequence& sequence);
std::vector<std::filesystem::path> files_of_doals(const Sequence& sequence);
std::vector<std::filesystem::path> files_of_ros2_bag(const Sequence& sequence);

/// Writes velodyne/, times.txt and poses.txt, or bag.bag with /os1_cloud_node/points and /tf from
/// map to os1_lidar; and indices.csv with the points of an id of 251 to 259. Frames without stamps
/// get ones 0.1 s apart. Throws as BagWriter.
std::unique_ptr<SequenceWriter> write_as_doals(const std::filesystem::path& folder,
                                               const WriteOptions& options);

/// Writes a ROS 2 bag: metadata.yaml and bag_0.mcap or bag_0.db3 with the topics /points, whose
/// points have x y z intensity, and a field label for frames with truth, and /tf from map to lidar.
/// Frames without stamps get ones 0.1 s apart. Throws UsageError without `options.bag`, else as
/// Ros2BagWriter.
std::unique_ptr<SequenceWriter> write_as_ros2_bag(const std::filesystem::path& folder,
                                                  const WriteOptions& options);

/// The file of the poses, which is written last.
inline constexpr const char* kNuscenesLastFile = "v1.0-mini/ego_pose.json";

/// Returns the files that `write_as_nuscenes` may write of a sequence.
std::vector<std::filesystem::path> files_of_nuscenes(const Sequence& sequence);

/// Writes one scene, called as the folder, with tables of its own in v1.0-mini/: those that
/// `read_nuscenes_tables` reads. Scans with truth are key frames. Each moving point is an
/// annotation of 0.02 mm, so that the truth is read back as it is; points of other ids are static
/// then. Stamps are rounded down to microseconds.
std::unique_ptr<SequenceWriter> write_as_nuscenes(const std::filesystem::path& folder,
                                                  const WriteOptions& options);

/// The files that are written last, from the folder of a sequence.
inline constexpr const char* kKittiRawLastFile = "oxts/timestamps.txt";
inline constexpr const char* kKittiTrackingLastFile = "training/oxts/0000.txt";

/// Returns the files that the writers may write of a sequence.
std::vector<std::filesystem::path> files_of_kitti_raw(const Sequence& sequence);
std::vector<std::filesystem::path> files_of_kitti_tracking(const Sequence& sequence);

/// Writes a drive of KITTI's raw data, the calibration beside its folder. Scans are called by their
/// numbers; frames without stamps get ones 0.1 s apart. Points in the view of camera 2 keep whether
/// they are labelled and whether they move, and moving ones their instance: these lie in boxes that
/// are 1000 km lower in the next frame and whose type says the instance, unlabelled ones, as all of
/// a scan without truth, in boxes that are seen once; where no scan has truth no tracklets are
/// written. oxts go on for one frame after the last. Throws DataError for stamps that do not
/// increase or are not within 1970 to 2261, and for poses and moving points that are farther away
/// than the files can say.
std::unique_ptr<SequenceWriter> write_as_kitti_raw(const std::filesystem::path& folder,
                                                   const WriteOptions& options);

/// The same as sequence 0000 of the tracking benchmark, which has no stamps.
std::unique_ptr<SequenceWriter> write_as_kitti_tracking(const std::filesystem::path& folder,
                                                        const WriteOptions& options);

}  // namespace mosbench
