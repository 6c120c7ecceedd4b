#include "bench/staged_scan.hpp"

#include <stdexcept>
#include <utility>

#include "core/label_projection.hpp"
#include "core/median.hpp"
#include "core/pipeline.hpp"
#include "core/selection.hpp"

namespace mosbench {

StagedScan::StagedScan(const Workload& chosen, ThreadPool& pool)
    : workload(chosen),
      grid(grid_around(chosen.frames.front().map_from_sensor.translation(),
                       chosen.config.voxel_size_m)),
      map(chosen.config, Variant::kPaper2024, grid),
      window(chosen.config.local_window_scans),
      region(grid, chosen.config.max_range_m, chosen.config.dynamic_window_scans,
             chosen.config.min_otsu_score) {
  RaycastScratch scratch;
  Pipeline pipeline(workload.config, Variant::kPaper2024);
  std::vector<std::uint32_t> expected;
  for (const Frame& frame : workload.frames) {
    observe(frame, scratch, pool);
    if (k <= static_cast<std::uint32_t>(workload.config.local_window_scans)) {
      window.join({});
    } else {
      detect(pool);
    }
    expected = std::move(pipeline.push(frame.points, frame.map_from_sensor)[0].labels);
    ++k;
  }
  --k;
  if (labels != expected) throw std::logic_error("the stages of the benchmarks are out of order");
}

void StagedScan::observe(const Frame& frame, RaycastScratch& scratch, ThreadPool& pool) {
  const Config& config = workload.config;
  previous = std::move(scan);
  previous_observed = std::move(observed);
  scan = voxelize(frame.points, frame.map_from_sensor, grid, config.min_range_m, config.max_range_m,
                  pool);
  observed = raycast(scan.measured, scan.sensor_voxel, config.voxel_size_m, config.max_range_m,
                     scratch, pool);
  const std::vector<const VoxelSet*> sources{&scan.measured, &previous.measured};
  map.update(observed, sources, scan.sensor_m, k, pool);
  map.evict(k);
}

void StagedScan::detect(ThreadPool& pool) {
  const Config& config = workload.config;
  const int width = config.kernel_width_voxels;
  changed = map.changed_since(k);
  scores = convolve(scan, changed, width, map, k, pool);
  filtered = median_filter(scan, scores, pool);
  window.join(filtered);
  sums = window.sums(scan);
  threshold = threshold_of(scan, sums);
  carried = std::move(dynamic);
  dynamic = select_dynamic(scan, sums, threshold, carried, config.min_otsu_score);
  beside = beside_unknown(scan, region.blocks(), dynamic.blocks, width, map, k, pool);
  from_region = region.back_end(scan, beside, width, pool);
  region.update({scan, dynamic, from_region, beside, threshold}, k);
  moving =
      shows_motion(threshold, config.min_otsu_score) ? united(dynamic, from_region) : VoxelSet{};
  labels = project_labels(scan, moving);
}

}  // namespace mosbench
