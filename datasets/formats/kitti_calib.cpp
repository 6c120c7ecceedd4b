#include "datasets/formats/kitti_calib.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "datasets/disk/files.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using RowMajor34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

/// S_rect_02 of calib_cam_to_cam.txt by the focal length in P_rect_02, of KITTI's five days.
struct RecordingDay {
  double focal_px, width_px, height_px;
};
constexpr std::array<RecordingDay, 5> kRecordingDays = {{{721.5377, 1242, 375},
                                                         {707.0493, 1224, 370},
                                                         {718.3351, 1238, 374},
                                                         {707.0912, 1226, 370},
                                                         {718.8560, 1241, 376}}};

CameraView view_of(const Pose& rectified_from_lidar, const std::vector<double>& projection,
                   const std::string& key, const fs::path& file) {
  CameraView view;
  view.rectified_from_lidar = rectified_from_lidar;
  view.pixel_from_rectified = Eigen::Map<const RowMajor34>(projection.data());
  if (!(view.pixel_from_rectified(0, 0) > 0.0 && view.pixel_from_rectified(2, 2) > 0.0)) {
    throw DataError(file, key + " is no projection of a camera", "a focal length above 0");
  }
  return view;
}

std::string calib_row(const std::string& key, const auto& matrix) {
  using Scalars = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Scalars rows = matrix;
  return fmt::format("{} {}\n", key, fmt::join(rows.data(), rows.data() + rows.size(), " "));
}

}  // namespace

KittiCalibLines::KittiCalibLines(std::string_view text, fs::path file) : file_(std::move(file)) {
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = take_line(text);
    if (line.empty()) continue;
    const auto key_end = std::min(line.find_first_of(": \t"), line.size());
    const std::string key(line.substr(0, key_end));
    const auto rest = line.substr(std::min(key_end + 1, line.size()));
    if (lines_.emplace(key, rest).second) continue;
    throw DataError(file_, number, "a second line " + mosbench::quoted(key), "one");
  }
}

std::vector<double> KittiCalibLines::numbers(const std::string& key, std::size_t count) const {
  const std::string expected = fmt::format("\"{}\" and {} numbers", key, count);
  const auto line = lines_.find(key);
  if (line == lines_.end()) throw DataError(file_, "has no line \"" + key + "\"", expected);
  const auto words = split_at_blanks(line->second);
  std::vector<double> numbers = parse_numbers(words, [&](std::string_view text) {
    throw DataError(file_, key + ": " + quoted(text) + " is no number", expected);
  });
  if (numbers.size() != count) {
    throw DataError(file_, fmt::format("{}: has {} numbers", key, numbers.size()), expected);
  }
  return numbers;
}

Pose KittiCalibLines::rigid(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation_m,
                            const std::string& key) const {
  if (!is_rotation(rotation)) {
    throw DataError(file_, key + " is no rotation", "rows of length 1 at right angles");
  }
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
  pose.translation() = translation_m;
  return pose;
}

Pose KittiCalibLines::motion(const std::string& rotation_key,
                             const std::string& translation_key) const {
  const std::vector<double> rotation = numbers(rotation_key, 9), t = numbers(translation_key, 3);
  return rigid(Eigen::Map<const RowMajor3>(rotation.data()), {t[0], t[1], t[2]}, rotation_key);
}

Pose KittiCalibLines::motion(const std::string& key, std::size_t count) const {
  const std::vector<double> values = numbers(key, count);
  if (count == 9) {
    return rigid(Eigen::Map<const RowMajor3>(values.data()), Eigen::Vector3d::Zero(), key);
  }
  const RowMajor34 rows = Eigen::Map<const RowMajor34>(values.data());
  return rigid(rows.leftCols<3>(), rows.col(3), key);
}

Eigen::Vector3d CameraView::project(const Eigen::Vector3d& lidar_m) const {
  return pixel_from_rectified * (rectified_from_lidar * lidar_m).homogeneous();
}

bool CameraView::sees(const Eigen::Vector3d& lidar_m) const {
  const Eigen::Vector3d at = project(lidar_m);
  return at.z() > 0.0 && at.x() >= 0.0 && at.y() >= 0.0 && at.x() < width_px * at.z() &&
         at.y() < height_px * at.z();
}

