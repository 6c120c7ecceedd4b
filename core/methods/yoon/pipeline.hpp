#pragma once

#include <deque>
#include <string>
#include <vector>

#include "core/base/scan_method.hpp"
#include "core/methods/yoon/config.hpp"
#include "core/voxel/directions.hpp"

namespace mosbench::yoon {

/// Our reading of the method, whose authors published no code: points of scan k in space that scan
/// k - n sees past, far from everything in it, filtered on the image of the scan, and grown to
/// objects. Scans are expected to be free of the sensor's own motion. Scores are the residuals in
/// metres of points in free space, and of those alone; seeds are above the threshold, but the
/// later steps decide, too. The first n scans are not judged.
class Pipeline final : public SequentialMethod {
 public:
  /// Throws std::invalid_argument as `check` does, and for 0 threads.
  explicit Pipeline(const Config& config, const RunContext& context = {});

  /// Keeps the last n scans.
  std::optional<MemoryUse> memory() const override;
  std::vector<std::string> remarks() const override { return angle_.remarks(); }

 private:
  struct PastScan {
    PosedScan scan;
    std::vector<Direction> directions;  ///< as its own sensor sees its points
  };

  std::vector<LabelledScan> take(PosedScan& scan, LabelledScan result) override;
  void judge(const PosedScan& scan, const std::vector<Direction>& own, const PastScan& reference,
             LabelledScan& result);

  Config config_;
  NeighbourAngle angle_;
  std::deque<PastScan> past_;  ///< the newest last
};

}  // namespace mosbench::yoon
