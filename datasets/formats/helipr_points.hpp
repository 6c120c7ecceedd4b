#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// The LiDARs of HeLiPR, in the order of their folders.
enum class HeliprSensor : std::uint8_t { kAeva, kAvia, kOuster, kVelodyne };

std::string_view to_string(HeliprSensor sensor);
/// Returns nothing for what is no folder of HeLiPR's: "Aeva", "Avia", "Ouster", "Velodyne".
std::optional<HeliprSensor> helipr_sensor_from_string(std::string_view name);

struct HeliprScan {
  std::vector<Point> points;
  std::vector<std::int64_t> times_ns;      ///< of each point after the scan's stamp
  std::vector<float> radial_velocity_m_s;  ///< of each point of an Aeva, else none
};

/// Returns the bytes of a point: 29 of an Aeva (25 up to the stamp 1691936557946849179, as they
/// have no intensity), 19 of an Avia, 26 of an Ouster, 22 of a Velodyne
/// (HeLiPR-File-Player@e8d95e3: src/ROSThread.cpp).
std::size_t helipr_point_bytes(HeliprSensor sensor, std::int64_t stamp_ns);

/// Returns how many points a file of a size has. Throws DataError where it is no multiple.
std::size_t helipr_point_count(std::uintmax_t size_bytes, HeliprSensor sensor,
                               std::int64_t stamp_ns, const std::filesystem::path& file);

/// Returns the points of a file, packed one after the other. The intensity of an Avia, and of an
/// Aeva that has none, is its reflectivity. Throws DataError for a size that is no multiple of a
/// point's, and for times that are not within a second.
HeliprScan parse_helipr_scan(std::string_view bytes, HeliprSensor sensor, std::int64_t stamp_ns,
                             const std::filesystem::path& file);

/// Returns points as an Ouster stores them, all at the stamp.
std::string format_helipr_ouster(const std::vector<Point>& points);
/// Returns points as an Aeva stores them at that time, all at the stamp; the intensity is also the
/// reflectivity. As many velocities as points.
std::string format_helipr_aeva(const std::vector<Point>& points,
                               const std::vector<float>& radial_velocity_m_s,
                               std::int64_t stamp_ns);

/// The sensor's pose at a stamp.
struct HeliprPose {
  std::int64_t stamp_ns = 0;
  Pose map_from_sensor = Pose::Identity();
};

/// Parses rows of "stamp_ns x y z qx qy qz qw". Throws DataError naming the line.
std::vector<HeliprPose> parse_helipr_poses(std::string_view text,
                                           const std::filesystem::path& file);
std::string format_helipr_poses(const std::vector<HeliprPose>& poses);

}  // namespace mosbench
