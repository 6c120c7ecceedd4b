#include "core/methods/dynablox/tracks.hpp"

#include <algorithm>
#include <tuple>

namespace mosbench::dynablox {

std::vector<Tracks::Track> Tracks::follow(const std::vector<Eigen::Vector3d>& centres_m) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < previous_m_.size(); ++i) {
    for (std::size_t j = 0; j < centres_m.size(); ++j) {
      const double distance_m = (previous_m_[i] - centres_m[j]).norm();
      if (distance_m <= max_distance_m_) pairs.emplace_back(distance_m, i, j);
    }
  }
  std::ranges::sort(pairs);
  std::vector<Track> tracks(centres_m.size());
  std::vector<bool> continued(previous_m_.size());
  for (const auto& [distance_m, i, j] : pairs) {
    if (continued[i] || tracks[j].number != 0) continue;
    continued[i] = true;
    tracks[j] = {tracks_[i].number, tracks_[i].scans + 1};
  }
  for (Track& track : tracks) {
    if (track.number == 0) track.number = ++last_number_;
  }
  previous_m_ = centres_m;
  tracks_ = tracks;
  return tracks;
}

}  // namespace mosbench::dynablox
