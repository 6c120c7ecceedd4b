#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
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

/// A box in the frame of the rectified camera 0: x right, y down, z ahead.
struct CameraBox {
  double height_m = 0.0, width_m = 0.0, length_m = 0.0;
  Eigen::Vector3d bottom_m = Eigen::Vector3d::Zero();  ///< centre of its lower side
  double rotation_y_rad = 0.0;                         ///< of the length against x
};

/// A line of label_02 of KITTI's tracking benchmark: an object in one frame.
struct TrackingLabel {
  std::size_t frame = 0;
  std::int64_t track = 0;  ///< -1 of regions
  std::string type;
  std::array<double, 4> region_px = {};  ///< left, top, right, bottom in the image of camera 2
  std::optional<CameraBox> box;          ///< nothing for DontCare
};

/// Parses label_02/NNNN.txt. Throws DataError with the line for another count of columns, for
/// sizes below 0, and for a track that is twice in one frame.
std::vector<TrackingLabel> parse_tracking_labels(std::string_view text,
                                                 const std::filesystem::path& file);
std::string format_tracking_labels(std::span<const TrackingLabel> labels);

}  // namespace mosbench
