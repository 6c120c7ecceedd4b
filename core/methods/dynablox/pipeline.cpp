#include "core/methods/dynablox/pipeline.hpp"

#include <stdexcept>

#include "core/base/method_row.hpp"
#include "core/base/stage_clock.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::dynablox {

using tsdf::ObservedScan;

Pipeline::Pipeline(const Config& config, const RunContext& context)
    : TsdfMethod(
          checked(config), context,
          {.nearest_m = config.missing_returns == MissingReturns::kKeep ? -1.0 : config.min_range_m,
           .points = config.level == Level::kObject}),  // for the centres of objects
      config_(config),
      map_(config.occupied_below_m()),
      tracks_(config.max_tracking_distance_m) {}

void Pipeline::label_objects(const ObservedScan& observed, std::span<const BlockMask> ever_free,
                             LabelledScan& result) {
  const Clusters found = find_clusters(observed.scan, ever_free, grid(), config_);
  std::vector<Eigen::Vector3d> centres_m(found.clusters.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < found.of_point.size(); ++i) {
    if (found.of_point[i] == kNoCluster) continue;
    const Point& p = observed.points[i];
    centres_m[found.of_point[i]] += Eigen::Vector3d(p.x, p.y, p.z);
  }
  for (std::size_t i = 0; i < centres_m.size(); ++i) {
    centres_m[i] =
        observed.map_from_sensor * (centres_m[i] / static_cast<double>(found.clusters[i].points));
  }
  const std::vector<Tracks::Track> followed = tracks_.follow(centres_m);
  result.objects.assign(result.labels.size(), 0);
  for (std::size_t i = 0; i < found.of_point.size(); ++i) {
    if (found.of_point[i] == kNoCluster) continue;
    const Tracks::Track& track = followed[found.of_point[i]];
    if (track.scans < static_cast<std::uint32_t>(config_.min_track_scans)) continue;
    result.labels[i] = kMovingLabel;
    result.objects[i] = track.number;
  }
}

std::vector<float> Pipeline::scores(const ObservedScan& observed) const {
  const VoxelizedScan& scan = observed.scan;
  std::vector<const tsdf::MapBlock*> blocks;
  std::vector<BlockMask> ever_free;
  for (const BlockIndex& index : scan.measured.blocks) {
    blocks.push_back(map_.tsdf.find(index));
    ever_free.push_back(map_.ever_free_in(index));
  }
  return project_scores(scan, [&](std::uint32_t slot, std::uint32_t cell) {
    return map_.tsdf.distance_m(blocks[slot], cell) +
           (ever_free[slot].test(cell) ? config_.truncation_m() : 0.0F);
  });
}

void Pipeline::take(const ObservedScan& observed, LabelledScan& result) {
  const auto frame = static_cast<std::int32_t>(result.scan_index + 1);
  const VoxelSet& measured = observed.scan.measured;
  const StageRecord record{result.stages, context().cpu_times};
  timed(record, "clusters", [&] {
    std::vector<BlockMask> ever_free;
    for (std::size_t slot = 0; slot < measured.block_count(); ++slot) {
      ever_free.push_back(map_.ever_free_in(measured.blocks[slot]) & measured.masks[slot]);
    }
    if (context().scores) result.scores = scores(observed);
    if (config_.level == Level::kPoint) {
      result.labels = project_labels(observed.scan, ever_free);
    } else {
      label_objects(observed, ever_free, result);
    }
  });
  timed(record, "ever_free", [&] { update_ever_free(map_, measured, frame, config_, pool()); });
  timed(record, "integrate", [&] {
    const bool starts_now = config_.initial_last_occupied == InitialLastOccupied::kNow;
    map_.touch(observed.wide_blocks, starts_now ? frame : 0);
    integrate_scan(map_.tsdf, map_.touched, observed);
    map_.add_voxels(config_.counter_to_reset_scans);
  });
  timed(record, "evict", [&] { map_.keep_near(observed.scan.sensor_m, grid(), config_); });
}

MemoryUse Pipeline::map_memory() const { return {map_.memory_bytes(), map_.tsdf.blocks.size()}; }

void check(const Config& config) {
  check_ranges(config);
  tsdf::check_common(config);
  if (config.occupied_below_voxels > config.truncation_voxels) {
    throw std::invalid_argument(
        "occupied_below_voxels: above truncation_voxels, which no distance exceeds, expected "
        "occupied <= truncation");
  }
}

/// "dynablox": objects in space that was free for long.
MethodKind method_kind() {
  return {.name = "dynablox",
          .title = "Dynablox",
          .source =
              "Schmid, Andersson, Sulser, Pfreundschuh, Siegwart: Dynablox: Real-time Detection of "
              "Diverse Dynamic Objects in Complex Environments, RA-L 2023, arXiv:2304.10049",
          .summary = "clusters of points in space that a volumetric map has seen free for long",
          .defaults = settings_of(Config{}),
          .check = check_settings<Config>,
          .make = make_method<Pipeline, Config>,
          .score_name = "distance to surfaces (tau more if ever-free), m"};
}

}  // namespace mosbench::dynablox
