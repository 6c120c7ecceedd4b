#pragma once

#include <cstdint>
#include <span>

#include "core/scan.hpp"
#include "eval/protocol.hpp"

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

/// Counts one scan by the protocol's rules; `truth` and `prediction` are raw labels, one per point.
/// `points` (sensor frame) may be empty when the protocol has no range rule; `limits` then do not
/// matter. Throws std::invalid_argument when sizes differ or the limits are no interval.
Confusion score_scan(const Protocol& protocol, std::span<const std::uint32_t> truth,
                     std::span<const std::uint32_t> prediction, std::span<const Point> points,
                     const RangeGate& limits);

/// The same with the protocol's default limits.
Confusion score_scan(const Protocol& protocol, std::span<const std::uint32_t> truth,
                     std::span<const std::uint32_t> prediction, std::span<const Point> points);

/// Distance of a point from the sensor as the protocol's own program computes it, metres.
double range_m(const Point& point, Arithmetic arithmetic);

}  // namespace mosbench
