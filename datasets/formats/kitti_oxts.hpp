#pragma once

#include <filesystem>
#include <mosbench/scan.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

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
