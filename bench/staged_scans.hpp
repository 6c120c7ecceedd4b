#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/methods/hmm_mos/config.hpp"
#include "core/methods/hmm_mos/convolution.hpp"
#include "core/methods/hmm_mos/dynamic_region.hpp"
#include "core/methods/hmm_mos/pipeline.hpp"
#include "core/methods/hmm_mos/voxel_map.hpp"
#include "core/voxel/raycast.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {
using namespace hmm_mos;

/// Scans to measure on, with the configuration that segments them.
struct Workload {
  std::string name;
  Config config;
  std::function<std::vector<Frame>()> read;  ///< takes long
};

/// Simulated: `indoor` (hand-held OS1-64, 20 m), `campus` (robot with a Livox Avia, 50 m) and
/// `highway` (car with an HDL-64E, 120 m).
std::vector<Workload> simulated_workloads();

/// The first scans of a recording, at 0.25 m and 50 m. Throws DataError and UsageError.
Workload recorded_workload(const std::filesystem::path& folder);

std::size_t voxels_of(const VoxelList& list);

/// A scan with the inputs and outputs of each of its stages without memory.
struct StagedScan {
  StagedScan(const Frame& read, std::uint32_t index) : frame(read), k(index) {}

  const Frame& frame;
  std::uint32_t k;
  VoxelizedScan scan;
  VoxelList observed;
  std::size_t state_changes = 0;  ///< voxels
  VoteField votes, filtered;
  SumField sums;
  std::optional<double> threshold;
  VoxelSet carried, dynamic, beside, from_region;
  std::vector<std::uint32_t> labels;
};

/// Returns the votes for the voxels of a scan that was just entered into the map.
VoteField votes_for(const StagedScan& staged, VoxelMap& map, int kernel_width_voxels,
                    ThreadPool& pool);

/// Returns the voxels beside unknown ones, where the region asks for them.
VoxelSet beside_unknown_of(const StagedScan& staged, const DynamicRegion& region, VoxelMap& map,
                           int kernel_width_voxels, ThreadPool& pool);

/// The scans of a workload, put through the stages in the order of the pipeline, online,
/// paper-2024.
class StagedScans {
 public:
  /// Throws std::logic_error when the labels differ from those of Pipeline.
  explicit StagedScans(const Workload& workload);
  StagedScans(const StagedScans&) = delete;
  StagedScans& operator=(const StagedScans&) = delete;

  const Workload& workload;
  const std::vector<Frame> frames;
  const VoxelGrid grid;
  std::vector<StagedScan> all;
  /// The scans that stages are measured on: several, because one alone would stay in the caches and
  /// be memorised by the branch predictor.
  std::span<const StagedScan> measured;

  const StagedScan& last() const { return all.back(); }
  const StagedScan& last_but_one() const { return all[all.size() - 2]; }

  /// Puts a scan into a map that holds the scans before it. Returns the voxels that changed.
  VoxelList update(VoxelMap& map, const StagedScan& staged, ThreadPool& pool) const;
  /// The same; then voxels that are too far or too old leave the map.
  void enter(VoxelMap& map, const StagedScan& staged, ThreadPool& pool) const;
  /// Returns a map that holds the first `scans`.
  VoxelMap map_after(std::size_t scans, ThreadPool& pool) const;
  DynamicRegion new_region() const;

  /// Brings caches and branch predictor into about the state they have between two calls of a stage
  /// in the pipeline, by running a separate pipeline on some points of a scan.
  void run_other_stages();

 private:
  std::optional<Pipeline> other_;
  std::size_t others_ = 0;  ///< scans pushed into it and its predecessors
};

}  // namespace mosbench
