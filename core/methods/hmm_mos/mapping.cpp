#include "core/methods/hmm_mos/mapping.hpp"

#include <utility>

#include "core/base/stage_clock.hpp"

namespace mosbench::hmm_mos {

std::unique_ptr<ObservedScan> MappedMethod::see(std::span<const Point> points,
                                                const Pose& map_from_sensor,
                                                const RayOrigins& origins, ThreadPool& pool) {
  auto current = std::make_unique<ObservedScan>();
  const StageRecord record{current->stages, context().cpu_times};
  const VoxelGrid around =
      grid_ ? *grid_ : grid_around(map_from_sensor.translation(), config_.voxel_size_m);
  current->scan = timed(record, "voxelize", [&] {
    return voxelize(points, map_from_sensor, around, config_.min_range_m, config_.max_range_m, pool,
                    origins);
  });
  if (!grid_) grid_ = around;  // written once: the previous scan may be pushed meanwhile
  current->observed = timed(record, "raycast", [&] {
    return raycast(ray_sources(current->scan, config_.voxel_size_m, config_.max_range_m), scratch_,
                   pool);
  });
  return current;
}

std::vector<LabelledScan> MappedMethod::enter(ObservedScan& current) {
  const VoxelizedScan& scan = current.scan;
  const StageRecord record{current.stages, context().cpu_times};
  if (!map_) map_.emplace(config_, *grid_, observer_);
  {
    const StageClock clock(record, "map_update");
    for (const OwnVoxels& own : scan.by_origin) {
      map_->expect_rays_from((own.sensor_m - scan.sensor_m).norm());
    }
    std::vector<const VoxelSet*> sources{&scan.measured};
    if (config_.distance_field_scans == 2) sources.push_back(&previous_measured_);
    map_->update(current.observed, sources, scan.sensor_m, k(), pool());
  }
  {
    const StageClock clock(record, "evict");
    map_->evict(k());
  }
  previous_measured_ = scan.measured;
  LabelledScan begun;
  begun.scan_index = k();
  begun.nonfinite_points = scan.nonfinite_points;
  begun.stages = std::move(current.stages);
  return entered(current, std::move(begun));
}

std::optional<MemoryUse> MappedMethod::memory() const {
  if (!map_) return MemoryUse{held_bytes(), 0};
  return MemoryUse{scratch_.memory_bytes() + previous_measured_.memory_bytes() +
                       map_->memory_bytes() + held_bytes(),
                   map_->block_count()};
}

}  // namespace mosbench::hmm_mos
