#include "bench/staged_scans.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "core/methods/hmm_mos/median.hpp"
#include "core/methods/hmm_mos/otsu.hpp"
#include "core/voxel/neighbourhood.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/simulator/simulator.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
using namespace hmm_mos;
namespace {

/// What detection remembers between scans.
struct DetectionMemory {
  LocalWindow window;
  DynamicRegion region;
  VoxelSet carried;
};

void detect(StagedScan& staged, const Config& config, VoxelMap& map, DetectionMemory& detection,
            ThreadPool& pool) {
  const int width = config.kernel_width_voxels;
  const VoxelizedScan& scan = staged.scan;
  DynamicRegion& region = detection.region;
  if (scan.occupied_count == 0) {
    detection.window.join({});
    staged.labels.assign(staged.frame.points.size(), kStaticLabel);
    return;
  }
  staged.votes = votes_for(staged, map, width, pool);
  staged.filtered = median_filter(scan, staged.votes, pool);
  detection.window.join(staged.filtered);
  staged.sums = detection.window.sums(scan);
  staged.threshold = threshold_of(scan, staged.sums);
  staged.carried = std::move(detection.carried);
  staged.dynamic = dilate_occupied(
      scan,
      above_threshold(scan, staged.sums, staged.threshold, staged.carried, config.min_otsu_score),
      pool);
  detection.carried = staged.dynamic;
  staged.beside = beside_unknown_of(staged, region, map, width, pool);
  staged.from_region = region.back_end(scan, staged.beside, width, pool);
  region.update({scan, staged.dynamic, staged.from_region, staged.beside, staged.threshold},
                staged.k);
  const VoxelSet moving = shows_motion(staged.threshold, config.min_otsu_score)
                              ? united(staged.dynamic, staged.from_region)
                              : VoxelSet{};
  staged.labels = project_labels(scan, moving);
}

constexpr std::size_t kMeasuredScans = 8;
constexpr std::size_t kScans = 24;

Workload simulated(const std::string& name, const char* scene, const char* sensor,
                   double voxel_size_m, double max_range_m) {
  Workload workload{name, {}, [scene, sensor] {
                      const Simulator simulator = built_in_simulator(scene, sensor, 1);
                      std::vector<Frame> frames;
                      for (std::size_t k = 0; k < kScans; ++k) frames.push_back(simulator.frame(k));
                      return frames;
                    }};
  workload.config.voxel_size_m = voxel_size_m;
  workload.config.max_range_m = max_range_m;
  return workload;
}

}  // namespace

std::vector<Workload> simulated_workloads() {
  std::vector<Workload> workloads;
  workloads.push_back(simulated("indoor", "mall", "os1-64", 0.20, 20));
  workloads.push_back(simulated("campus", "campus", "avia", 0.25, 50));
  workloads.push_back(simulated("highway", "highway", "hdl-64e", 0.25, 120));
  return workloads;
}

Workload recorded_workload(const std::filesystem::path& folder) {
  Workload workload{"recorded", {}, {}};
  workload.config.voxel_size_m = 0.25;
  workload.config.max_range_m = 50;
  const Dataset dataset = open_dataset(folder, {});
  const Sequence& sequence = *dataset.sequences.front();
  const auto needed = static_cast<std::size_t>(workload.config.local_window_scans) + 2;
  if (sequence.size() < needed) {
    throw DataError(folder, "has " + std::to_string(sequence.size()) + " scans",
                    "at least " + std::to_string(needed) + ", so that detection runs");
  }
  std::vector<Frame> frames;
  for (std::size_t k = 0; k < std::min(kScans, sequence.size()); ++k) {
    frames.push_back(sequence.read(k));
  }
  workload.read = [frames = std::move(frames)] { return frames; };
  return workload;
}

