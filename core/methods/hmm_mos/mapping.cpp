#include "core/methods/hmm_mos/mapping.hpp"

#include <algorithm>

#include "core/base/push_order.hpp"
#include "core/base/stage_clock.hpp"

namespace mosbench::hmm_mos {

Mapping::Mapping(const Config& config, const RunContext& context)
    : config_(config),
      context_(checked(context)),
      order_(context.scan_count),
      pool_(context.threads) {}

std::unique_ptr<ObservedScan> Mapping::observe(std::span<const Point> points,
                                               const Pose& map_from_sensor) {
  return observe(points, map_from_sensor, pool_);
}

std::unique_ptr<ObservedScan> Mapping::observe_ahead(std::span<const Point> points,
                                                     const Pose& map_from_sensor) {
  // The other half of the threads pushes the previous scan.
  if (!observing_pool_) observing_pool_.emplace(std::max(1U, pool_.size() / 2));
  return observe(points, map_from_sensor, *observing_pool_);
}

std::unique_ptr<ObservedScan> Mapping::observe(std::span<const Point> points,
                                               const Pose& map_from_sensor, ThreadPool& observing) {
  check_rigid(map_from_sensor);
  auto current = std::make_unique<ObservedScan>();
  const StageRecord record{current->stages, context_.cpu_times};
  const VoxelGrid around =
      grid_ ? *grid_ : grid_around(map_from_sensor.translation(), config_.voxel_size_m);
  current->scan = timed(record, "voxelize", [&] {
    return voxelize(points, map_from_sensor, around, config_.min_range_m, config_.max_range_m,
                    observing);
  });
  if (!grid_) grid_ = around;  // written once: the previous scan may be pushed meanwhile
  current->observed = timed(record, "raycast", [&] {
    return raycast(current->scan.measured, current->scan.sensor_voxel, config_.voxel_size_m,
                   config_.max_range_m, scratch_, observing);
  });
  order_.number(*current);
  return current;
}

ObservedScan& Mapping::enter(Observed* observed) {
  auto& current = order_.take<ObservedScan>(observed);
  const VoxelizedScan& scan = current.scan;
  const StageRecord record{current.stages, context_.cpu_times};
  if (!map_) map_.emplace(config_, *grid_, observer_);
  {
    const StageClock clock(record, "map_update");
    std::vector<const VoxelSet*> sources{&scan.measured};
    if (config_.distance_field_scans == 2) sources.push_back(&previous_measured_);
    map_->update(current.observed, sources, scan.sensor_m, k(), pool_);
  }
  {
    const StageClock clock(record, "evict");
    map_->evict(k());
  }
  previous_measured_ = scan.measured;
  return current;
}

std::size_t Mapping::memory_bytes() const {
  if (!map_) return 0;
  return scratch_.memory_bytes() + previous_measured_.memory_bytes() + map_->memory_bytes();
}

}  // namespace mosbench::hmm_mos
