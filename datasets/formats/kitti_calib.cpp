#include "datasets/formats/kitti_calib.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "datasets/disk/files.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

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

/// The lines "key: numbers" of a calibration file of KITTI's drives; the colon may be missing, as
/// in part of the lines of its tracking benchmark.
class KittiCalibLines {
 public:
  /// Throws DataError for a key that is there twice.
  KittiCalibLines(std::string_view text, fs::path file) : file_(std::move(file)) {
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

  /// Returns the numbers of a key. Throws DataError unless there are `count` finite ones.
  std::vector<double> numbers(const std::string& key, std::size_t count) const {
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

  /// Returns a rigid motion: the rotation of nine numbers that is nearest to the rounded one, and
  /// a translation of three. Throws DataError for what is no rotation.
  Pose motion(const std::string& rotation_key, const std::string& translation_key) const {
    const std::vector<double> rotation = numbers(rotation_key, 9), t = numbers(translation_key, 3);
    return rigid(Eigen::Map<const RowMajor3>(rotation.data()), {t[0], t[1], t[2]}, rotation_key);
  }

  /// The same for one key with 9 (a rotation) or 12 numbers (rows of 3x4).
  Pose motion(const std::string& key, std::size_t count) const {
    const std::vector<double> values = numbers(key, count);
    if (count == 9) {
      return rigid(Eigen::Map<const RowMajor3>(values.data()), Eigen::Vector3d::Zero(), key);
    }
    const RowMajor34 rows = Eigen::Map<const RowMajor34>(values.data());
    return rigid(rows.leftCols<3>(), rows.col(3), key);
  }

  const std::filesystem::path& file() const { return file_; }

 private:
  Pose rigid(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation_m,
             const std::string& key) const {
    if (!is_rotation(rotation)) {
      throw DataError(file_, key + " is no rotation", "rows of length 1 at right angles");
    }
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
    pose.translation() = translation_m;
    return pose;
  }

  std::filesystem::path file_;
  std::map<std::string, std::string, std::less<>> lines_;
};

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

constexpr std::size_t kPacketNumbers = 30, kKeptNumbers = 6;
constexpr double kEarthRadius_m = 6378137.0, kRadPerDeg = std::numbers::pi / 180.0;

OxtsPacket parse_packet(const TextLine& line, const std::filesystem::path& file) {
  const auto texts = split_at_blanks(line.text);
  if (texts.size() != kPacketNumbers) {
    throw DataError(file, line.number, fmt::format("has {} numbers", texts.size()),
                    "the 30 of a packet of KITTI's GPS/IMU");
  }
  const std::vector<double> numbers = parse_numbers(texts, [&](std::string_view text) {
    throw DataError(file, line.number, quoted(text) + " is no number", "a number");
  });
  const OxtsPacket packet = {numbers[0], numbers[1], numbers[2],
                             numbers[3], numbers[4], numbers[5]};
  if (!is_on_map(packet)) {
    throw DataError(file, line.number, "is no place that Mercator's projection shows",
                    "a latitude within 89 degrees and a longitude within 360");
  }
  return packet;
}

double scale_of(const OxtsPacket& first) { return std::cos(first.latitude_deg * kRadPerDeg); }

/// The development kit has log(tan((90 + latitude) / 2)), which is the same and rounds more.
Eigen::Vector3d mercator_m(const OxtsPacket& packet, double scale) {
  const double reach_m = scale * kEarthRadius_m;
  return {reach_m * packet.longitude_deg * kRadPerDeg,
          reach_m * std::asinh(std::tan(packet.latitude_deg * kRadPerDeg)), packet.altitude_m};
}

/// Rz(yaw) Ry(pitch) Rx(roll).
Eigen::Matrix3d attitude_of(const OxtsPacket& packet) {
  return (Eigen::AngleAxisd(packet.yaw_rad, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(packet.pitch_rad, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(packet.roll_rad, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

void set_attitude(const Eigen::Matrix3d& r, OxtsPacket& packet) {
  packet.yaw_rad = std::atan2(r(1, 0), r(0, 0));
  packet.pitch_rad = std::atan2(-r(2, 0), std::hypot(r(2, 1), r(2, 2)));
  // Not by the last row alone, which holds no roll where x points straight up or down.
  const double sin = std::sin(packet.yaw_rad), cos = std::cos(packet.yaw_rad);
  packet.roll_rad = std::atan2(sin * r(0, 2) - cos * r(1, 2), cos * r(1, 1) - sin * r(0, 1));
}

}  // namespace

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

bool is_on_map(const OxtsPacket& packet) {
  const bool is_finite = std::isfinite(packet.altitude_m) && std::isfinite(packet.roll_rad) &&
                         std::isfinite(packet.pitch_rad) && std::isfinite(packet.yaw_rad);
  return is_finite && std::abs(packet.latitude_deg) <= 89.0 &&
         std::abs(packet.longitude_deg) <= 360.0;
}

std::vector<OxtsPacket> parse_oxts(std::string_view text, const std::filesystem::path& file) {
  std::vector<OxtsPacket> packets;
  for (const TextLine& line : split_lines(text, file)) packets.push_back(parse_packet(line, file));
  return packets;
}

std::string format_oxts(std::span<const OxtsPacket> packets) {
  std::string text;
  for (const OxtsPacket& p : packets) {
    text += fmt::format("{} {} {} {} {} {}", p.latitude_deg, p.longitude_deg, p.altitude_m,
                        p.roll_rad, p.pitch_rad, p.yaw_rad);
    for (std::size_t i = kKeptNumbers; i < kPacketNumbers; ++i) text += " 0";
    text += '\n';
  }
  return text;
}

std::vector<Pose> poses_of_oxts(std::span<const OxtsPacket> packets) {
  std::vector<Pose> poses;
  if (packets.empty()) return poses;
  const double scale = scale_of(packets.front());
  const Eigen::Vector3d origin_m = mercator_m(packets.front(), scale);
  const Eigen::Matrix3d map_from_earth = attitude_of(packets.front()).transpose();
  for (const OxtsPacket& packet : packets) {
    Pose& pose = poses.emplace_back(Pose::Identity());
    pose.linear() = map_from_earth * attitude_of(packet);
    pose.translation() = map_from_earth * (mercator_m(packet, scale) - origin_m);
  }
  return poses;
}

std::vector<OxtsPacket> oxts_of_poses(std::span<const Pose> map_from_imu) {
  std::vector<OxtsPacket> packets;
  for (const Pose& pose : map_from_imu) {
    const Eigen::Vector3d place_m = pose.translation() - map_from_imu.front().translation();
    OxtsPacket& packet = packets.emplace_back();
    packet.longitude_deg = place_m.x() / kEarthRadius_m / kRadPerDeg;
    packet.latitude_deg = std::atan(std::sinh(place_m.y() / kEarthRadius_m)) / kRadPerDeg;
    packet.altitude_m = place_m.z();
    set_attitude(pose.linear(), packet);
  }
  return packets;
}

}  // namespace mosbench
