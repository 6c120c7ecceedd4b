#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "eval/result/result_scans.hpp"

namespace mosbench {

/// What lies around a false or missed point: the first that fits, in this order.
enum class ErrorScene : std::uint8_t {
  kNone,        ///< the point is neither false nor missed
  kNearMoving,  ///< a false point within 0.5 m of what moves in truth
  kFirstSight,  ///< its place was hidden a second before
  kPose,        ///< the poses put surfaces of this scan and of a second before apart
  kGround,      ///< at most 0.3 m above the lowest points around
  kParked,      ///< on a static thing of a vehicle's size that stands alone
  kVegetation,  ///< the static points around scatter in all directions
  kEdge,        ///< before or behind a jump of range, or on what is as thin as the beams are apart
  kElse
};
/// By ErrorScene.
inline constexpr std::array kErrorSceneNames = {"right",      "near moving", "first sight",
                                                "poses",      "ground",      "parked",
                                                "vegetation", "edge",        "else"};

/// Returns what lies around each false and missed point of a scan. `earlier` is the scan of a
/// second before; without it nothing was seen then. `classes` are raw labels of SemanticKITTI, one
/// per point, or none: those of ground, vehicles, plants and poles win over the shape.
std::vector<ErrorScene> error_scenes(const JudgedScan& scan, const Frame* earlier,
                                     std::span<const std::uint32_t> classes = {});

/// The same of a scan of a result, with the classes of its labels where they are SemanticKITTI's.
/// `times_s` are those of all scans. Throws DataError.
std::vector<ErrorScene> error_scenes(const ResultScans& scans, std::size_t scan_index,
                                     const JudgedScan& scan, std::span<const double> times_s);

/// Returns the times of all scans, in seconds.
std::vector<double> times_of_all(const Sequence& sequence);

}  // namespace mosbench
