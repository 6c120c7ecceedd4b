#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "core/methods/hmm_mos/config.hpp"
#include "core/methods/hmm_mos/detector.hpp"
#include "core/methods/hmm_mos/mapped_method.hpp"

namespace mosbench::hmm_mos {

/// The whole method (paper, III). Scores are L^dyn of a point's voxel, which Otsu's T is compared
/// with; 0 outside the map and in scans that are not judged.
class Pipeline final : public MappedMethod {
 public:
  /// With a scan_count a delayed run labels its last scans as the authors' program does; without it
  /// they are static. Throws std::invalid_argument as `check` does, and for 0 threads.
  explicit Pipeline(const Config& config, const RunContext& context = {});

  std::vector<std::string> remarks() const override;

 private:
  /// A scan whose labels are not final yet.
  struct HeldScan {
    VoxelizedScan scan;
    LabelledScan result;
  };

  std::vector<LabelledScan> entered(ObservedScan& current) override;
  std::vector<LabelledScan> release_all() override { return release(held_.size()); }
  std::size_t held_bytes() const override;
  void judge(HeldScan& held);
  std::vector<LabelledScan> release(std::size_t count);

  Config config_;
  std::optional<Detector> detector_;
  std::deque<HeldScan> held_;  // the last delay + 1 scans, current one last
};

/// Describes how the end of a delayed sequence is labelled; empty when online or of unknown length.
std::vector<std::string> remarks_on_delay(const Config& config, const RunContext& context);

}  // namespace mosbench::hmm_mos
