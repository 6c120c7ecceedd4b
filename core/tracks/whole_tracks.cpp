#include "core/tracks/whole_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/scan_steps.hpp"
#include "core/base/stage_clock.hpp"

namespace mosbench::tracks {
namespace {

constexpr double kLooks_s[] = {0.5, 0.8, 1.2, 1.6, 2.0, 2.5, 3.0};

std::vector<std::uint32_t> offsets_of(const ScanPeriod& period) {
  std::vector<std::uint32_t> offsets;
  for (const double seconds : kLooks_s) {
    const std::uint32_t scans = std::max(1U, period.scans(seconds));
    if (offsets.empty() || offsets.back() < scans) offsets.push_back(scans);
  }
  return offsets;
}

float share_through(std::span<const Sighting> sightings) {
  Seen seen;
  for (const Sighting& sighting : sightings) seen += sighting.seen;
  return seen.looks == 0 ? 0
                         : static_cast<float>(seen.looks_through) / static_cast<float>(seen.looks);
}

/// Assigning {} would keep the memory.
template <typename Value>
void release_memory(std::vector<Value>& values) {
  std::vector<Value>().swap(values);
}

}  // namespace

ScanPeriod::ScanPeriod(const std::vector<std::int64_t>& stamps_ns) {
  if (const auto period_ns = scan_period_ns(scan_steps_ns(stamps_ns))) period_s = *period_ns * 1e-9;
}

std::uint32_t ScanPeriod::scans(double seconds) const {
  return static_cast<std::uint32_t>(std::lround(seconds / period_s));
}

WholeTracks::WholeTracks(const WholeTracksConfig& config, std::unique_ptr<Method> proposing,
                         const RunContext& context)
    : ScanMethod(context),
      config_(config),
      proposing_(std::move(proposing)),
      period_(context.stamps_ns),
      offsets_(offsets_of(period_)),
      window_scans_(std::max(1U, period_.scans(config.window_s))),
      tracks_(period_.period_s, window_scans_) {}

std::unique_ptr<SeenScan> WholeTracks::see(std::span<const Point> points,
                                           const Pose& map_from_sensor, const RayOrigins& origins,
                                           ThreadPool&) {
  auto scan = std::make_unique<SeenScan>();
  scan->proposing = proposing_->observe(points, map_from_sensor, origins);
  const StageRecord record{scan->stages, context().cpu_times};
  const StageClock clock(record, "sight");
  scan->image = SightImage(points, config_.min_range_m, origins);
  scan->origins = origins;
  scan->map_from_sensor = map_from_sensor;
  scan->points_m.reserve(points.size());
  for (const Point& point : points) scan->points_m.emplace_back(point.x, point.y, point.z);
  return scan;
}

std::vector<LabelledScan> WholeTracks::enter(SeenScan& scan) {
  std::vector<LabelledScan> proposals = proposing_->push(std::move(scan.proposing));
  if (k() == 0) origin_m_ = scan.map_from_sensor.translation();
  HeldScan& current = held_.emplace_back();
  current.points = scan.points_m.size();
  current.seen = std::move(scan);
  take_proposals(std::move(proposals));
  while (looked_ < proposed_ && looked_ + offsets_.back() <= k()) look_at_next();
  return release_due(false);
}

std::vector<LabelledScan> WholeTracks::release() {
  take_proposals(proposing_->finish());
  while (looked_ < proposed_) look_at_next();
  return release_due(true);
}

void WholeTracks::take_proposals(std::vector<LabelledScan> labelled) {
  for (LabelledScan& result : labelled) {
    HeldScan& scan = held(proposed_++);
    for (const std::uint32_t label : result.labels) {
      scan.proposed.push_back(label == kMovingLabel ? 1 : 0);
    }
    scan.result.scan_index = result.scan_index;
    scan.result.nonfinite_points = result.nonfinite_points;
    scan.result.stages = std::move(result.stages);
    std::ranges::move(scan.seen.stages, std::back_inserter(scan.result.stages));
  }
}

std::vector<Look> WholeTracks::looks_at(std::uint32_t scan) {
  const Pose map_from_here = held(scan).seen.map_from_sensor;
  const auto end = first_held_ + static_cast<std::uint32_t>(held_.size());
  std::vector<Look> looks;
  const auto add = [&](std::uint32_t other, bool before) {
    const SeenScan& there = held(other).seen;
    looks.push_back(
        {&there.image, (there.map_from_sensor.inverse() * map_from_here).cast<float>(), before});
  };
  for (const std::uint32_t offset : offsets_) {
    if (scan >= first_held_ + offset) add(scan - offset, true);
  }
  for (const std::uint32_t offset : offsets_) {
    if (scan + offset < end) add(scan + offset, false);
  }
  return looks;
}

void WholeTracks::look_at_next() {
  const std::uint32_t scan = looked_++;
  HeldScan& current = held(scan);
  const StageRecord record{current.result.stages, context().cpu_times};
  {
    const StageClock clock(record, "looks");
    const Eigen::Isometry3d here(Eigen::Translation3d(-origin_m_) * current.seen.map_from_sensor);
    const Eigen::Isometry3f map_from_sensor = here.cast<float>();
    std::vector<Eigen::Vector3f> positions_m;
    positions_m.reserve(current.points);
    for (const Eigen::Vector3f& point : current.seen.points_m) {
      positions_m.push_back(map_from_sensor * point);
    }
    const std::vector<Look> looks = looks_at(scan);
    current.clusters =
        find_clusters({current.seen.points_m, positions_m, current.proposed, config_.min_range_m,
                       config_.max_range_m, current.seen.origins},
                      looks, pool());
    current.result.judged = !looks.empty();
  }
  const StageClock clock(record, "tracks");
  current.tracks = tracks_.enter(scan, current.clusters);
  release_memory(current.seen.points_m);
  release_memory(current.seen.origins.of_point);
  release_memory(current.proposed);
  for (Cluster& cluster : current.clusters) release_memory(cluster.cells);
  const std::uint32_t reach = offsets_.back();
  if (scan >= first_held_ + reach) held(scan - reach).seen.image = SightImage();
}

bool WholeTracks::is_due(const HeldScan& front) const {
  if (first_held_ + offsets_.back() >= looked_) return false;  // its ranges are needed
  if (first_held_ + window_scans_ < looked_) return true;
  return std::ranges::all_of(front.tracks, [&](const std::shared_ptr<Track>& track) {
    return tracks_.is_closed(*ObjectTracks::whole(track));
  });
}

std::vector<LabelledScan> WholeTracks::release_due(bool all) {
  std::vector<LabelledScan> labelled;
  while (!held_.empty() && (all || is_due(held_.front()))) {
    labelled.push_back(judged(held_.front()));
    held_.pop_front();
    ++first_held_;
  }
  return labelled;
}

LabelledScan WholeTracks::judged(HeldScan& scan) {
  LabelledScan result = std::move(scan.result);
  result.labels.assign(scan.points, kStaticLabel);
  if (context().scores) {
    result.scores.assign(scan.points, 0);
    result.reasons.assign(scan.points, Reason::kNone);
    result.objects.assign(scan.points, 0);
  }
  for (std::size_t i = 0; i < scan.clusters.size(); ++i) {
    const Cluster& cluster = scan.clusters[i];
    const std::shared_ptr<Track> track = ObjectTracks::whole(scan.tracks[i]);
    const std::vector<Sighting>& sightings = track->sightings;
    if (track->number == 0) track->number = ++numbered_;
    const bool moving = moves(sightings, period_.period_s);
    const float score = context().scores ? share_through(sightings) : 0;
    for (std::size_t j = 0; j < cluster.points.size(); ++j) {
      const std::uint32_t point = cluster.points[j];
      if (moving) result.labels[point] = kMovingLabel;
      if (!context().scores) continue;
      result.scores[point] = score;
      result.objects[point] = track->number;
      if (moving) result.reasons[point] = cluster.reasons[j];
    }
  }
  return result;
}

std::optional<MemoryUse> WholeTracks::memory() const {
  MemoryUse use = proposing_->memory().value_or(MemoryUse{});
  for (const HeldScan& scan : held_) {
    use.bytes += scan.seen.image.memory_bytes() + scan.proposed.capacity() +
                 scan.seen.points_m.capacity() * sizeof(Eigen::Vector3f);
    for (const Cluster& cluster : scan.clusters) {
      use.bytes += cluster.points.capacity() * (sizeof(std::uint32_t) + sizeof(Reason)) +
                   sizeof(Cluster) + sizeof(Sighting);
    }
  }
  return use;
}

}  // namespace mosbench::tracks
