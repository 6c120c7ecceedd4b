#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "core/methods/hmm_mos_plus/arrivals.hpp"
#include "core/methods/hmm_mos_plus/config.hpp"
#include "core/methods/hmm_mos_plus/ground.hpp"
#include "core/methods/hmm_mos_plus/objects.hpp"

namespace mosbench::hmm_mos_plus {

/// Tells what is part of a surface that has been standing: it lies beside settled voxels, and much
/// of it did not arrive. Parts of a parked car that come into view are seen one after the other, so
/// it sums what lay near in the last second. What is new and came into view, or is small, waits for
/// a second scan. What leaves nothing behind needs less beside it, or nothing where little of it
/// arrived. What is seen to be flat is the edge of something that stands, between two beams.
class Attachments {
 public:
  explicit Attachments(const Config& config);

  /// Lets the components not move that are part of what stands. `at` is the tick of the scan, the
  /// map is that of this scan or a later one.
  void judge(const VoxelizedScan& scan, const ArrivalClasses& classes, LowVoxels& low,
             std::uint32_t at, const RememberedMap& map, std::vector<Component>& components);
  std::size_t memory_bytes() const { return seen_.size() * sizeof(Seen); }

 private:
  /// A component that passed all other tests.
  struct Seen {
    Box box;
    std::size_t voxels = 0;
    std::size_t arrived = 0;  ///< of these
    std::size_t open = 0;     ///< arrived, seen through straight above or below
    std::size_t settled = 0;  ///< beside these, not low
    std::uint32_t at = 0;
  };

  /// What lay near a component in the last second, itself included.
  struct Near {
    Box box;
    double voxels = 0, arrived = 0, settled = 0;
    std::uint32_t since = 0;
  };

  Seen look_at(const VoxelizedScan& scan, const ArrivalClasses& classes, LowVoxels& low,
               const Component& component) const;
  Near near(const Seen& component) const;
  bool is_attached(const Seen& component, const RememberedMap& map) const;
  bool is_doubtful(const Seen& component) const;
  bool is_flat(const Seen& component) const;

  int reach_;  // voxels
  double max_settled_share_;
  std::size_t min_voxels_;  // of what is new
  std::deque<Seen> seen_;   // of the last second
};

}  // namespace mosbench::hmm_mos_plus
