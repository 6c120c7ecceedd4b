#include "eval/static_map/map_score.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>

#include "datasets/formats/point_range.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/layouts/kth_layout.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/result/machine.hpp"

namespace mosbench {
namespace fs = std::filesystem;
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

std::vector<Point> read_cloud(const fs::path& file) {
  if (file.extension() == ".bin") {
    throw DataError(file, "does not say what its columns are", "a .pcd or .ply file");
  }
  return read_scan(file);
}

/// Points are float32: far from the origin they lie on a grid that may be wider than what counts.
void check_steps(const std::vector<Point>& points, const fs::path& file, double same_within_m) {
  constexpr double kMostShare = 0.1;
  float most_m = 0;
  for (const Point& p : points) {
    for (const float x : {p.x, p.y, p.z}) {
      if (std::isfinite(x)) most_m = std::max(most_m, std::abs(x));
    }
  }
  const float step_m = float_step_m(most_m);
  if (step_m <= kMostShare * same_within_m) return;
  throw DataError(file,
                  fmt::format("positions up to {:.0f} m are {} m apart in float32", most_m, step_m),
                  fmt::format("both clouds nearer to the origin, as {} m count", same_within_m));
}

std::vector<Point> finite_points(const fs::path& file) {
  std::vector<Point> points = read_cloud(file);
  if (points.empty())
    throw DataError(file, "holds no point", "the points that the map was made of");
  const auto odd = std::ranges::find(points, false, is_finite);
  if (odd == points.end()) return points;
  throw DataError(file, fmt::format("point {} is not finite", odd - points.begin()),
                  "a position for each point");
}

std::vector<bool> dynamic_points(const std::vector<Point>& points, const fs::path& file) {
  const std::vector<std::uint32_t> labels = kth_truth(points, file);
  std::vector<bool> dynamic(labels.size());
  for (std::size_t i = 0; i < labels.size(); ++i) dynamic[i] = labels[i] == kMovingLabel;
  return dynamic;
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

MapScore score_map(const fs::path& map, const fs::path& truth, double same_within_m) {
  MapScore score{
      map, fs::is_directory(truth) ? truth / "gt_cloud.pcd" : truth, 0, same_within_m, {}};
  const std::vector<Point> points = finite_points(score.truth);
  const std::vector<bool> dynamic = dynamic_points(points, score.truth);
  const std::vector<Point> cleaned = read_cloud(map);
  check_steps(points, score.truth, same_within_m);
  check_steps(cleaned, map, same_within_m);
  score.map_points = cleaned.size();
  score.counts = count_kept(cleaned, points, dynamic, same_within_m);
  return score;
}

Sheet map_score_sheet(const MapScore& score) {
  const MapCounts& counts = score.counts;
  const auto kept = [](std::uint64_t part, std::uint64_t all) {
    return fmt::format("{} of {}", part, all);
  };
  return {.lead = {fmt::format("map    {}, {}", shown_in_line(score.map.string()),
                               counted(score.map_points, "point")),
                   fmt::format("truth  {}, {}; kept where a point of the map is within {} m",
                               shown_in_line(score.truth.string()),
                               counted(counts.static_points + counts.dynamic_points, "point"),
                               score.same_within_m)},
          .columns = {{"points of the truth", Unit::kText},
                      {"number"},
                      {"accuracy"},
                      {"right", Unit::kPercent, 2}},
          .rows = {{"static, kept", kept(counts.kept_static, counts.static_points), "SA",
                    or_undefined(counts.static_accuracy())},
                   {"dynamic, removed", kept(counts.removed_dynamic, counts.dynamic_points), "DA",
                    or_undefined(counts.dynamic_accuracy())},
                   {"both", "", "AA", or_undefined(counts.associated_accuracy())},
                   {"both", "", "HA", or_undefined(counts.harmonic_accuracy())}}};
}

nlohmann::ordered_json map_score_json(const MapScore& score) {
  const MapCounts& counts = score.counts;
  return {{"code", code_json()},
          {"map",
           {{"path", score.map.string()},
            {"hash", hash_of_file(score.map)},
            {"points", score.map_points}}},
          {"truth", {{"path", score.truth.string()}, {"hash", hash_of_file(score.truth)}}},
          {"same_within_m", score.same_within_m},
          {"static_points", counts.static_points},
          {"kept_static", counts.kept_static},
          {"dynamic_points", counts.dynamic_points},
          {"removed_dynamic", counts.removed_dynamic},
          {"sa", json_or_null(counts.static_accuracy())},
          {"da", json_or_null(counts.dynamic_accuracy())},
          {"aa", json_or_null(counts.associated_accuracy())},
          {"ha", json_or_null(counts.harmonic_accuracy())}};
}

}  // namespace mosbench
