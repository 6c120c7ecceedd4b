#pragma once

#include <optional>
#include <vector>

#include "core/base/scan_method.hpp"
#include "core/base/stage_clock.hpp"
#include "core/methods/dufomap/config.hpp"
#include "core/methods/dufomap/seen_space.hpp"
#include "core/voxel/block_map.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::dufomap {

/// Points move where space was void in any scan: a voxel that was void once stays so. A point's own
/// scan never finds its voxel void, so it does not matter whether it enters before or after. Scores
/// are 1 where space was void, else 0. Online, voxels farther than two ranges from the sensor are
/// forgotten and the first scan is not judged; `final` keeps all and labels every scan at the end.
class Pipeline final : public SequentialMethod {
 public:
  /// Throws std::invalid_argument as `check` does, and for 0 threads.
  explicit Pipeline(const Config& config, const RunContext& context = {});

  std::optional<MemoryUse> memory() const override;

 private:
  struct HeldScan {
    VoxelizedScan scan;
    LabelledScan result;
  };

  std::vector<LabelledScan> take(PosedScan& scan, LabelledScan result) override;
  std::vector<LabelledScan> release() override;
  void add_voids(const VoxelizedScan& scan, const StageRecord& record);
  void judge(const VoxelizedScan& scan, LabelledScan& result) const;
  void forget(const VoxelizedScan& scan);

  Config config_;
  std::optional<VoxelGrid> grid_;  ///< around the first scan
  SightScratch scratch_;
  BlockMap<BlockMask> ever_void_;
  std::vector<HeldScan> held_;  ///< all scans when judged at the end
};

}  // namespace mosbench::dufomap
