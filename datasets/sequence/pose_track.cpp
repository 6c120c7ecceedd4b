#include "datasets/sequence/pose_track.hpp"

#include <algorithm>
#include <cstdlib>

namespace mosbench {

PoseTrack::PoseTrack(std::vector<std::pair<std::int64_t, Pose>> poses, bool always)
    : poses_(std::move(poses)), always_(always) {
  const auto stamp = [](const auto& stamped) { return stamped.first; };
  std::ranges::stable_sort(poses_, {}, stamp);
  // clang 14 does not compile std::ranges::unique of libstdc++ 12.
  poses_.erase(std::unique(poses_.begin(), poses_.end(),
                           [&](const auto& a, const auto& b) { return stamp(a) == stamp(b); }),
               poses_.end());
  std::vector<std::int64_t> steps_ns;
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    steps_ns.push_back(poses_[i].first - poses_[i - 1].first);
  }
  const auto middle = steps_ns.begin() + static_cast<std::ptrdiff_t>(steps_ns.size() / 2);
  std::nth_element(steps_ns.begin(), middle, steps_ns.end());
  if (!steps_ns.empty()) usual_step_ns_ = *middle;
}

bool PoseTrack::moves() const {
  return std::ranges::any_of(poses_, [&](const auto& stamped) {
    return stamped.second.matrix() != poses_.front().second.matrix();
  });
}

bool PoseTrack::has_hole(std::int64_t from_ns, std::int64_t to_ns, std::int64_t most_ns) const {
  if (always_ || !covers(from_ns, to_ns)) return false;
  const auto is_hole = [&](const auto& before, const auto& after) {
    constexpr double kStill_m = 0.1, kStill_rad = 0.0175;
    const std::int64_t step_ns = after.first - before.first;
    if (step_ns <= most_ns || before.second.matrix() == after.second.matrix()) return false;
    const Pose change = before.second.inverse() * after.second;
    const bool is_small = change.translation().norm() <= kStill_m &&
                          Eigen::AngleAxisd(change.linear()).angle() <= kStill_rad;
    return !is_small || step_ns / 3 > usual_step_ns_;
  };
  for (auto after = not_before(from_ns); after != poses_.end(); ++after) {
    const bool is_within = after->first > from_ns && after != poses_.begin();
    if (is_within && is_hole(*std::prev(after), *after)) return true;
    if (after->first >= to_ns) break;
  }
  return false;
}

bool PoseTrack::covers(std::int64_t from_ns, std::int64_t to_ns) const {
  if (poses_.empty()) return false;
  return always_ || (first_ns() <= from_ns && to_ns <= last_ns());
}

PoseTrack::Stamped::const_iterator PoseTrack::not_before(std::int64_t stamp_ns) const {
  return std::ranges::lower_bound(poses_, stamp_ns, {},
                                  [](const auto& stamped) { return stamped.first; });
}

std::int64_t PoseTrack::gap_ns(std::int64_t stamp_ns) const {
  if (always_ || !covers(stamp_ns, stamp_ns)) return 0;
  const auto after = not_before(stamp_ns);
  return after->first == stamp_ns ? 0 : after->first - std::prev(after)->first;
}

std::optional<Pose> PoseTrack::near(std::int64_t stamp_ns, std::int64_t most_ns) const {
  const auto after = not_before(stamp_ns);
  auto nearest = after;
  if (after == poses_.end() ||
      (after != poses_.begin() && stamp_ns - std::prev(after)->first < after->first - stamp_ns)) {
    if (poses_.empty()) return std::nullopt;
    nearest = std::prev(after);
  }
  if (std::abs(nearest->first - stamp_ns) > most_ns) return std::nullopt;
  return nearest->second;
}

std::optional<Pose> PoseTrack::at(std::int64_t stamp_ns) const {
  if (!covers(stamp_ns, stamp_ns)) return std::nullopt;
  if (always_) return poses_.front().second;
  const auto after = not_before(stamp_ns);
  if (after->first == stamp_ns) return after->second;
  const auto& [before_ns, before] = *std::prev(after);
  const double share =
      static_cast<double>(stamp_ns - before_ns) / static_cast<double>(after->first - before_ns);
  const Eigen::Quaterniond from(before.linear());
  const Eigen::Quaterniond to(after->second.linear());
  Pose pose = Pose::Identity();
  pose.linear() = from.slerp(share, to).normalized().toRotationMatrix();
  pose.translation() =
      before.translation() + share * (after->second.translation() - before.translation());
  return pose;
}

ScanTracks::ScanTracks(const std::vector<std::pair<std::int64_t, Pose>>& scans) {
  for (auto begin = scans.begin(), end = begin; begin != scans.end(); begin = end) {
    do {
      ++end;
    } while (end != scans.end() && end->first > std::prev(end)->first);
    track_of_.insert(track_of_.end(), static_cast<std::size_t>(end - begin), tracks_.size());
    tracks_.emplace_back(std::vector(begin, end));
  }
}

}  // namespace mosbench
