#include "datasets/sequence/ego_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>

#include "datasets/formats/point_range.hpp"
#include "datasets/formats/pose_file.hpp"

namespace mosbench {
namespace {

constexpr double kCellM = 0.1, kReachM = 5.0;
/// Cells per axis: a free one around those in reach, so that all have neighbours.
constexpr int kSide = 104;
constexpr std::size_t kMostEgoScans = 40, kFewestEgoScans = 9;
constexpr double kStepM = 1.0;
/// A scan hits nearly all of the vehicle, but single beams miss its edges.
constexpr double kCoreShare = 0.9, kEdgeShare = 0.2;
/// From where a place is looked at: no part of the vehicle may still be there.
constexpr double kApartM = 4.0, kMostApartM = 12.0, kNearestLookM = 4.0;
constexpr std::size_t kViewers = 3;
constexpr double kBeyondM = 0.5;
constexpr double kThroughShare = 0.8;
constexpr std::uint32_t kFewestLooks = 3;

std::optional<std::uint32_t> cell_of(const Point& point) {
  if (!is_return(point) || range_m(point) >= kReachM) return std::nullopt;
  const auto along = [](float at_m) {
    return static_cast<std::uint32_t>(std::floor(at_m / kCellM) + kSide / 2);
  };
  return (along(point.x) * kSide + along(point.y)) * kSide + along(point.z);
}

constexpr std::size_t kCells = std::size_t{kSide} * kSide * kSide;

/// Calls a function with the cells around one.
void for_neighbours(std::uint32_t cell, auto&& call) {
  for (const int x : {-1, 0, 1}) {
    for (const int y : {-1, 0, 1}) {
      for (const int z : {-1, 0, 1}) {
        call(static_cast<std::uint32_t>(static_cast<int>(cell) + (x * kSide + y) * kSide + z));
      }
    }
  }
}

/// What is seen of a place from elsewhere.
enum class Sight : std::uint8_t { kUnknown, kThrough, kStands };

/// The returns of a scan by their directions.
class SightLines {
 public:
  explicit SightLines(const std::vector<Point>& points) {
    for (const Point& point : points) {
      if (!is_return(point)) continue;
      const Eigen::Vector3d end_m = position_of(point);
      ends_m_[key_of(end_m.normalized())].push_back(end_m);
    }
  }

  /// Looks at a place with all rays within `kAroundM` of it. Along a wall or over the ground some
  /// pass on the near side, but those on the far side end before.
  Sight look_at(const Eigen::Vector3d& place_m) const {
    const double away_m = place_m.norm();
    const Eigen::Vector3d ahead = place_m / away_m;
    const Eigen::Vector3d aside = ahead.unitOrthogonal(), up = ahead.cross(aside);
    double nearest_m = kUnseenM, farthest_m = 0.0;
    unsigned sides = 0;
    for_neighbours(key_of(ahead), [&](std::uint32_t key) {
      const auto found = ends_m_.find(key);
      if (found == ends_m_.end()) return;
      for (const Eigen::Vector3d& end_m : found->second) {
        const Eigen::Vector3d by_m = end_m * (away_m / end_m.dot(ahead)) - place_m;
        if (by_m.squaredNorm() > kAroundM * kAroundM) continue;
        const double range_m = end_m.norm(), x = by_m.dot(aside), y = by_m.dot(up);
        nearest_m = std::min(nearest_m, range_m);
        farthest_m = std::max(farthest_m, range_m);
        if (by_m.norm() < kCellM / 2) continue;
        sides |= std::abs(x) > std::abs(y) ? (x > 0 ? 1U : 2U) : (y > 0 ? 4U : 8U);
      }
    });
    if (farthest_m < away_m - kBeyondM) return Sight::kUnknown;
    if (nearest_m < away_m + kBeyondM) return Sight::kStands;
    return sides == kAllSides ? Sight::kThrough : Sight::kUnknown;
  }

