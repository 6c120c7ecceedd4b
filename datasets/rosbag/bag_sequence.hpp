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
/// undistorted; their frames then have the pose at the first point's time. Scans that no transform
/// covers are left out and counted in the remarks. Truth is the field "label" of the points.
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
  /// When the last point of a scan is usually measured after the stamp; 0 where it is not known.
  std::int64_t usual_last_ns() const;
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
  bool undistorts_ = true;
  /// Points are moved later, by poses that are found later or by the velocity; their times are
  /// kept.
  bool keeps_times_ = false;
  /// Points are moved to where the sensor is at the stamp, not at the first point.
  bool has_stamped_points_ = false;
  /// The points' own times do not count.
  bool by_azimuth_ = false;
};

}  // namespace mosbench
