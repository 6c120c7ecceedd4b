#pragma once

#include <deque>
#include <string>
#include <vector>

#include "core/base/sequential_method.hpp"
#include "core/methods/underwood/config.hpp"
#include "core/voxel/directions.hpp"

namespace mosbench::underwood {

/// Compares each scan with scans before it, and with one after it when delayed. Scores are margins
/// in metres: that which min_votes references see past the point. Scans without a reference are not
/// judged; the last ones of a delayed run are compared with earlier ones alone.
class Pipeline final : public SequentialMethod {
 public:
  /// Throws std::invalid_argument as `check` does, and for 0 threads.
  explicit Pipeline(const Config& config, const RunContext& context = {});

  /// Keeps the last n * references + d scans.
  std::optional<MemoryUse> memory() const override;
  std::vector<std::string> remarks() const override { return angle_.remarks(); }

 private:
  struct HeldScan {
    PosedScan scan;
    std::vector<Direction> directions;  ///< as its own sensor sees its points
    LabelledScan result;
  };

  std::vector<LabelledScan> take(PosedScan& scan, LabelledScan result) override;
  std::vector<LabelledScan> release() override;
  void judge(std::size_t place);
  std::vector<const HeldScan*> references_of(std::size_t place) const;

  Config config_;
  NeighbourAngle angle_;
  std::deque<HeldScan> held_;   ///< the newest last
  std::size_t unreleased_ = 0;  ///< of them, the newest
};

}  // namespace mosbench::underwood
