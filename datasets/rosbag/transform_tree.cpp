#include "datasets/rosbag/transform_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "datasets/text/errors.hpp"
#include "datasets/text/numbers.hpp"

namespace mosbench {
namespace {

std::string extent_of(const PoseTrack& track) {
  if (track.first_ns() == track.last_ns())
    return fmt::format("at {:.3f} s alone", seconds_of(track.first_ns()));
  return fmt::format("from {:.3f} to {:.3f} s", seconds_of(track.first_ns()),
                     seconds_of(track.last_ns()));
}

using StampedPoses = std::vector<std::pair<std::int64_t, Pose>>;

double apart_m(const Pose& a, const Pose& b) {
  constexpr double kReach_m = 10.0;
  const Pose change = a.inverse() * b;
  return change.translation().norm() + kReach_m * Eigen::AngleAxisd(change.linear()).angle();
}

/// Returns how far apart the poses are that two publishers give one frame: fixed poses that differ,
/// or poses that go back and forth with every step, which no smooth way and no noise does. Else 0.
double publishers_apart_m(StampedPoses poses, bool always) {
  constexpr double kLeast_m = 0.1;
  if (always) {
    const double most_m = apart_m(poses.front().second, poses.back().second);
    return most_m > 1e-3 ? most_m : 0.0;
  }
  constexpr std::size_t kFewest = 10;
  if (poses.size() < kFewest) return 0.0;
  std::ranges::stable_sort(poses, {}, &StampedPoses::value_type::first);
  std::vector<Eigen::Vector3d> steps_m;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    steps_m.push_back(poses[i].second.translation() - poses[i - 1].second.translation());
  }
  std::vector<double> turns_m;
  std::size_t turns = 0;
  for (std::size_t i = 1; i < steps_m.size(); ++i) {
    const Eigen::Vector3d turn_m = 0.5 * (steps_m[i] - steps_m[i - 1]);
    if (i > 1) turns += turn_m.dot(steps_m[i - 1] - steps_m[i - 2]) < 0.0;
    turns_m.push_back(turn_m.norm());
  }
  if (10 * turns < 9 * (turns_m.size() - 1)) return 0.0;
  const double usual_m = quantile(std::move(turns_m), 0.5, QuantileRule::kUpper);
  return usual_m > kLeast_m ? usual_m : 0.0;
}

}  // namespace

std::optional<Pose> TransformChain::at(std::int64_t stamp_ns) const {
  std::optional<Pose> product;
  for (const Link& link : links_) {
    const std::optional<Pose> pose = link.track.at(stamp_ns);
    if (!pose || link.track.has_hole(stamp_ns, stamp_ns, most_gap_ns_)) return std::nullopt;
    product = product ? Pose(*product * *pose) : *pose;
  }
  return product ? product : Pose::Identity();
}

bool TransformChain::covers(std::int64_t from_ns, std::int64_t to_ns) const {
  return std::ranges::all_of(links_, [&](const Link& link) {
    return link.track.covers(from_ns, to_ns) && !link.track.has_hole(from_ns, to_ns, most_gap_ns_);
  });
}

bool TransformChain::moves() const {
  return std::ranges::any_of(links_, [](const Link& link) { return link.track.moves(); });
}

std::string TransformChain::lacks(std::int64_t stamp_ns) const {
  for (const Link& link : links_) {
    if (!link.track.covers(stamp_ns, stamp_ns)) {
      return fmt::format("{} is known {}", link.name, extent_of(link.track));
    }
    if (link.track.has_hole(stamp_ns, stamp_ns, most_gap_ns_)) {
      return fmt::format("{} has holes of more than {:g} s", link.name, seconds_of(most_gap_ns_));
    }
  }
  return "";
}

