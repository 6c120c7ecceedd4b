#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <unordered_map>

#include "datasets/doctor/doctor.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/layouts/sequence_writer.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kLabelledScans = 12;
/// Scans to look from: half a second and a second away at 10 Hz; or 1.5 s, too, which shows more of
/// what moves slowly or is hit by few rays.
constexpr std::ptrdiff_t kLookFrom[] = {-10, -5, 5, 10};
constexpr std::ptrdiff_t kLookFromMore[] = {-15, -10, -5, 5, 10, 15};
constexpr std::size_t kStillPoints = 4000;  // per scan
constexpr double kLeastRangeM = 1.0, kMostRangeM = 50.0;
/// Moving points are compared with those in the same cube.
constexpr double kCubeM = 0.5;

/// The nearest return in each direction.
class RangeImage {
 public:
  explicit RangeImage(const std::vector<Point>& points) : nearest_m_(kRows * kColumns, kNothingM) {
    for (const Point& point : points) {
      const auto cell = cell_of(position_of(point));
      if (!cell) continue;
      float& nearest_m = nearest_m_[*cell];
      nearest_m = std::min(nearest_m, static_cast<float>(range_m(point)));
    }
  }

  /// Returns whether all returns in and around the direction of a place are beyond it, and the next
  /// ones below; nothing when there are none, or when something hides it. Those below tell ground:
  /// above it all returns of a sparse sensor may be beyond.
  std::optional<bool> looks_through(const Eigen::Vector3d& place_m) const {
    constexpr double kBeyondM = 0.5, kBeyondShare = 0.02;
    constexpr std::size_t kMostBelow = 3;
    const auto middle = cell_of(place_m);
    if (!middle || nearest_m_[*middle] == kNothingM) return std::nullopt;
    const double range_m = place_m.norm(), margin_m = kBeyondM + kBeyondShare * range_m;
    const std::size_t row = *middle / kColumns, column = *middle % kColumns;
    if (nearest_m_[*middle] < range_m - margin_m) return std::nullopt;
    for (std::size_t r = std::max<std::size_t>(row, 1) - 1; r <= std::min(row + 1, kRows - 1);
         ++r) {
      if (nearest_around(r, column) < range_m + margin_m) return false;
    }
    for (std::size_t below = 1; below <= std::min(row, kMostBelow); ++below) {
      const float nearest_m = nearest_around(row - below, column);
      if (nearest_m < kNothingM) return nearest_m >= range_m + margin_m;
    }
    return std::nullopt;
  }

 private:
  static constexpr std::size_t kRows = 180, kColumns = 720;  // degree, half degree
  static constexpr float kNothingM = 1e9F;

  /// In three columns.
  float nearest_around(std::size_t row, std::size_t column) const {
    const float* cells = &nearest_m_[row * kColumns];
    return std::min(
        {cells[(column + kColumns - 1) % kColumns], cells[column], cells[(column + 1) % kColumns]});
  }

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

/// Another scan, and where it is.
using Look = std::pair<RangeImage, Pose>;

std::vector<Look> looks_from(const Sequence& sequence, const std::vector<Pose>& poses,
                             std::size_t scan_index, std::span<const std::ptrdiff_t> apart) {
  std::vector<Look> looks;
  for (const std::ptrdiff_t scans : apart) {
    const std::ptrdiff_t other = static_cast<std::ptrdiff_t>(scan_index) + scans;
    if (other < 0 || other >= static_cast<std::ptrdiff_t>(sequence.size())) continue;
    const auto index = static_cast<std::size_t>(other);
    looks.emplace_back(RangeImage(sequence.read(index).points),
                       relative(poses, {index, scan_index}));
  }
  return looks;
}

Stay stay_of(const Eigen::Vector3d& point_m, const std::vector<Look>& looks) {
  Stay stay = Stay::kUnseen;
  if (!(point_m.norm() < kMostRangeM)) return stay;
  for (const auto& [image, other_from_this] : looks) {
    const auto through = image.looks_through(other_from_this * point_m);
    if (through) stay = std::max(stay, *through ? Stay::kLeaves : Stay::kStays);
  }
  return stay;
}

class LabelExamination {
 public:
  LabelExamination(const Sequence& sequence, SequenceCheckup& checkup)
      : sequence_(sequence), poses_(poses_of(sequence)), checkup_(checkup) {}

