#pragma once

#include <cstddef>
#include <memory>
#include <mosbench/method.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/base/scan_method.hpp"
#include "core/methods/hmm_mos/config.hpp"
#include "core/methods/hmm_mos/voxel_map.hpp"
#include "core/voxel/raycast.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

/// A scan that is ready to enter the map.
struct ObservedScan final : NumberedScan {
  VoxelizedScan scan;
  VoxelList observed;  ///< by its rays
  std::vector<StageTime> stages;
};

/// The method up to its map (paper, III): finds the voxels P'_M and P'_obs of scans, which then
/// enter the map. How scans are judged by it is the derived method's own.
class MappedMethod : public ScanMethod<ObservedScan> {
 public:
  std::optional<MemoryUse> memory() const final;

 protected:
  /// Throws std::invalid_argument for 0 threads.
  MappedMethod(const Config& config, const RunContext& context)
      : ScanMethod(context), config_(config) {}

  /// Lets the map tell this of its blocks, from the first scan on.
  void tell(BlockObserver& observer) { observer_ = &observer; }

  /// Are there once a scan has entered.
  VoxelMap& map() { return *map_; }
  const VoxelGrid& grid() const { return *grid_; }

 private:
  /// Returns the scans whose labels became final when `current` entered the map. `begun` is what is
  /// known of it before it is judged, with the stages so far.
  virtual std::vector<LabelledScan> entered(ObservedScan& current, LabelledScan begun) = 0;
  /// What the method keeps beside the map.
  virtual std::size_t held_bytes() const = 0;

  std::unique_ptr<ObservedScan> see(std::span<const Point> points, const Pose& map_from_sensor,
                                    const RayOrigins& origins, ThreadPool& pool) final;
  /// Updates beliefs x and states S of observed voxels; voxels out of range or unobserved for w_g
  /// leave.
  std::vector<LabelledScan> enter(ObservedScan& current) final;

  Config config_;
  BlockObserver* observer_ = nullptr;
  std::optional<VoxelGrid> grid_;  // around the first scan
  RaycastScratch scratch_;
  std::optional<VoxelMap> map_;
  VoxelSet previous_measured_;
};

}  // namespace mosbench::hmm_mos
