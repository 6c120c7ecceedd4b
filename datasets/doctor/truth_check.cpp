#include "datasets/doctor/truth_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <unordered_map>

#include "datasets/doctor/scan_overlap.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/text/counted.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kLabelledScans = 12;
/// Scans to look from: half a second and a second away at 10 Hz.
constexpr std::ptrdiff_t kLookFrom[] = {-10, -5, 5, 10};
constexpr std::size_t kStillPoints = 4000;  // per scan
constexpr double kLeastRangeM = 1.0, kMostRangeM = 50.0;
/// More labelled points do not move: sound labels had 0.08 at most, exchanged ones 0.92 and more.
constexpr double kMostMoving = 0.5;
/// With fewer moving points nothing is said.
constexpr std::size_t kFewestMoving = 200;
/// Labels without anything moving over more scans, a minute at 10 Hz, are doubtful: excerpts of
/// some seconds without movers are sound, while data sets of moving objects show some in each
/// minute.
constexpr std::size_t kScansWithoutMoving = 600;
/// Points labelled moving leave their place so many times as often as static ones. Sound labels had
/// 4.6 (campus, Avia) and more, usually hundreds; labels of another scan 1 to 14.
constexpr double kTimesStill = 2.0;
/// Labels of these scans are purer: sound ones had 0.867 (simulated room) and 0.963 (KITTI), those
/// of the next scan 0.76 and less, shuffled ones 0.38 and less.
constexpr double kLeastPurity = 0.82;

bool is_moving_id(std::uint32_t label) {
  constexpr std::uint32_t kLast = 259;  // of SemanticKITTI
  const std::uint32_t id = label & 0xFFFFU;
  return id >= kMovingLabel && id <= kLast;
}

/// The nearest return in each direction.
class RangeImage {
 public:
  explicit RangeImage(const std::vector<Point>& points) : nearest_m_(kRows * kColumns, kNothingM) {
    for (const Point& point : points) {
      const auto cell = cell_of({point.x, point.y, point.z});
      if (!cell) continue;
      float& nearest_m = nearest_m_[*cell];
      nearest_m = std::min(nearest_m, static_cast<float>(range_m(point)));
    }
  }

  /// Returns whether all returns in and around the direction of a place are beyond it; nothing when
  /// there are none, or when something hides it.
  std::optional<bool> looks_through(const Eigen::Vector3d& place_m) const {
    constexpr double kBeyondM = 0.5, kBeyondShare = 0.02;
    const auto middle = cell_of(place_m);
    if (!middle || nearest_m_[*middle] == kNothingM) return std::nullopt;
    const double range_m = place_m.norm(), margin_m = kBeyondM + kBeyondShare * range_m;
    const std::size_t row = *middle / kColumns, column = *middle % kColumns;
    if (nearest_m_[*middle] < range_m - margin_m) return std::nullopt;
    for (std::size_t r = std::max<std::size_t>(row, 1) - 1; r <= std::min(row + 1, kRows - 1);
         ++r) {
      for (const std::size_t c : {column + kColumns - 1, column, column + 1}) {
        const float nearest_m = nearest_m_[r * kColumns + c % kColumns];
        if (nearest_m < range_m + margin_m) return false;
      }
    }
    return true;
  }

 private:
  static constexpr std::size_t kRows = 180, kColumns = 720;  // degree, half degree
  static constexpr float kNothingM = 1e9F;

  static std::optional<std::size_t> cell_of(const Eigen::Vector3d& place_m) {
    const double range_m = place_m.norm();
    if (!(range_m > kLeastRangeM) || !std::isfinite(range_m)) return std::nullopt;
    const double up = std::asin(std::clamp(place_m.z() / range_m, -1.0, 1.0)) / std::numbers::pi;
    const double around = std::atan2(place_m.y(), place_m.x()) / (2.0 * std::numbers::pi);
    const auto row = static_cast<std::size_t>((up + 0.5) * static_cast<double>(kRows));
    const auto column = static_cast<std::size_t>((around + 0.5) * static_cast<double>(kColumns));
    return std::min(row, kRows - 1) * kColumns + std::min(column, kColumns - 1);
  }

  std::vector<float> nearest_m_;
};

std::uint64_t cube_of(const Point& point) {
  constexpr double kCubeM = 0.5, kHalf = 1 << 20;
  const auto index = [](float value) {
    return static_cast<std::uint64_t>(
        std::clamp(std::floor(value / kCubeM) + kHalf, 0.0, 2 * kHalf));
  };
  return (index(point.x) << 42U) | (index(point.y) << 21U) | index(point.z);
}

class TruthChecking {
 public:
  TruthChecking(const Sequence& sequence, const std::vector<Pose>& poses, bool poses_fit)
      : sequence_(sequence), poses_(poses), poses_fit_(poses_fit) {}

  TruthCheck run() {
    examine_some(scans_with_truth(sequence_));
    if (result_.moving + result_.still == 0) examine_some(scans_with_labels(sequence_));
    result_.moving_leaves = share(moving_left_, moving_seen_);
    result_.still_leaves = share(still_left_, still_seen_);
    result_.purity = result_.moving > 0 ? purity_sum_ / static_cast<double>(result_.moving) : 0.0;
    judge();
    return std::move(result_);
  }

 private:
  static double share(std::size_t part, std::size_t whole) {
    return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
  }

  void examine_some(const std::vector<std::size_t>& labelled) {
    const std::size_t count = std::min(kLabelledScans, labelled.size());
    for (std::size_t i = 0; i < count; ++i) examine(labelled[i * labelled.size() / count]);
  }

