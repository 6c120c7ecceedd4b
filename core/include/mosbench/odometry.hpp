#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mosbench/scan.hpp>
#include <mosbench/settings.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mosbench {

/// When a scan was measured, as far as that is known.
struct ScanTimes {
  std::optional<std::int64_t> stamp_ns;  ///< when the scan began
  /// When each point was measured after the stamp; one per point or none.
  std::span<const std::int64_t> point_times_ns = {};
};

/// The pose of one scan and how far it can be trusted. No number is ever NaN or infinite.
struct ScanPose {
  Pose map_from_sensor = Pose::Identity();  ///< the map's frame is that of the first scan
  /// Of a small rotation (rad, rows 0 to 2) and a translation (m) of the pose in the map's frame,
  /// from how far the scan's surfaces scatter about those of the map.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  /// How much the surfaces of the scan constrain the least constrained motion: 0 for the shift
  /// along a corridor without ends or the turn in a round room, up to 1/3 when surfaces face all
  /// ways.
  double geometry = 0;
  double condition =
      0;  ///< of the covariance's inverse: largest by smallest eigenvalue, at most 1e9
  double overlap =
      0;  ///< share of the points that lie where the map has points; 0 in the first scan
  std::size_t registered_points = 0;  ///< points after thinning
  std::string doubt;                  ///< why the pose is not to be trusted; empty when it is

  /// Says whether there is a doubt.
  bool doubtful() const { return !doubt.empty(); }
};

/// Finds the pose of every scan from the scans alone. Scans are pushed in order; poses are the same
/// bits for any number of threads. Whatever is pushed, a pose comes back: where registration is not
/// possible that of constant velocity, marked as doubtful.
class Odometry {
 public:
  virtual ~Odometry() = default;

  /// `points` are in the sensor's frame, in metres; NaN and points out of range are left out.
  /// Throws std::invalid_argument when there are point times but not one per point.
  virtual ScanPose push(std::span<const Point> points, const ScanTimes& times = {}) = 0;

  /// Keeps points of the last pushed scan, those that are not 0 here, out of the map, as they move.
  /// To be called before the next scan is pushed. Throws std::invalid_argument unless there is one
  /// number per point of that scan.
  virtual void leave_out(std::span<const std::uint8_t> moving) = 0;

  /// Returns how many points the map holds; those of the last scan enter it with the next push.
  virtual std::size_t map_points() const = 0;
  /// Returns the bytes of its containers.
  virtual std::size_t memory_bytes() const = 0;
};

/// One kind of odometry that can be run by name.
struct OdometryKind {
  std::string_view name;     ///< "simple"
  std::string_view title;    ///< "SiMpLE"
  std::string_view source;   ///< the paper
  std::string_view summary;  ///< one line
  Settings defaults;         ///< as published
  /// Throws std::invalid_argument "<setting>: <what is wrong>, <what was expected>".
  void (*check)(const Settings& settings);
  /// Checks, then makes. Also throws std::invalid_argument for 0 threads.
  std::unique_ptr<Odometry> (*make)(const Settings& settings, unsigned threads);
};

/// All kinds, the default one first.
std::span<const OdometryKind> odometries();
/// Returns nullptr when there is no kind of this name.
const OdometryKind* find_odometry(std::string_view name);

/// Settings that authors published for a sensor or data set.
struct OdometryPreset {
  std::string_view name;                                            ///< "kitti-online"
  std::string_view odometry;                                        ///< the kind's name
  std::vector<std::pair<std::string_view, SettingValue>> settings;  ///< over the defaults
};

/// Returns all presets of all kinds.
std::span<const OdometryPreset> odometry_presets();

}  // namespace mosbench
