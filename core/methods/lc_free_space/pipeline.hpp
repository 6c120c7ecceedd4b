#pragma once

#include <mosbench/method.hpp>
#include <span>
#include <vector>

#include "core/methods/lc_free_space/config.hpp"
#include "core/tsdf/tsdf_method.hpp"

namespace mosbench::lc_free_space {

/// LC Free Space, a row of the tables of Dynablox (Schmid et al., RA-L 2023), which cites Modayil
/// and Kuipers, Robotics and Autonomous Systems 56, 2008: readings that fall into free space are
/// dynamic. Our reading, as no code was published: a point of scan k moves when its voxel, in the
/// truncated signed distances that Dynablox makes of the scans before, was observed (w > 1e-6) and
/// is farther than theta from a surface (d > theta). There is no burn-in, no neighbourhood and no
/// memory of what was free; "LC" is low confidence. With level=cluster, points of voxels that share
/// a face with such a one move, too, as in Dynablox's clusters, without its least size. Online.
/// Memory is bounded: the map is kept within map_radius_ranges. Scores are d, metres, 0 where it
/// was not observed; at the level of points, those above theta move.
class Pipeline final : public tsdf::TsdfMethod {
 public:
  /// Throws std::invalid_argument as `check` does, and for 0 threads.
  explicit Pipeline(const Config& config, const RunContext& context = {});

 private:
  void take(const tsdf::ObservedScan& observed, LabelledScan& result) override;
  MemoryUse map_memory() const override;

  void label(const VoxelizedScan& scan, LabelledScan& result);
  void score(const VoxelizedScan& scan, LabelledScan& result);

  Config config_;
  tsdf::TsdfMap map_;
};

}  // namespace mosbench::lc_free_space
