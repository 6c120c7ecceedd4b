#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mosbench/method.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/base/push_order.hpp"
#include "core/base/thread_pool.hpp"
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

/// The method up to its map (paper, III): finds the voxels of scans and lets them enter in order.
class Mapping {
 public:
  /// Throws std::invalid_argument for 0 threads.
  Mapping(const Config& config, const RunContext& context);

  /// Lets the map tell this of its blocks, from the first scan on.
  void tell(BlockObserver& observer) { observer_ = &observer; }

  /// Finds P'_M and P'_obs, which need no earlier scan, with all threads. Throws as
  /// Method::observe.
  std::unique_ptr<ObservedScan> observe(std::span<const Point> points, const Pose& map_from_sensor);
  /// The same while another thread lets the previous scan enter: with half of the threads.
  std::unique_ptr<ObservedScan> observe_ahead(std::span<const Point> points,
                                              const Pose& map_from_sensor);

  /// Throws std::logic_error when no further scan may enter.
  void expect_scan() const { order_.expect_scan(); }
  /// Updates beliefs x and states S of observed voxels; voxels out of range or unobserved for w_g
  /// leave. Returns the scan with the stages appended. Throws as Method::push.
  ObservedScan& enter(Observed* observed);
  /// No scan may enter after this.
  void finish() { order_.finish(); }

  /// Are there once a scan has entered, k being its index.
  std::uint32_t k() const { return static_cast<std::uint32_t>(order_.pushed() - 1); }
  VoxelMap& map() { return *map_; }
  const VoxelGrid& grid() const { return *grid_; }
  ThreadPool& pool() { return pool_; }
  const RunContext& context() const { return context_; }
  std::size_t map_blocks() const { return map_ ? map_->block_count() : 0; }
  std::size_t memory_bytes() const;

 private:
  std::unique_ptr<ObservedScan> observe(std::span<const Point> points, const Pose& map_from_sensor,
                                        ThreadPool& observing);

  Config config_;
  RunContext context_;
  PushOrder order_;
  BlockObserver* observer_ = nullptr;
  ThreadPool pool_;
  std::optional<ThreadPool> observing_pool_;  // for scans observed during a push
  std::optional<VoxelGrid> grid_;             // around the first scan
  RaycastScratch scratch_;
  std::optional<VoxelMap> map_;
  VoxelSet previous_measured_;
};

/// A method that judges scans with the map of HMM-MOS. Here scans are observed and enter the map;
/// what happens then is the method's own.
class MappedMethod : public Method {
 public:
  std::unique_ptr<Observed> observe(std::span<const Point> points,
                                    const Pose& map_from_sensor) final {
    return mapping_->observe_ahead(points, map_from_sensor);
  }
  std::vector<LabelledScan> push(std::unique_ptr<Observed> observed) final {
    return entered(mapping_->enter(observed.get()));
  }
  std::vector<LabelledScan> push(std::span<const Point> points, const Pose& map_from_sensor) final {
    mapping_->expect_scan();
    return push(mapping_->observe(points, map_from_sensor));
  }
  std::vector<LabelledScan> finish() final {
    mapping_->finish();
    return release_all();
  }
  std::optional<MemoryUse> memory() const final {
    return MemoryUse{mapping_->memory_bytes() + held_bytes(), mapping_->map_blocks()};
  }

 protected:
  /// Throws std::invalid_argument for 0 threads.
  MappedMethod(const Config& config, const RunContext& context)
      : mapping_(std::make_unique<Mapping>(config, context)) {}

  Mapping& mapping() { return *mapping_; }
  const RunContext& context() const { return mapping_->context(); }

 private:
  /// Returns the scans whose labels became final when `current` entered the map.
  virtual std::vector<LabelledScan> entered(ObservedScan& current) = 0;
  virtual std::vector<LabelledScan> release_all() = 0;
  /// What the method keeps beside the map.
  virtual std::size_t held_bytes() const = 0;

  std::unique_ptr<Mapping> mapping_;
};

/// Returns what is known of a scan before it is judged. Takes its stages away.
inline LabelledScan begun_result(ObservedScan& scan, std::size_t k) {
  LabelledScan result;
  result.scan_index = k;
  result.nonfinite_points = scan.scan.nonfinite_points;
  result.stages = std::move(scan.stages);
  return result;
}

}  // namespace mosbench::hmm_mos
