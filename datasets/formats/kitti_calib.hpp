#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// What a camera sees of LiDAR points.
struct CameraView {
  Pose rectified_from_lidar = Pose::Identity();  ///< R_rect_00 Tr_velo_to_cam
  Eigen::Matrix<double, 3, 4> pixel_from_rectified = Eigen::Matrix<double, 3, 4>::Zero();
  double width_px = 0.0, height_px = 0.0;

  /// Returns the point's place in the image, times its depth, and the depth.
  Eigen::Vector3d project(const Eigen::Vector3d& lidar_m) const;
  /// Whether a point is in front of the camera and in its image.
  bool sees(const Eigen::Vector3d& lidar_m) const;
};

/// How the sensors of a drive are mounted.
struct KittiMounting {
  Pose lidar_from_imu = Pose::Identity();
  CameraView view;  ///< of camera 2, the left one in colour
};

/// Reads calib_imu_to_velo.txt, calib_velo_to_cam.txt and calib_cam_to_cam.txt of a date. Throws
/// DataError.
KittiMounting read_kitti_mounting(const std::filesystem::path& date_folder);

/// Parses calib/NNNN.txt of the tracking benchmark, which does not give the size of the image: that
/// follows from the focal length, which tells the day of KITTI's recordings. Throws DataError, also
/// for another focal length.
KittiMounting parse_tracking_calib(std::string_view text, const std::filesystem::path& file);

/// The mounting that is written: KITTI's of 2011-09-26 in round numbers.
KittiMounting written_kitti_mounting();
struct KittiCalibTexts {
  std::string imu_to_velo, velo_to_cam, cam_to_cam;
};
KittiCalibTexts format_kitti_mounting(const KittiMounting& mounting);
std::string format_tracking_calib(const KittiMounting& mounting);

/// Place and attitude of KITTI's GPS/IMU, the first six of the 30 numbers of a packet.
struct OxtsPacket {
  double latitude_deg = 0.0, longitude_deg = 0.0, altitude_m = 0.0;
  double roll_rad = 0.0, pitch_rad = 0.0, yaw_rad = 0.0;
};

/// Whether all six are numbers and Mercator's projection shows the place: a latitude within 89
/// degrees and a longitude within 360.
bool is_on_map(const OxtsPacket& packet);

/// Parses packets of 30 numbers per line. Throws DataError with the line, also for a latitude
/// beyond 89 degrees, where the projection ends.
std::vector<OxtsPacket> parse_oxts(std::string_view text, const std::filesystem::path& file);
/// Formats the packets, with zeros for the numbers that are not kept.
std::string format_oxts(std::span<const OxtsPacket> packets);

/// Returns map_from_imu of every packet as the development kit of KITTI's raw data computes it: a
/// Mercator projection with the scale of the first latitude, seen from the first packet.
std::vector<Pose> poses_of_oxts(std::span<const OxtsPacket> packets);

/// Returns packets whose poses are these, seen from the first, but for rounding. They begin at 0
/// degrees north and east, where that is least. Far away they are not on the map, see above.
std::vector<OxtsPacket> oxts_of_poses(std::span<const Pose> map_from_imu);

}  // namespace mosbench
