#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/methods/hmm_mos_plus/arrivals.hpp"
#include "core/methods/hmm_mos_plus/block_history.hpp"
#include "core/methods/hmm_mos_plus/config.hpp"
#include "core/methods/hmm_mos_plus/ground.hpp"
#include "core/methods/hmm_mos_plus/objects.hpp"

namespace mosbench::hmm_mos_plus {

/// The objects that moved in a scan, followed from scan to scan.
class Tracks {
 public:
  explicit Tracks(const Config& config);

  /// Predicts what was followed over min_track_steps: its voxels, moved on by its last step, are
  /// fresh seeds of a later scan where they are occupied, not standing and not low. The step is
  /// corrected along x and y, but never turned by a right angle, to the one that finds most of
  /// these. One below half a voxel along all axes is none. `tick` has the periods since the scan
  /// followed.
  void add_seeds(const VoxelizedScan& scan, LowVoxels& low, const Tick& tick,
                 ArrivalClasses& classes) const;
  /// Makes the components that move in the scan those of the last one. Each is the next step of the
  /// one that comes nearest when moved on, if that is near enough. Sets its steady steps.
  void follow(const VoxelizedScan& scan, std::vector<Component>& components, const Tick& tick);
  std::size_t memory_bytes() const;

 private:
  using Vector = std::array<double, 3>;

  /// Lengths in voxels.
  struct Track {
    Vector centre{};
    Vector velocity{};     ///< per period of the scans
    int steps = 0;         ///< over which it was followed
    int steady_steps = 0;  ///< the last ones, of like velocity
    std::vector<Voxel> voxels;
  };

  /// Null when no track comes near enough.
  const Track* nearest_to(const Vector& centre, const Tick& tick) const;

  int min_steps_;
  double max_error_voxels_s_;
  std::vector<Track> tracks_;
};

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
