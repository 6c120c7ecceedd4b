#include "datasets/sequence/pose_track.hpp"

#include <algorithm>
#include <utility>

namespace mosbench {

PoseTrack::PoseTrack(std::vector<std::pair<std::int64_t, Pose>> poses, bool always)
    : poses_(std::move(poses)), always_(always) {
  const auto stamp = [](const auto& stamped) { return stamped.first; };
  std::ranges::stable_sort(poses_, {}, stamp);
  // clang 14 does not compile std::ranges::unique of libstdc++ 12.
  poses_.erase(std::unique(poses_.begin(), poses_.end(),
                           [&](const auto& a, const auto& b) { return stamp(a) == stamp(b); }),
               poses_.end());
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

}  // namespace mosbench
