#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/rosbag/bag_file.hpp"
#include "datasets/sequence/pose_track.hpp"
#include "datasets/sequence/scan_source.hpp"
#include "datasets/sequence/undistort.hpp"

namespace mosbench {

/// The one .bag in a folder; nothing without any. Throws DataError for several.
std::optional<std::filesystem::path> bag_of(const std::filesystem::path& folder);

/// The scans of one topic of a ROS 1 bag. Poses are those of its tf tree (/tf, /tf_static), else of
/// its TransformStamped topics, unless `options.poses` names a file. Scans whose points have times
/// are undistorted. Scans that no transform covers are left out and counted in the remarks.
class BagRecording : public ScanSource {
 public:
  /// Throws DataError for what is no bag, has no such topic or no scan in it, or no way from the
  /// scans' frame to the map's.
  BagRecording(const std::filesystem::path& bag, const ReadingOptions& options);

  std::size_t size() const override { return scans_.size(); }
  std::string stem(std::size_t scan_index) const override;
  std::filesystem::path file(std::size_t) const override { return bag_.path(); }
  bool has_own_files() const override { return false; }
  std::size_t point_count(std::size_t scan_index) const override {
    return scans_.at(scan_index).points;
  }
  const std::vector<std::int64_t>& stamps_ns() const override { return stamps_ns_; }
  /// At the scan's stamp; `read` gives it at the first point's time.
  Pose map_from_sensor(std::size_t scan_index) const override {
    return *pose_at_(stamps_ns_.at(scan_index));
  }
  std::vector<std::filesystem::path> files() const override { return files_; }
  std::vector<std::string> remarks() const override { return remarks_; }
  ReadingStatement reading() const override { return reading_; }

 private:
  Frame read_frame(std::size_t scan_index, Frame spent) const override;
  struct Scan {
    BagMessage message;
    std::size_t number = 0;  ///< in its topic, from 0
    std::int64_t stamp_ns = 0;
    std::size_t points = 0;
    bool timed = false;
    std::string frame;
  };

  void list_scans(const std::string& topic);
  void open_poses(const ReadingOptions& options);
  void open_transforms(const ReadingOptions& options);
  void open_pose_file(const ReadingOptions& options);
  bool covered(const Scan& scan) const;
  void leave_out_uncovered();
  void state_undistortion();

  BagFile bag_;
  std::vector<Scan> scans_;
  std::vector<std::int64_t> stamps_ns_;
  PoseAt pose_at_;
  /// With a pose file the last scan stays as it is: nothing follows its pose.
  bool leaves_last_ = false;
  bool undistorts_ = true;
  std::vector<std::filesystem::path> files_;
  std::vector<std::string> remarks_;
  ReadingStatement reading_;
};

}  // namespace mosbench