  void examine(std::size_t scan_index) {
    const Frame frame = sequence_.read(scan_index);
    if (!frame.truth) return;
    ++result_.scans;
    std::vector<std::size_t> moving, still;
    std::unordered_map<std::uint64_t, std::pair<double, double>> cubes;  // moving, all
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      const double range = range_m(frame.points[i]);
      if (((*frame.truth)[i] & 0xFFFFU) == 0 || !(range > kLeastRangeM)) continue;
      const bool moves = is_moving_id((*frame.truth)[i]);
      auto& [moving_in_cube, all_in_cube] = cubes[cube_of(frame.points[i])];
      all_in_cube += 1.0;
      if (moves) moving_in_cube += 1.0;
      (moves ? moving : still).push_back(i);
    }
    for (const auto& [unused, cube] : cubes) purity_sum_ += cube.first * cube.first / cube.second;
    result_.moving += moving.size();
    result_.still += still.size();
    look_from_others(scan_index, frame.points, moving, still);
  }

  void look_from_others(std::size_t scan_index, const std::vector<Point>& points,
                        const std::vector<std::size_t>& moving,
                        const std::vector<std::size_t>& still) {
    std::vector<std::pair<RangeImage, Pose>> others;
    for (const std::ptrdiff_t apart : kLookFrom) {
      const std::ptrdiff_t other = static_cast<std::ptrdiff_t>(scan_index) + apart;
      if (other < 0 || other >= static_cast<std::ptrdiff_t>(sequence_.size())) continue;
      const auto index = static_cast<std::size_t>(other);
      others.emplace_back(RangeImage(sequence_.read(index).points),
                          relative(poses_, {index, scan_index}));
    }
    const auto count = [&](std::size_t i, std::size_t& seen, std::size_t& left) {
      const Eigen::Vector3d point_m(points[i].x, points[i].y, points[i].z);
      if (!(point_m.norm() < kMostRangeM)) return;
      bool is_seen = false, is_left = false;
      for (const auto& [image, other_from_this] : others) {
        const auto through = image.looks_through(other_from_this * point_m);
        is_seen = is_seen || through.has_value();
        is_left = is_left || through.value_or(false);
      }
      seen += is_seen ? 1 : 0;
      left += is_left ? 1 : 0;
    };
    for (const std::size_t i : moving) count(i, moving_seen_, moving_left_);
    const std::size_t step = std::max<std::size_t>(1, still.size() / kStillPoints);
    for (std::size_t k = 0; k < still.size(); k += step) {
      count(still[k], still_seen_, still_left_);
    }
  }

  void judge() {
    if (result_.moving + result_.still == 0) return;
    const double moves = share(result_.moving, result_.moving + result_.still);
    if (result_.moving == 0) {
      judge_without_moving();
    } else if (moves > kMostMoving) {
      result_.findings.push_back(
          fmt::format("the labels call {:.0f} % of the points moving; expected less than half "
                      "(are static and moving exchanged?)",
                      100.0 * moves));
    } else if (moving_seen_ >= kFewestMoving && scattered_or_still()) {
      result_.findings.push_back(fmt::format(
          "the labels do not fit the scans: of the points labelled moving {:.0f} % leave their "
          "place within a second, of those labelled static {:.1f} %, and {:.0f} % of the points "
          "around a moving one are moving; expected the labels of these scans",
          100.0 * result_.moving_leaves, 100.0 * result_.still_leaves, 100.0 * result_.purity));
    }
  }

  /// Looks for moving labels in all scans, since those examined may have missed them.
  void judge_without_moving() {
    const std::vector<std::size_t> labelled = scans_with_truth(sequence_);
    const bool none = std::ranges::none_of(labelled, [&](std::size_t scan_index) {
      return std::ranges::any_of(sequence_.read_truth(scan_index), is_moving_id);
    });
    if (!none) return;
    const std::size_t span = labelled.back() - labelled.front() + 1;
    const std::string what =
        fmt::format("no point of {} is labelled moving", counted(labelled.size(), "labelled scan"));
    if (span > kScansWithoutMoving) {
      result_.findings.push_back(
          fmt::format("{}; expected some in a sequence over {}", what, counted(span, "scan")));
    } else {
      result_.remarks.push_back(what + ": the IoU of these labels is undefined");
    }
  }

  bool scattered_or_still() const {
    return result_.purity < kLeastPurity ||
           (poses_fit_ && result_.moving_leaves < kTimesStill * result_.still_leaves);
  }

  const Sequence& sequence_;
  const std::vector<Pose>& poses_;
  bool poses_fit_;
  std::size_t moving_seen_ = 0, moving_left_ = 0, still_seen_ = 0, still_left_ = 0;
  double purity_sum_ = 0.0;
  TruthCheck result_;
};

}  // namespace

std::vector<std::size_t> scans_with_labels(const Sequence& sequence) {
  std::vector<std::size_t> labelled = scans_with_truth(sequence);
  std::erase_if(labelled, [&](std::size_t scan_index) {
    return std::ranges::all_of(sequence.read_truth(scan_index),
                               [](std::uint32_t label) { return (label & 0xFFFFU) == 0; });
  });
  return labelled;
}

TruthCheck check_truth(const Sequence& sequence, const std::vector<Pose>& map_from_sensor,
                       bool poses_fit) {
  return TruthChecking(sequence, map_from_sensor, poses_fit).run();
}

}  // namespace mosbench
