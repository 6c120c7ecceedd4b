#pragma once

#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>
#include <string>

#include "eval/protocols/confusion.hpp"

namespace mosbench {

/// What the unsure points of own truth, those of id 0, leave open: counts as if each of them spoke
/// against the prediction, and as if each spoke for it.
struct UnsureBounds {
  Confusion lowest, highest;

  /// Adds a scan, with points where the protocol has a range rule.
  void add(const ScoreRule& rule, std::span<const std::uint32_t> truth,
           std::span<const std::uint32_t> prediction, std::span<const Point> points);
  UnsureBounds& operator+=(const UnsureBounds& other);
  /// "unsure points leave 71.2 to 75.0 % IoU open, by mapmos"; empty where they leave nothing open.
  std::string text(const ScoreRule& rule) const;
};

}  // namespace mosbench