KittiMounting read_kitti_mounting(const fs::path& date_folder) {
  const auto lines_of = [&](const char* name) {
    const fs::path file = date_folder / name;
    if (!is_there(file)) {
      throw DataError(file, "is not there", "the calibration of the date beside its drives");
    }
    return KittiCalibLines(read_file(file), file);
  };
  const KittiCalibLines cameras = lines_of("calib_cam_to_cam.txt");
  KittiMounting mounting;
  mounting.lidar_from_imu = lines_of("calib_imu_to_velo.txt").motion("R", "T");
  mounting.view =
      view_of(cameras.motion("R_rect_00", 9) * lines_of("calib_velo_to_cam.txt").motion("R", "T"),
              cameras.numbers("P_rect_02", 12), "P_rect_02", cameras.file());
  const std::vector<double> size_px = cameras.numbers("S_rect_02", 2);
  mounting.view.width_px = size_px[0];
  mounting.view.height_px = size_px[1];
  if (!(size_px[0] >= 1.0 && size_px[1] >= 1.0)) {
    throw DataError(cameras.file(), "S_rect_02 is no size", "pixels of width and height");
  }
  return mounting;
}

KittiMounting parse_tracking_calib(std::string_view text, const fs::path& file) {
  constexpr double kRounding_px = 1e-3;
  const KittiCalibLines lines(text, file);
  KittiMounting mounting;
  mounting.lidar_from_imu = lines.motion("Tr_imu_velo", 12);
  mounting.view = view_of(lines.motion("R_rect", 9) * lines.motion("Tr_velo_cam", 12),
                          lines.numbers("P2", 12), "P2", file);
  const double focal_px = mounting.view.pixel_from_rectified(0, 0);
  const auto day = std::ranges::find_if(kRecordingDays, [&](const RecordingDay& known) {
    return std::abs(known.focal_px - focal_px) < kRounding_px;
  });
  if (day == kRecordingDays.end()) {
    throw DataError(file, fmt::format("P2 has a focal length of {} pixels", focal_px),
                    "that of one of KITTI's days, which tells the size of the image");
  }
  mounting.view.width_px = day->width_px;
  mounting.view.height_px = day->height_px;
  return mounting;
}

KittiMounting written_kitti_mounting() {
  KittiMounting mounting;
  mounting.lidar_from_imu.translation() << -0.81, 0.32, -0.8;
  CameraView& view = mounting.view;
  // Camera x is lidar -y, camera y lidar -z, camera z lidar x.
  view.rectified_from_lidar.linear() << 0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0;
  view.rectified_from_lidar.translation() << 0.0, -0.08, -0.27;
  const RecordingDay& day = kRecordingDays.front();
  view.width_px = day.width_px;
  view.height_px = day.height_px;
  view.pixel_from_rectified << day.focal_px, 0.0, 609.5, 0.06 * day.focal_px, 0.0, day.focal_px,
      172.9, 0.0, 0.0, 0.0, 1.0, 0.0;
  return mounting;
}

KittiCalibTexts format_kitti_mounting(const KittiMounting& mounting) {
  const auto motion = [](const Pose& pose) {
    return "calib_time: 01-Jan-1970 00:00:00\n" + calib_row("R:", pose.linear()) +
           calib_row("T:", pose.translation());
  };
  const CameraView& view = mounting.view;
  return {motion(mounting.lidar_from_imu), motion(view.rectified_from_lidar),
          "calib_time: 01-Jan-1970 00:00:00\n" +
              fmt::format("S_rect_02: {} {}\n", view.width_px, view.height_px) +
              calib_row("R_rect_00:", Eigen::Matrix3d::Identity()) +
              calib_row("P_rect_02:", view.pixel_from_rectified)};
}

std::string format_tracking_calib(const KittiMounting& mounting) {
  const auto motion = [](const std::string& key, const Pose& pose) {
    return calib_row(key, pose.matrix().topRows<3>());
  };
  const CameraView& view = mounting.view;
  std::string text;
  for (const char* camera : {"P0:", "P1:", "P2:", "P3:"}) {
    text += calib_row(camera, view.pixel_from_rectified);
  }
  return text + calib_row("R_rect", Eigen::Matrix3d::Identity()) +
         motion("Tr_velo_cam", view.rectified_from_lidar) +
         motion("Tr_imu_velo", mounting.lidar_from_imu);
}

}  // namespace mosbench
