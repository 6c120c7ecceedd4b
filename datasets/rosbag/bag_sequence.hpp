#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/formats/point_times.hpp"
#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/rosbag/ros_messages.hpp"
#include "datasets/rosbag/transform_tree.hpp"
#include "datasets/sequence/corrected_sequence.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Returns the one .bag in a folder; nothing without any. Throws DataError for several.
std::optional<std::filesystem::path> bag_of(const std::filesystem::path& folder);

/// The scans of one topic of a bag (`open_bag`). Poses are those of its tf tree (/tf, /tf_static),
/// else of `bag_transforms`, unless a file was asked for. Scans whose points have times are
/// undistorted to their stamps. Scans that no transform covers are left out and counted in the
/// doubts; those whose points the poses of a file do not cover stay as they were measured. Truth is
/// the field "label" of the points.
class BagSequence : public Sequence {
 public:
  /// `bag` is a file or the folder of a ROS 2 bag. Throws DataError if it is no bag, has no such
  /// topic, holds no scan in it, or lacks transforms from the scans' frame to the map's.
  BagSequence(std::string name, const std::filesystem::path& bag, const Reading& asked);
  BagSequence(std::string name, std::unique_ptr<const BagReader> bag, const Reading& asked);

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override;
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override;

 private:
  struct Scan {
    BagMessage message;
    std::size_t number = 0;  ///< in its topic, from 0
    std::int64_t stamp_ns = 0;
    std::size_t points = 0;
    bool timed = false;
    bool labelled = false;
    std::string frame;
  };

  void list_scans(const std::string& topic);
  void expect_one_frame(const std::string& topic) const;
  void open_transforms(const Reading& asked);
  void open_pose_file(const Reading& asked);
  /// When the first and last points of a scan are usually measured after the stamp; 0 where it is
  /// not known.
  std::pair<std::int64_t, std::int64_t> usual_times_ns() const;
  void doubt_about_raw_scans();
  bool has_poses(std::size_t scan_index, std::int64_t from_ns, std::int64_t to_ns) const;
  bool covered(const Scan& scan) const;
  void leave_out_uncovered(const std::string& clocks);
  void state_undistortion();
  void enter_scans();

  /// A scan with the times of its points after the stamp; points without one are not moved.
  struct MovingCloud : TimedCloud {
    std::vector<std::int64_t> times_ns;
  };
  void judge_times(const Reading& asked);
  TimedCloud stored_cloud(const Scan& scan, bool timed) const;
  MovingCloud cloud_of(const Scan& scan) const;
  PoseAt pose_at(std::size_t scan_index) const;

  std::unique_ptr<const BagReader> bag_;
  std::vector<Scan> scans_;
  PointClock clock_;
  std::optional<TransformChain> transforms_;  ///< of the bag
  ScanTracks tracks_;                         ///< of a pose file
  PoseAt pose_at_;                            ///< of the bag, or of a file with stamps
  std::size_t raw_scans_ = 0;                 ///< that poses of a file do not cover
  bool undistorts_ = true;
  /// Points are moved later, by poses that are found later or by the velocity; their times are
  /// kept.
  bool keeps_times_ = false;
  /// The points' own times do not count.
  bool by_azimuth_ = false;
};

}  // namespace mosbench