 private:
  static constexpr double kAroundM = 0.2, kUnseenM = 1e9;
  static constexpr unsigned kAllSides = 15;
  /// Of a grid of directions: as wide as what is around the nearest place.
  static constexpr double kTurn = kAroundM / kNearestLookM;
  static std::uint32_t key_of(const Eigen::Vector3d& direction) {
    const auto along = [](double part) {
      return static_cast<std::uint32_t>(std::floor(part / kTurn) + kSide / 2);
    };
    return (along(direction.x()) * kSide + along(direction.y())) * kSide + along(direction.z());
  }

  std::unordered_map<std::uint32_t, std::vector<Eigen::Vector3d>> ends_m_;
};

/// Returns scans spread over the way, most of them with another one soon after; none where there is
/// hardly a way.
std::vector<std::size_t> scans_along(const std::vector<Pose>& poses) {
  std::vector<std::size_t> steps, scans;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    if (steps.empty() || distance_m(poses[steps.back()], poses[k]) >= kStepM) steps.push_back(k);
  }
  if (steps.size() < kFewestEgoScans) return {};
  if (steps.size() <= kMostEgoScans) return steps;
  for (std::size_t i = 0; i < kMostEgoScans / 2; ++i) {
    const auto from =
        steps.begin() + static_cast<std::ptrdiff_t>(2 * i * steps.size() / kMostEgoScans);
    scans.push_back(*from);
    const auto next = std::find_if(from, steps.end(), [&](std::size_t k) {
      return distance_m(poses[*from], poses[k]) >= kApartM;
    });
    if (next != steps.end()) scans.push_back(*next);
  }
  std::ranges::sort(scans);
  scans.erase(std::unique(scans.begin(), scans.end()), scans.end());
  return scans;
}

class EgoSearch {
 public:
  explicit EgoSearch(const Sequence& sequence)
      : sequence_(sequence), poses_(poses_of(sequence)), scans_(scans_along(poses_)) {}

  EgoPlaces run() {
    if (scans_.empty()) return {};
    for (const std::size_t scan : scans_) hit(scan);
    if (std::ranges::none_of(hits_, [&](std::uint8_t hits) { return is_in(hits, kCoreShare); })) {
      return {};
    }
    for (const std::size_t viewer : scans_) look_from(viewer);
    return grown();
  }

 private:
  struct Place {
    std::uint32_t cell;
    Eigen::Vector3d on_map_m;
  };

  bool is_in(std::uint8_t hits, double share) const {
    return hits >= share * static_cast<double>(scans_.size());
  }

  void hit(std::size_t scan) {
    sequence_.read(scan, frame_);
    std::unordered_map<std::uint32_t, Point> seen;
    for (const Point& point : frame_.points) {
      const auto cell = cell_of(point);
      if (!cell) continue;
      ++points_[*cell];
      if (seen.emplace(*cell, point).second) ++hits_[*cell];
    }
    for (const auto& [cell, point] : seen) {
      places_[scan].push_back({cell, poses_[scan] * position_of(point)});
    }
  }

  /// Returns the scans nearest to the viewer that are far enough away.
  std::vector<std::size_t> seen_from(std::size_t viewer) const {
    std::vector<std::pair<double, std::size_t>> others;
    for (const std::size_t scan : scans_) {
      const double apart_m = distance_m(poses_[viewer], poses_[scan]);
      if (apart_m >= kApartM && apart_m <= kMostApartM) others.emplace_back(apart_m, scan);
    }
    std::ranges::sort(others);
    std::vector<std::size_t> nearest;
    for (const auto& [unused, scan] : others) {
      if (nearest.size() < kViewers) nearest.push_back(scan);
    }
    return nearest;
  }

  void look_from(std::size_t viewer) {
    sequence_.read(viewer, frame_);
    const SightLines lines(frame_.points);
    const Pose viewer_from_map = poses_[viewer].inverse();
    for (const std::size_t scan : seen_from(viewer)) {
      for (const Place& place : places_.at(scan)) {
        if (!is_in(hits_[place.cell], kEdgeShare)) continue;
        const Eigen::Vector3d place_m = viewer_from_map * place.on_map_m;
        if (place_m.norm() < kNearestLookM) continue;
        const Sight sight = lines.look_at(place_m);
        if (sight == Sight::kUnknown) continue;
        Looks& looks = looks_[place.cell];
        ++looks.all;
        if (sight == Sight::kThrough) ++looks.through;
      }
    }
  }