  void run() {
    examine_some(scans_with_truth(sequence_));
    if (result_.moving + result_.still == 0) examine_some(scans_with_labels(sequence_));
    result_.moving_leaves = share(moving_left_, moving_seen_);
    result_.still_leaves = share(still_left_, still_seen_);
    result_.purity = result_.moving > 0 ? purity_sum_ / static_cast<double>(result_.moving) : 0.0;
    tell();
    if (result_.moving == 0 && result_.still > 0) look_for_moving();
    checkup_.labels = result_;
  }

 private:
  void examine_some(const std::vector<std::size_t>& labelled) {
    for (const std::size_t scan_index : picked(labelled, kLabelledScans)) examine(scan_index);
  }

  void examine(std::size_t scan_index) {
    const Frame frame = sequence_.read(scan_index);
    if (!frame.truth) return;
    std::vector<std::size_t> moving, still;
    std::unordered_map<std::uint64_t, std::pair<double, double>> cubes;  // moving, all
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      const double range = range_m(frame.points[i]);
      if (((*frame.truth)[i] & 0xFFFFU) == 0 || !(range > kLeastRangeM)) continue;
      const bool moves = is_moving((*frame.truth)[i]);
      auto& [moving_in_cube, all_in_cube] = cubes[cube_key(position_of(frame.points[i]), kCubeM)];
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
    const std::vector<Look> looks = looks_from(sequence_, poses_, scan_index, kLookFrom);
    const auto count = [&](std::size_t i, std::size_t& seen, std::size_t& left) {
      const Stay stay = stay_of(position_of(points[i]), looks);
      seen += stay == Stay::kUnseen ? 0 : 1;
      left += stay == Stay::kLeaves ? 1 : 0;
    };
    for (const std::size_t i : moving) count(i, moving_seen_, moving_left_);
    const std::size_t step = std::max<std::size_t>(1, still.size() / kStillPoints);
    for (std::size_t k = 0; k < still.size(); k += step) {
      count(still[k], still_seen_, still_left_);
    }
  }

  void tell() {
    // With fewer moving points nothing is said.
    constexpr std::size_t kFewestMoving = 200;
    Facts& facts = checkup_.facts;
    facts["moving_share"] = share(result_.moving, result_.moving + result_.still);
    facts["moving_leaves"] = result_.moving_leaves;
    facts["still_leaves"] = result_.still_leaves;
    if (result_.moving == 0 || moving_seen_ < kFewestMoving) return;
    facts["purity"] = result_.purity;
    if (result_.still_leaves > 0.0) {
      facts["leaves_ratio"] = result_.moving_leaves / result_.still_leaves;
    }
  }

  /// Looks for moving labels in all scans, since those examined may have missed them.
  void look_for_moving() {
    const std::vector<std::size_t> labelled = scans_with_truth(sequence_);
    const bool none = std::ranges::none_of(labelled, [&](std::size_t scan_index) {
      return std::ranges::any_of(sequence_.read_truth(scan_index), is_moving);
    });
    if (!none) return;
    const std::size_t span = labelled.back() - labelled.front() + 1;
    checkup_.facts["scans_without_moving"] = span;
    checkup_.facts["labelled_scans"] = counted(labelled.size(), "labelled scan");
    checkup_.facts["labelled_span"] = counted(span, "scan");
  }

  const Sequence& sequence_;
  const std::vector<Pose> poses_;
  SequenceCheckup& checkup_;
  std::size_t moving_seen_ = 0, moving_left_ = 0, still_seen_ = 0, still_left_ = 0;
  double purity_sum_ = 0.0;
  LabelEvidence result_;
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

std::vector<std::size_t> scans_to_look_at(const Sequence& sequence) {
  std::vector<std::size_t> scans;  // from the middles of as many parts, with others on both sides
  for (std::size_t i = 0; i < kLabelledScans; ++i) {
    const std::size_t scan = (2 * i + 1) * sequence.size() / (2 * kLabelledScans);
    if (scan < sequence.size() && (scans.empty() || scans.back() < scan)) scans.push_back(scan);
  }
  return scans;
}

std::vector<Stay> stays_of(const Sequence& sequence, std::size_t scan_index,
                           const std::vector<Point>& points) {
  const std::vector<Look> looks =
      looks_from(sequence, poses_of(sequence), scan_index, kLookFromMore);
  std::vector<Stay> stays;
  stays.reserve(points.size());
  for (const Point& point : points) {
    const bool is_near = !(range_m(point) > kLeastRangeM);
    stays.push_back(is_near ? Stay::kUnseen : stay_of(position_of(point), looks));
  }
  return stays;
}

void examine_labels(const Sequence& sequence, SequenceCheckup& checkup) {
  LabelExamination(sequence, checkup).run();
}

}  // namespace mosbench
