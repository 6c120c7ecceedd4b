#pragma once

#include <array>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>
#include <vector>

#include "eval/protocols/protocol.hpp"

namespace mosbench {

/// Points of one or more scans, counted for the class "moving". Every point is in exactly one of
/// tp, fp, fn, tn and ignored.
struct Confusion {
  std::uint64_t tp = 0;
  std::uint64_t fp = 0;
  std::uint64_t fn = 0;
  std::uint64_t tn = 0;
  std::uint64_t ignored = 0;
  /// Points whose truth or predicted id the protocol does not know; counted above as well, by the
  /// class the protocol gives to unknown ids.
  std::uint64_t unknown_ids = 0;

  std::uint64_t points() const { return tp + fp + fn + tn + ignored; }
  Confusion& operator+=(const Confusion& other);
  bool operator==(const Confusion&) const = default;
};

/// How one point is counted.
enum class PointOutcome : std::uint8_t {
  kTruePositive,
  kFalsePositive,
  kFalseNegative,
  kTrueNegative,
  kIgnoredStatic,  ///< not counted; predicted static
  kIgnoredMoving   ///< not counted; predicted moving
};

/// Whether the labels call a point of this outcome moving.
bool is_labelled_moving(PointOutcome outcome);

/// Points per PointOutcome.
using OutcomeCounts = std::array<std::uint64_t, 6>;

/// Adds up the two kinds of ignored points; unknown_ids stays 0.
Confusion to_confusion(const OutcomeCounts& counts);

/// Counts the points of one scan by the protocol's rules. `truth` and `prediction` are raw labels,
/// one per point. `points` (sensor frame) may be empty when the protocol has no range rule;
/// `limits` are then unused. Throws std::invalid_argument when sizes differ or the limits are not
/// an interval.
Confusion score_scan(const Protocol& protocol, std::span<const std::uint32_t> truth,
                     std::span<const std::uint32_t> prediction, std::span<const Point> points,
                     const RangeGate& limits);

/// Counts the points within the protocol's default limits.
inline Confusion score_scan(const Protocol& protocol, std::span<const std::uint32_t> truth,
                            std::span<const std::uint32_t> prediction,
                            std::span<const Point> points) {
  return score_scan(protocol, truth, prediction, points, protocol.default_range);
}

/// Returns the outcome of every point under the rules of `score_scan`, in stored order.
std::vector<PointOutcome> point_outcomes(const Protocol& protocol,
                                         std::span<const std::uint32_t> truth,
                                         std::span<const std::uint32_t> prediction,
                                         std::span<const Point> points, const RangeGate& limits);

/// Returns the distance of a point from the sensor in metres, computed in the number type of the
/// protocol's own program.
double range_m(const Point& point, Arithmetic arithmetic);

}  // namespace mosbench