StagedScans::StagedScans(const Workload& chosen)
    : workload(chosen),
      frames(chosen.read()),
      grid(grid_around(frames.front().map_from_sensor.translation(), chosen.config.voxel_size_m)) {
  const Config& config = workload.config;
  ThreadPool pool(1);
  RaycastScratch scratch;
  VoxelMap map(config, grid);
  DetectionMemory detection{LocalWindow(config.local_window_scans), new_region(), {}};
  Pipeline pipeline(config);
  for (const Frame& frame : frames) {
    StagedScan& staged = all.emplace_back(frame, static_cast<std::uint32_t>(all.size()));
    staged.scan = voxelize(frame.points, frame.map_from_sensor, grid, config.min_range_m,
                           config.max_range_m, pool);
    staged.observed =
        raycast(ray_sources(staged.scan, config.voxel_size_m, config.max_range_m), scratch, pool);
    staged.state_changes = voxels_of(update(map, staged, pool));
    map.evict(staged.k);
    const auto expected = std::move(pipeline.push(frame.points, frame.map_from_sensor)[0].labels);
    if (staged.k <= static_cast<std::uint32_t>(config.local_window_scans)) {
      detection.window.join({});
      continue;
    }
    detect(staged, config, map, detection, pool);
    if (staged.labels != expected) {
      throw std::logic_error("the stages of the benchmarks are out of order");
    }
  }
  const std::size_t undetected = static_cast<std::size_t>(config.local_window_scans) + 1;
  measured = std::span(all).last(std::min(kMeasuredScans, all.size() - undetected));
}

VoteField votes_for(const StagedScan& staged, VoxelMap& map, int kernel_width_voxels,
                    ThreadPool& pool) {
  const VoxelizedScan& scan = staged.scan;
  const VoxelSet changed = scan.occupied_among(map.changed_since(staged.k));
  const auto slots = slots_within(scan, changed, radius_of(kernel_width_voxels));
  const VoxelSet known = map.known_at(staged.k, blocks_of(scan, slots), pool);
  return convolve(scan, slots, changed, known, kernel_width_voxels, pool);
}

VoxelSet beside_unknown_of(const StagedScan& staged, const DynamicRegion& region, VoxelMap& map,
                           int kernel_width_voxels, ThreadPool& pool) {
  const auto slots = slots_around(staged.scan, region.blocks_with(staged.dynamic));
  const VoxelSet known = map.known_at(staged.k, blocks_of(staged.scan, slots), pool);
  return beside_unknown(staged.scan, slots, known, kernel_width_voxels, pool);
}

std::size_t voxels_of(const VoxelList& list) {
  std::size_t voxels = 0;
  for (const BlockMask& mask : list.masks) voxels += mask.count();
  return voxels;
}

VoxelList StagedScans::update(VoxelMap& map, const StagedScan& staged, ThreadPool& pool) const {
  static const VoxelSet none;
  const std::array sources{&staged.scan.measured,
                           staged.k > 0 ? &all[staged.k - 1].scan.measured : &none};
  return map.update(staged.observed, sources, staged.scan.sensor_m, staged.k, pool);
}

void StagedScans::enter(VoxelMap& map, const StagedScan& staged, ThreadPool& pool) const {
  update(map, staged, pool);
  map.evict(staged.k);
}

VoxelMap StagedScans::map_after(std::size_t scans, ThreadPool& pool) const {
  VoxelMap map(workload.config, grid);
  for (std::size_t k = 0; k < scans; ++k) enter(map, all[k], pool);
  return map;
}

void StagedScans::run_other_stages() {
  constexpr std::size_t kStride = 4;
  if (others_ % all.size() == 0) other_.emplace(workload.config);
  const Frame& frame = all[others_++ % all.size()].frame;
  std::vector<Point> some;
  for (std::size_t i = 0; i < frame.points.size(); i += kStride) some.push_back(frame.points[i]);
  other_->push(some, frame.map_from_sensor);
}

DynamicRegion StagedScans::new_region() const {
  const Config& config = workload.config;
  return {grid, config.max_range_m, config.dynamic_window_scans, config.min_otsu_score};
}

}  // namespace mosbench
