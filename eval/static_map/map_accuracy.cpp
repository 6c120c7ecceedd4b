#include "eval/static_map/map_accuracy.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <vector>

#include "datasets/formats/point_range.hpp"

namespace mosbench {
namespace {

/// The finite points of a map, as nanoflann reads them.
class FinitePoints {
 public:
  explicit FinitePoints(std::span<const Point> points) {
    points_.reserve(points.size());
    for (const Point& p : points) {
      if (is_finite(p)) points_.push_back({p.x, p.y, p.z});
    }
  }
  std::size_t kdtree_get_point_count() const { return points_.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return points_[i][axis]; }
  template <typename Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }

 private:
  std::vector<std::array<float, 3>> points_;
};

class Map {
 public:
  explicit Map(std::span<const Point> points) : points_(points), tree_(3, points_) {}

  /// Infinite for an empty map.
  float distance_to_nearest_m(const Point& point) const {
    const std::array<float, 3> position = {point.x, point.y, point.z};
    std::uint32_t nearest = 0;
    float squared_m2 = std::numeric_limits<float>::infinity();
    tree_.knnSearch(position.data(), 1, &nearest, &squared_m2);
    return std::sqrt(squared_m2);
  }

 private:
  using Distance = nanoflann::L2_Simple_Adaptor<float, FinitePoints>;
  FinitePoints points_;
  nanoflann::KDTreeSingleIndexAdaptor<Distance, FinitePoints, 3, std::uint32_t> tree_;
};

std::optional<double> share(std::uint64_t part, std::uint64_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

std::optional<double> MapCounts::static_accuracy() const {
  return share(kept_static, static_points);
}

std::optional<double> MapCounts::dynamic_accuracy() const {
  return share(removed_dynamic, dynamic_points);
}

std::optional<double> MapCounts::associated_accuracy() const {
  const auto sa = static_accuracy(), da = dynamic_accuracy();
  if (!sa || !da) return std::nullopt;
  return std::sqrt(*sa * *da);
}

std::optional<double> MapCounts::harmonic_accuracy() const {
  const auto sa = static_accuracy(), da = dynamic_accuracy();
  if (!sa || !da) return std::nullopt;
  return *sa + *da == 0 ? 0 : 2 * *sa * *da / (*sa + *da);
}

MapCounts count_kept(std::span<const Point> map, std::span<const Point> truth,
                     const std::vector<bool>& dynamic, double same_within_m) {
  const Map nearest_of(map);
  const auto same_within = static_cast<float>(same_within_m);
  MapCounts counts;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const bool kept = nearest_of.distance_to_nearest_m(truth[i]) <= same_within;
    if (dynamic[i]) {
      ++counts.dynamic_points;
      counts.removed_dynamic += !kept;
    } else {
      ++counts.static_points;
      counts.kept_static += kept;
    }
  }
  return counts;
}

}  // namespace mosbench
