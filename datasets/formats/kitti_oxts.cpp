#include "datasets/formats/kitti_oxts.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

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
