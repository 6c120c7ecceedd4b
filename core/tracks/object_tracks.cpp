#include "core/tracks/object_tracks.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace mosbench::tracks {
namespace {

constexpr double kSpeed_m_s = 10, kMostStep_m = 2;
constexpr double kShift_m = 1.5, kSoftShift_m = 0.5;
constexpr double kBeyondAnyVehicle_m = 10;  // what comes into view shifts by its own length at most
constexpr double kShort_s = 0.5;

double share(std::uint32_t part, std::uint32_t all) {
  return all == 0 ? 0 : static_cast<double>(part) / all;
}

/// How far a straight line through some places, fitted over time, leads.
double shift_m(std::span<const Sighting> sightings) {
  struct Place {
    double weight = 0;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  };
  std::map<std::uint32_t, Place> places;
  for (const Sighting& sighting : sightings) {
    Place& place = places[sighting.scan];
    place.weight += sighting.seen.points;
    place.sum += sighting.seen.points * sighting.median_m.cast<double>();
  }
  if (places.size() < 3) return 0;
  const double first = places.begin()->first, last = places.rbegin()->first;
  double mean_scan = 0;
  for (const auto& [scan, place] : places) mean_scan += scan;
  mean_scan /= static_cast<double>(places.size());
  double spread = 0;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  for (const auto& [scan, place] : places) {
    spread += (scan - mean_scan) * (scan - mean_scan);
    slope += (scan - mean_scan) * place.sum / place.weight;
  }
  return (slope / spread).norm() * (last - first);
}

/// How many scans a track was seen in.
std::size_t scans_of(std::span<const Sighting> sightings) {
  std::vector<std::uint32_t> scans;
  for (const Sighting& sighting : sightings) scans.push_back(sighting.scan);
  std::ranges::sort(scans);
  return static_cast<std::size_t>(std::unique(scans.begin(), scans.end()) - scans.begin());
}

int distance2(const Cell& a, const Cell& b) {
  return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

}  // namespace

bool moves(std::span<const Sighting> sightings, double period_s) {
  Seen seen;
  for (const Sighting& sighting : sightings) seen += sighting.seen;
  const double before = share(seen.through_before, seen.judged_before);
  const double after = share(seen.through_after, seen.judged_after);
  const auto hardly = [&](double through, std::uint32_t judged) {
    return through < 0.1 && 10.0 * judged >= 3.0 * seen.points;
  };
  const double most = std::max(before, after), gone_m = shift_m(sightings);
  if (gone_m >= kBeyondAnyVehicle_m && most >= 0.5) return true;
  if (hardly(before, seen.judged_before) || hardly(after, seen.judged_after)) return false;
  if (gone_m >= kShift_m && most >= 0.2) return true;
  if (share(seen.looks_through, seen.looks) < 0.5) return false;
  const std::size_t scans = scans_of(sightings);
  const bool is_short = scans < 3 || static_cast<double>(scans) * period_s < kShort_s;
  return (is_short && most >= 0.3) || (gone_m >= kSoftShift_m && most >= 0.5);
}

std::shared_ptr<Track> ObjectTracks::whole(std::shared_ptr<Track> track) {
  while (track->merged_into_) track = track->merged_into_;
  return track;
}

ObjectTracks::Open ObjectTracks::open_of(std::uint32_t scan, const Cluster& cluster) {
  Open open{.scan = scan,
            .cells = cluster.cells,
            .low = cluster.cells.front(),
            .high = cluster.cells.front(),
            .track = nullptr};
  for (const Cell& cell : cluster.cells) {
    open.low = {std::min(open.low.x, cell.x), std::min(open.low.y, cell.y)};
    open.high = {std::max(open.high.x, cell.x), std::max(open.high.y, cell.y)};
  }
  return open;
}

std::optional<std::size_t> ObjectTracks::nearest(const Open& from,
                                                 std::span<const Open> candidates) const {
  const double reach_cells =
      std::min(kSpeed_m_s * period_s_, kMostStep_m) * (last_scan_ - from.scan) / kCell_m;
  std::optional<std::size_t> best;
  double least = reach_cells * reach_cells;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Open& to = candidates[i];
    if (to.low.x - from.high.x > reach_cells || from.low.x - to.high.x > reach_cells ||
        to.low.y - from.high.y > reach_cells || from.low.y - to.high.y > reach_cells) {
      continue;
    }
    int nearest = std::numeric_limits<int>::max();
    for (const Cell& a : from.cells) {
      for (const Cell& b : to.cells) nearest = std::min(nearest, distance2(a, b));
    }
    if (nearest < least) {
      least = nearest;
      best = i;
    }
  }
  return best;
}

void ObjectTracks::merge(const std::shared_ptr<Track>& track, const std::shared_ptr<Track>& into) {
  const std::shared_ptr<Track> part = whole(track), all = whole(into);
  if (part == all) return;
  all->sightings.insert(all->sightings.end(), part->sightings.begin(), part->sightings.end());
  all->last_scan = std::max(all->last_scan, part->last_scan);
  std::vector<Sighting>().swap(part->sightings);
  part->merged_into_ = all;
}

std::vector<std::shared_ptr<Track>> ObjectTracks::enter(std::uint32_t scan,
                                                        std::span<const Cluster> clusters) {
  last_scan_ = scan;
  std::vector<Open> opened;
  std::vector<std::shared_ptr<Track>> tracks;
  for (const Cluster& cluster : clusters) {
    auto track = std::make_shared<Track>();
    track->last_scan = scan;
    track->sightings.push_back({scan, cluster.median_m, cluster.seen});
    opened.push_back(open_of(scan, cluster));
    opened.back().track = track;
    tracks.push_back(std::move(track));
  }
  for (std::vector<Open>& earlier : recent_) {
    for (Open& from : earlier) {
      if (from.goes_on) continue;
      const auto found = nearest(from, opened);
      if (!found) continue;
      from.goes_on = true;
      merge(opened[*found].track, from.track);
    }
  }
  for (const std::shared_ptr<Track>& track : tracks) {
    std::erase_if(whole(track)->sightings,
                  [&](const Sighting& sighting) { return sighting.scan + window_scans_ < scan; });
  }
  recent_.push_back(std::move(opened));
  if (recent_.size() > kScans) recent_.pop_front();
  return tracks;
}

}  // namespace mosbench::tracks
