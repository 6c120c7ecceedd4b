#include "eval/truth/completion.hpp"

#include <cmath>
#include <limits>
#include <unordered_map>

namespace mosbench {
namespace {

constexpr double kReach_m = 0.3, kColumn_m = 0.5;
constexpr double kLeastHeight_m = 0.05, kMostHeight_m = 0.5;
constexpr int kColumnsAround = 2;

/// Cells a million apart share a key: no scan is as large.
std::uint64_t key_of(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::uint64_t kBits = 21, kMask = (1U << kBits) - 1;
  const auto bits = [](std::int64_t i) { return static_cast<std::uint64_t>(i) & kMask; };
  return bits(x) << (2 * kBits) | bits(y) << kBits | bits(z);
}

std::int64_t cell(double position_m, double side_m) {
  return static_cast<std::int64_t>(std::floor(position_m / side_m));
}

/// Heights of the lowest points by column.
class LowestPoints {
 public:
  explicit LowestPoints(std::span<const Eigen::Vector3d> positions_m) {
    for (const Eigen::Vector3d& p : positions_m) {
      if (!p.allFinite()) continue;
      const auto [low, is_new] =
          low_m_.try_emplace(key_of(cell(p.x(), kColumn_m), cell(p.y(), kColumn_m), 0), p.z());
      if (!is_new) low->second = std::min(low->second, p.z());
    }
  }

  double height_m(const Eigen::Vector3d& p) const {
    double low_m = p.z();
    for (int x = -kColumnsAround; x <= kColumnsAround; ++x) {
      for (int y = -kColumnsAround; y <= kColumnsAround; ++y) {
        const auto low =
            low_m_.find(key_of(cell(p.x(), kColumn_m) + x, cell(p.y(), kColumn_m) + y, 0));
        if (low != low_m_.end()) low_m = std::min(low_m, low->second);
      }
    }
    return p.z() - low_m;
  }

 private:
  std::unordered_map<std::uint64_t, double> low_m_;
};

/// Points of objects by cells of the reach.
class ObjectPoints {
 public:
  ObjectPoints(std::span<const Eigen::Vector3d> positions_m, std::span<const std::uint32_t> part)
      : positions_m_(positions_m), part_(part) {
    for (std::size_t i = 0; i < part.size(); ++i) {
      const Eigen::Vector3d& p = positions_m[i];
      if (part[i] == 0 || !p.allFinite()) continue;
      points_[key_of(cell(p.x(), kReach_m), cell(p.y(), kReach_m), cell(p.z(), kReach_m))]
          .push_back(i);
    }
  }

  std::uint32_t nearest(const Eigen::Vector3d& p) const {
    double least = kReach_m * kReach_m;
    std::uint32_t found = 0;
    for (int neighbour = 0; neighbour < 27; ++neighbour) {
      const auto cell_points = points_.find(key_of(cell(p.x(), kReach_m) + neighbour % 3 - 1,
                                                   cell(p.y(), kReach_m) + neighbour / 3 % 3 - 1,
                                                   cell(p.z(), kReach_m) + neighbour / 9 - 1));
      if (cell_points == points_.end()) continue;
      for (const std::size_t i : cell_points->second) {
        const double distance = (positions_m_[i] - p).squaredNorm();
        if (distance >= least) continue;
        least = distance;
        found = part_[i];
      }
    }
    return found;
  }

 private:
  std::span<const Eigen::Vector3d> positions_m_;
  std::span<const std::uint32_t> part_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> points_;
};

}  // namespace

std::vector<std::uint32_t> completed_by(std::span<const Eigen::Vector3d> positions_map_m,
                                        std::span<const std::uint32_t> part) {
  std::vector<std::uint32_t> completed(part.size(), 0);
  const LowestPoints lowest(positions_map_m);
  const ObjectPoints objects(positions_map_m, part);
  for (std::size_t i = 0; i < part.size(); ++i) {
    const Eigen::Vector3d& p = positions_map_m[i];
    if (part[i] != 0 || !p.allFinite()) continue;
    const std::uint32_t nearest = objects.nearest(p);
    if (nearest == 0) continue;
    const double height_m = lowest.height_m(p);
    if (height_m >= kLeastHeight_m && height_m <= kMostHeight_m) completed[i] = nearest;
  }
  return completed;
}

std::vector<double> heights_m(std::span<const Eigen::Vector3d> positions_map_m) {
  const LowestPoints lowest(positions_map_m);
  std::vector<double> heights;
  for (const Eigen::Vector3d& p : positions_map_m) {
    heights.push_back(p.allFinite() ? lowest.height_m(p)
                                    : std::numeric_limits<double>::quiet_NaN());
  }
  return heights;
}

}  // namespace mosbench
