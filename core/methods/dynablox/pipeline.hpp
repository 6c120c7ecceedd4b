#pragma once

#include <mosbench/method.hpp>
#include <span>
#include <vector>

#include "core/methods/dynablox/clusters.hpp"
#include "core/methods/dynablox/config.hpp"
#include "core/methods/dynablox/ever_free.hpp"
#include "core/tsdf/tsdf_method.hpp"

namespace mosbench::dynablox {

/// Schmid, Andersson, Sulser, Pfreundschuh, Siegwart: Dynablox, RA-L 2023, in the order of the
/// authors' program: points of scan k are judged by the map of the scans before, then the ever-free
/// voxels are brought up to date, then the scan enters the map. Online. Scores are the distance of
/// the point's voxel to the nearest surface, metres, tau more where it is ever-free, 0 where it was
/// not observed; no threshold is compared with them. With level=object, objects are the tracks.
class Pipeline final : public tsdf::TsdfMethod {
 public:
  /// Throws std::invalid_argument as `check` does, and for 0 threads.
  explicit Pipeline(const Config& config, const RunContext& context = {});

 private:
  void take(const tsdf::ObservedScan& observed, LabelledScan& result) override;
  MemoryUse map_memory() const override;

  void label_objects(const tsdf::ObservedScan& observed, std::span<const BlockMask> ever_free,
                     LabelledScan& result);
  std::vector<float> scores(const tsdf::ObservedScan& observed) const;

  Config config_;
  EverFreeMap map_;
  Tracks tracks_;
};

}  // namespace mosbench::dynablox