  bool is_left(std::uint32_t cell) const {
    const auto looks = looks_.find(cell);
    return looks != looks_.end() && looks->second.all >= kFewestLooks &&
           looks->second.through >= kThroughShare * looks->second.all;
  }

  /// Returns the cells that nearly all scans hit, those connected with them, and one around, over
  /// whose edges noise goes.
  EgoPlaces grown() const {
    std::vector<std::uint32_t> found;
    std::vector<bool> taken(kCells), cells(kCells);
    const auto take = [&](std::uint32_t cell, double share) {
      if (taken[cell] || !is_in(hits_[cell], share) || !is_left(cell)) return;
      taken[cell] = true;
      found.push_back(cell);
    };
    for (std::uint32_t cell = 0; cell < kCells; ++cell) take(cell, kCoreShare);
    for (std::size_t i = 0; i < found.size(); ++i) {
      for_neighbours(found[i], [&](std::uint32_t cell) { take(cell, kEdgeShare); });
    }
    if (found.empty()) return {};
    for (const std::uint32_t cell : found) {
      for_neighbours(cell, [&](std::uint32_t near) { cells[near] = true; });
    }
    return measured(std::move(cells));
  }

  EgoPlaces measured(std::vector<bool> cells) const {
    EgoPlaces ego{std::move(cells)};
    for (const std::size_t scan : scans_) {
      for (const Place& place : places_.at(scan)) {
        if (!ego.cells[place.cell]) continue;
        ego.farthest_m =
            std::max(ego.farthest_m, (place.on_map_m - poses_[scan].translation()).norm());
      }
    }
    for (std::uint32_t cell = 0; cell < kCells; ++cell) {
      if (ego.cells[cell]) ego.points_per_scan += points_[cell];
    }
    ego.points_per_scan /= static_cast<double>(scans_.size());
    return ego;
  }

  struct Looks {
    std::uint32_t all = 0, through = 0;
  };

  const Sequence& sequence_;
  const std::vector<Pose> poses_;
  const std::vector<std::size_t> scans_;
  Frame frame_;
  std::vector<std::uint8_t> hits_ = std::vector<std::uint8_t>(kCells);      ///< scans
  std::vector<std::uint32_t> points_ = std::vector<std::uint32_t>(kCells);  ///< of all scans
  std::unordered_map<std::size_t, std::vector<Place>> places_;              ///< of a scan
  std::unordered_map<std::uint32_t, Looks> looks_;
};

class EgolessSequence : public SequenceAround {
 public:
  explicit EgolessSequence(std::unique_ptr<Sequence> inner)
      : SequenceAround(std::move(inner)), ego_(find_ego(this->inner())) {
    mutable_recording().reading.drop_ego = ego_.empty() ? "none found" : to_string(ego_);
    mutable_recording().remarks.push_back(
        ego_.empty() ? "no points of the vehicle itself are found, for which poses have to move 8 m"
                     : "left out: " + to_string(ego_));
  }

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    inner().read(scan_index, frame);
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      if (ego_.hold(frame.points[i])) lose_point(frame, i);
    }
  }
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override {
    return ego_.empty() ? inner().read_truth(scan_index) : Sequence::read_truth(scan_index);
  }

 private:
  EgoPlaces ego_;
};

}  // namespace

bool EgoPlaces::hold(const Point& point) const {
  const auto cell = empty() ? std::nullopt : cell_of(point);
  return cell && cells[*cell];
}

std::string to_string(const EgoPlaces& ego) {
  return fmt::format("{:.0f} points per scan of the vehicle itself, within {:.1f} m of the sensor",
                     ego.points_per_scan, ego.farthest_m);
}

EgoPlaces find_ego(const Sequence& sequence) { return EgoSearch(sequence).run(); }

std::unique_ptr<Sequence> without_ego(std::unique_ptr<Sequence> inner) {
  return std::make_unique<EgolessSequence>(std::move(inner));
}

}  // namespace mosbench
