#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "eval/protocols/protocol.hpp"

namespace mosbench {

using Labels = std::vector<std::uint32_t>;

inline Confusion counts(std::uint64_t tp, std::uint64_t fp, std::uint64_t fn) {
  Confusion confusion;
  confusion.tp = tp;
  confusion.fp = fp;
  confusion.fn = fn;
  return confusion;
}

/// Scores scans whose points all lie 5 m ahead, within every protocol's limits.
inline Confusion score(std::string_view protocol, const Labels& truth, const Labels& prediction) {
  const std::vector<Point> points(truth.size(), Point{5.0F, 0.0F, 0.0F, 0.0F});
  return score_scan(protocol_named(protocol), truth, prediction, points);
}

}  // namespace mosbench