TransformTree::TransformTree(const std::vector<StampedTransform>& transforms,
                             const std::vector<StampedTransform>& always,
                             const std::filesystem::path& file)
    : file_(file) {
  const auto add = [&](const std::vector<StampedTransform>& source, bool holds_always) {
    std::map<Edge, std::vector<std::pair<std::int64_t, Pose>>> poses_of;
    for (const StampedTransform& transform : source) {
      poses_of[{transform.child, transform.parent}].emplace_back(transform.stamp_ns,
                                                                 transform.parent_from_child);
    }
    for (auto& [edge, poses] : poses_of) {
      PoseTrack& track = parents_of_[edge.first][edge.second];
      if (track.moves()) continue;
      if (const double apart_m = publishers_apart_m(poses, holds_always); apart_m > 0.0) {
        doubts_of_[edge] = fmt::format(
            "{} from {} is told in two ways that are {:.2f} m apart{}", edge.second, edge.first,
            apart_m,
            holds_always ? ": the last is taken" : ", in turns: two nodes seem to send it");
      }
      // tf2 keeps the last.
      if (holds_always) poses.erase(poses.begin(), std::prev(poses.end()));
      track = PoseTrack(std::move(poses), holds_always);
    }
  };
  add(transforms, false);
  add(always, true);
}

std::vector<std::string> TransformTree::way(const std::string& from, const std::string& to) const {
  std::map<std::string, std::string> below = {{from, ""}};
  std::deque<std::string> open = {from};
  while (!open.empty() && !below.contains(to)) {
    const auto parents = parents_of_.find(open.front());
    if (parents != parents_of_.end()) {
      for (const auto& [parent, track] : parents->second) {
        if (below.emplace(parent, open.front()).second) open.push_back(parent);
      }
    }
    open.pop_front();
  }
  std::vector<std::string> frames;
  if (!below.contains(to)) return frames;
  for (std::string frame = to; frame != from; frame = below.at(frame)) frames.push_back(frame);
  frames.push_back(from);
  std::ranges::reverse(frames);
  return frames;
}

bool TransformTree::moves_above(const std::string& child, const std::string& parent,
                                std::set<std::string> seen) const {
  if (parents_of_.at(child).at(parent).moves()) return true;
  const auto above = parents_of_.find(parent);
  if (above == parents_of_.end() || !seen.insert(parent).second) return false;
  return std::ranges::any_of(
      above->second, [&](const auto& next) { return moves_above(parent, next.first, seen); });
}

std::vector<std::string> TransformTree::ancestors(const std::string& from) const {
  std::vector<std::string> frames = {from};
  for (auto parents = parents_of_.find(from);
       frames.back() != "map" && parents != parents_of_.end();
       parents = parents_of_.find(frames.back())) {
    std::vector<std::string> moving;
    for (const auto& [above, track] : parents->second) {
      if (moves_above(frames.back(), above, {frames.back()})) moving.push_back(above);
    }
    if (parents->second.size() > 1 && moving.size() != 1) {
      throw DataError(file_,
                      "frame " + frames.back() + " has the parents " +
                          parents->second.begin()->first + " and " +
                          std::next(parents->second.begin())->first,
                      "one, or the map's frame in " + option("map_frame"));
    }
    const std::string parent = moving.size() == 1 ? moving.front() : parents->second.begin()->first;
    // Parents may form a loop in a damaged bag.
    if (std::ranges::find(frames, parent) != frames.end()) break;
    frames.push_back(parent);
  }
  return frames;
}

TransformChain TransformTree::chain(const std::vector<std::string>& way, double max_gap_s) const {
  TransformChain chain;
  chain.most_gap_ns_ = std::llround(std::min(max_gap_s * 1e9, 9e18));
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    chain.links_.insert(chain.links_.begin(),
                        {way[i + 1] + " from " + way[i], parents_of_.at(way[i]).at(way[i + 1])});
    const auto doubt = doubts_of_.find({way[i], way[i + 1]});
    if (doubt != doubts_of_.end()) chain.doubts_.push_back(doubt->second);
  }
  return chain;
}

}  // namespace mosbench
