#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "bench/workloads.hpp"
#include "core/convolution.hpp"
#include "core/dynamic_region.hpp"
#include "core/local_window.hpp"
#include "core/raycast.hpp"
#include "core/voxel_map.hpp"

namespace mosbench {

/// The last scan of a workload with what goes into and comes out of each of its stages. The stages
/// are run in the order of the pipeline, online, paper-2024.
struct StagedScan {
  /// Throws std::logic_error when the labels differ from those of Pipeline.
  StagedScan(const Workload& workload, ThreadPool& pool);

  const Workload& workload;
  VoxelGrid grid;
  VoxelMap map;  ///< after this scan
  std::uint32_t k = 0;
  VoxelizedScan previous, scan;
  VoxelList previous_observed, observed;
  VoxelSet changed;
  ScoreField scores, filtered;
  LocalWindow window;
  SumField sums;
  std::optional<double> threshold;
  VoxelSet carried, dynamic, beside, from_region, moving;
  DynamicRegion region;
  std::vector<std::uint32_t> labels;

 private:
  void observe(const Frame& frame, RaycastScratch& scratch, ThreadPool& pool);
  void detect(ThreadPool& pool);
};

}  // namespace mosbench
