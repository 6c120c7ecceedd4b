#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <mosbench/scan.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// The lines "key: numbers" of a calibration file of KITTI's drives; the colon may be missing, as
/// in part of the lines of its tracking benchmark.
class KittiCalibLines {
 public:
  /// Throws DataError for a key that is there twice.
  KittiCalibLines(std::string_view text, std::filesystem::path file);

  /// Returns the numbers of a key. Throws DataError unless there are `count` finite ones.
  std::vector<double> numbers(const std::string& key, std::size_t count) const;
  /// Returns a rigid motion: the rotation of nine numbers that is nearest to the rounded one, and
  /// a translation of three. Throws DataError for what is no rotation.
  Pose motion(const std::string& rotation_key, const std::string& translation_key) const;
  /// The same for one key with 9 (a rotation) or 12 numbers (rows of 3x4).
  Pose motion(const std::string& key, std::size_t count) const;
  const std::filesystem::path& file() const { return file_; }

 private:
  Pose rigid(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation_m,
             const std::string& key) const;

  std::filesystem::path file_;
  std::map<std::string, std::string, std::less<>> lines_;
};

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

}  // namespace mosbench
