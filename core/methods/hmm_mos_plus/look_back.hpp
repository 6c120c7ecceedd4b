#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>

#include "core/base/thread_pool.hpp"
#include "core/methods/hmm_mos_plus/arrivals.hpp"
#include "core/methods/hmm_mos_plus/block_memory.hpp"
#include "core/methods/hmm_mos_plus/config.hpp"
#include "core/methods/hmm_mos_plus/ground.hpp"
#include "core/methods/hmm_mos_plus/tick_clock.hpp"
#include "core/methods/hmm_mos_plus/tracks.hpp"

namespace mosbench::hmm_mos_plus {

/// The objects that moved some scans ago, as their departures tell by now. An object that moves
/// away from the sensor arrives where nothing was known to be free.
class LookBack {
 public:
  explicit LookBack(const Config& config);

  /// Takes in scan k, whose classes know nothing of predictions, and looks back from it, with the
  /// map as it is after it.
  void enter(const VoxelizedScan& scan, const ArrivalClasses& classes,
             std::shared_ptr<const Ground> ground, const Tick& tick, const RememberedMap& map,
             ThreadPool& pool);
  /// Predicts, as Tracks does, where in the scan entered last is what moved before.
  void add_seeds(const VoxelizedScan& scan, LowVoxels& low, ArrivalClasses& classes) const;
  std::size_t memory_bytes() const;

 private:
  void look(const RememberedMap& map, ThreadPool& pool);

  struct Past {
    VoxelizedScan scan;  ///< without settled voxels
    ArrivalClasses classes;
    std::shared_ptr<const Ground> ground;
    Tick tick;
  };

  Config config_;
  Tracks tracks_;
  std::deque<Past> past_;  // the scan entered last is the last one
};

}  // namespace mosbench::hmm_mos_plus
