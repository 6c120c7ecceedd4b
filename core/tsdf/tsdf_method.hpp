#pragma once

#include <memory>
#include <mosbench/method.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/scan_method.hpp"
#include "core/base/thread_pool.hpp"
#include "core/tsdf/range_image.hpp"
#include "core/tsdf/sensor_model.hpp"
#include "core/tsdf/tsdf_map.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::tsdf {

/// The part of a scan that needs no scan before it.
struct ObservedScan final : NumberedScan {
  std::vector<Point> points;  ///< empty unless the method asks for them
  Pose map_from_sensor = Pose::Identity();
  VoxelizedScan scan;
  std::optional<SensorModel> sensor;  ///< not known while scans have too few returns to measure it
  RangeImage image;
  std::vector<BlockIndex> wide_blocks;  ///< on the rays
  std::vector<StageTime> stages;
};

/// Base of methods that judge scans by a TsdfMap, online. Here scans are observed, and the sensor
/// is measured unless it is configured; what a scan does to the map is the method's own.
class TsdfMethod : public ScanMethod<ObservedScan> {
 public:
  std::optional<MemoryUse> memory() const final;
  std::vector<std::string> remarks() const final;

 protected:
  /// Which points have voxels: those farther than this, negative for all; and whether scans keep
  /// their points.
  struct Wants {
    double nearest_m;
    bool points = false;
  };
  /// Throws std::invalid_argument for 0 threads.
  TsdfMethod(const Config& config, const RunContext& context, Wants wants);

  /// Known once a scan was observed: whole wide blocks of the map frame.
  const VoxelGrid& grid() const { return *grid_; }
  /// Integrates a scan into blocks that were touched for it; does nothing while the sensor is
  /// unknown.
  void integrate_scan(TsdfMap& map, std::span<const std::uint32_t> slots,
                      const ObservedScan& observed);

 private:
  /// Judges the next scan by the map, which it then enters. `result` has a static label per point.
  virtual void take(const ObservedScan& observed, LabelledScan& result) = 0;
  /// The map, and what the method keeps beside it.
  virtual MemoryUse map_memory() const = 0;

  std::unique_ptr<ObservedScan> see(std::span<const Point> points, const Pose& map_from_sensor,
                                    const RayOrigins& origins, ThreadPool& pool) final;
  std::vector<LabelledScan> enter(ObservedScan& scan) final;
  void cast(std::span<const Point> points, ObservedScan& observed, ThreadPool& pool);

  Config config_;
  Wants wants_;
  std::optional<VoxelGrid> grid_;  // around the first scan
  std::optional<SensorModel> sensor_;
  RayBlocksScratch scratch_;
};

}  // namespace mosbench::tsdf
