#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// Where a labelled object is in one frame.
struct TrackletPose {
  Eigen::Vector3d bottom_m = Eigen::Vector3d::Zero();  ///< centre of its lower side, LiDAR frame
  double yaw_rad = 0.0;                                ///< about z
};

/// One object of KITTI's raw data, a box that keeps its size.
struct Tracklet {
  std::string type;
  double height_m = 0.0, width_m = 0.0, length_m = 0.0;
  std::size_t first_frame = 0;
  std::vector<TrackletPose> poses;  ///< of the first frame and those that follow it
};

/// Parses tracklet_labels.xml. Throws DataError with the line for what is no XML, entities, more
/// than 16 elements within each other, missing numbers and counts that do not fit, sizes below 0,
/// and rotations about x or y, which KITTI does not have.
std::vector<Tracklet> parse_tracklets(std::string_view text, const std::filesystem::path& file);
std::string format_tracklets(std::span<const Tracklet> tracklets);

}  // namespace mosbench
