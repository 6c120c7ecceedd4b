#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <vector>

#include "core/methods/hmm_mos/mapping.hpp"
#include "core/methods/hmm_mos_plus/arrivals.hpp"
#include "core/methods/hmm_mos_plus/attachments.hpp"
#include "core/methods/hmm_mos_plus/config.hpp"
#include "core/methods/hmm_mos_plus/tracks.hpp"

namespace mosbench::hmm_mos_plus {

/// Objects that arrive in space known to be free, on the map of the paper's method; the
/// idea is in docs/methods/hmm_mos_plus.md. Scores are the share of seeds in the component of a
/// point's voxel, 0 elsewhere and for what was cut off an object; a threshold is compared with
/// them, but decides not alone. Every scan is judged but the first of an online run. A delayed run
/// judges the last scans of a sequence with its last map.
class Pipeline final : public hmm_mos::MappedMethod {
 public:
  /// Throws std::invalid_argument as `check` does, and for 0 threads.
  explicit Pipeline(const Config& config, const RunContext& context = {});

  std::vector<std::string> remarks() const override;

 private:
  /// A scan whose labels are not final yet.
  struct HeldScan {
    VoxelizedScan scan;
    ArrivalClasses classes;
    LabelledScan result;
    Tick tick;
  };

  std::vector<LabelledScan> entered(hmm_mos::ObservedScan& current, LabelledScan begun) override;
  std::vector<LabelledScan> release() override { return release(held_.size()); }
  std::size_t held_bytes() const override;
  RememberedMap remembered();
  void judge(HeldScan& held);
  std::vector<LabelledScan> release(std::size_t count);

  bool predicts() const { return config_.map.delay_scans == 0 && config_.min_track_steps > 0; }

  Config config_;
  Tracks tracks_;       // of the last scan judged, when it predicts
  LookBack look_back_;  // the same
  Attachments attachments_;
  BlockMemory memory_;         // of the map
  std::deque<HeldScan> held_;  // the last delay + 1 scans, current one last
};

}  // namespace mosbench::hmm_mos_plus
