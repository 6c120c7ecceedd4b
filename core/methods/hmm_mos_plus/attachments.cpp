#include "core/methods/hmm_mos_plus/attachments.hpp"

#include <algorithm>

#include "core/voxel/neighbourhood.hpp"

namespace mosbench::hmm_mos_plus {
namespace {

/// Voxels that are so near are joined: beams leave gaps.
constexpr double kReach_m = 0.6;
constexpr std::uint32_t kSeenTicks = 10;
/// An object that moves arrived by this share or more. The rest came into view or is one with what
/// it touches.
constexpr double kArrivedShare = 0.8;
/// What has been near for so long leaves voxels behind when it moves, a tenth as many as it has.
constexpr std::uint32_t kLeavesTicks = 2;
constexpr double kLeftShare = 0.1;
/// Limits for what left fewer: settled voxels beside it per voxel, and the share that arrived.
constexpr double kStayingSettledShare = 0.05, kStayingArrivedShare = 0.9;
/// What is new, or left nothing behind, and arrived by less came into view.
constexpr double kNewArrivedShare = 0.3;
/// A flat thing is seen to be so by more than this share of what arrived.
constexpr double kOpenShare = 0.2;

/// What was followed at a steady velocity over so many steps is no part of what stands.
constexpr int kSteadySteps = 2;

VoxelSet voxels_of(const VoxelizedScan& scan, const Component& component) {
  VoxelSet voxels;
  for (const std::uint32_t voxel : component.voxels) {
    const std::uint32_t slot = voxels.insert(scan.measured.blocks[voxel / kBlockVoxels]);
    voxels.masks[slot].set(voxel % kBlockVoxels);
  }
  return voxels;
}

bool are_within(int reach, const Box& a, const Box& b) {
  return a.low.x - b.high.x <= reach && b.low.x - a.high.x <= reach &&
         a.low.y - b.high.y <= reach && b.low.y - a.high.y <= reach &&
         a.low.z - b.high.z <= reach && b.low.z - a.high.z <= reach;
}

Box united(const Box& a, const Box& b) {
  return {
      {std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y), std::min(a.low.z, b.low.z)},
      {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y), std::max(a.high.z, b.high.z)}};
}

/// Counts the voxels in a box that were left since a second before the tick `at`.
std::size_t left_in(const Box& box, std::uint32_t at_tick, const RememberedMap& map) {
  std::size_t count = 0;
  const BlockIndex low = block_of(box.low), high = block_of(box.high);
  for (BlockIndex at = low; at.z <= high.z; ++at.z) {
    for (at.y = low.y; at.y <= high.y; ++at.y) {
      for (at.x = low.x; at.x <= high.x; ++at.x) {
        const auto past = map.past_at(at);
        if (!past) continue;
        const std::uint32_t ticks =
            std::min(kSeenTicks + past->tick - at_tick, BlockHistory::kMaxAgeTicks);
        for_each_cell(past->history.left_within(past->known.free, ticks, past->tick),
                      [&](std::uint32_t cell) {
                        const Voxel v = voxel_at(at, cell);
                        const Box own{v, v};
                        count += are_within(0, box, own) ? 1U : 0U;
                      });
      }
    }
  }
  return count;
}

}  // namespace

Attachments::Attachments(const Config& config)
    : reach_(std::min(static_cast<int>(kReach_m / config.map.voxel_size_m), kMaxHalo)),
      max_settled_share_(config.max_settled_share),
      min_voxels_(static_cast<std::size_t>(config.min_seeds_voxels)) {}

Attachments::Seen Attachments::look_at(const VoxelizedScan& scan, const ArrivalClasses& classes,
                                       LowVoxels& low, const Component& component) const {
  Seen seen{.box = box_of(scan, component.voxels), .voxels = component.voxels.size()};
  const VoxelSet voxels = voxels_of(scan, component);
  for (const std::uint32_t slot : slots_within(scan, voxels, reach_)) {
    const BlockIndex& block = scan.measured.blocks[slot];
    const BlockMask* own = voxels.mask_of(block);
    if (own != nullptr) {
      const BlockMask arrived = *own & classes.arrived[slot];
      seen.arrived += arrived.count();
      seen.open += (arrived & classes.open[slot]).count();
    }
    BlockMask beside = without(classes.settled[slot], low.in(slot));
    if (own != nullptr) beside = without(beside, *own);
    if (!beside.any()) continue;
    HaloRows rows;
    gather_around(voxels, block, reach_, rows);
    seen.settled += (dilate(rows) & beside).count();
  }
  return seen;
}

Attachments::Near Attachments::near(const Seen& component) const {
  Near near{.box = component.box, .since = component.at};
  for (const Seen& seen : seen_) {
    if (!are_within(reach_, seen.box, component.box)) continue;
    near.box = united(near.box, seen.box);
    near.voxels += static_cast<double>(seen.voxels);
    near.arrived += static_cast<double>(seen.arrived);
    near.settled += static_cast<double>(seen.settled);
    near.since = std::min(near.since, seen.at);
  }
  return near;
}

bool Attachments::is_attached(const Seen& component, const RememberedMap& map) const {
  const Near all = near(component);
  if (all.settled > max_settled_share_ * all.voxels && all.arrived < kArrivedShare * all.voxels) {
    return true;
  }
  const bool stays = all.settled > kStayingSettledShare * all.voxels
                         ? all.arrived < kStayingArrivedShare * all.voxels
                         : all.arrived < kNewArrivedShare * all.voxels;
  return component.at - all.since >= kLeavesTicks && stays &&
         static_cast<double>(left_in(all.box, component.at, map)) <
             kLeftShare * static_cast<double>(component.voxels);
}

/// Whether nothing was near before that tells more. In the beginning everything comes into view.
bool Attachments::is_doubtful(const Seen& component) const {
  const auto arrived = static_cast<double>(component.arrived);
  const bool came_into_view = arrived < kNewArrivedShare * static_cast<double>(component.voxels) ||
                              component.voxels < min_voxels_;
  return came_into_view && component.at >= BlockHistory::kSettledTicks &&
         std::ranges::none_of(seen_, [&](const Seen& seen) {
           return seen.at != component.at && are_within(reach_, seen.box, component.box);
         });
}

/// Whether it is one voxel high, as was all that lay near, and this is no gap between beams.
bool Attachments::is_flat(const Seen& component) const {
  const std::int32_t z = component.box.low.z;
  return static_cast<double>(component.open) >
             kOpenShare * static_cast<double>(component.arrived) &&
         std::ranges::all_of(seen_, [&](const Seen& seen) {
           return (seen.box.low.z == z && seen.box.high.z == z) ||
                  !are_within(reach_, seen.box, component.box);
         });
}

void Attachments::judge(const VoxelizedScan& scan, const ArrivalClasses& classes, LowVoxels& low,
                        std::uint32_t at, const RememberedMap& map,
                        std::vector<Component>& components) {
  while (!seen_.empty() && at - seen_.front().at > kSeenTicks) seen_.pop_front();
  const std::size_t before = seen_.size();
  for (const Component& component : components) {
    if (!component.moves) continue;
    seen_.push_back(look_at(scan, classes, low, component));
    seen_.back().at = at;
  }
  std::size_t next = before;
  for (Component& component : components) {
    if (!component.moves) continue;
    const Seen& seen = seen_[next++];
    const bool stands = is_attached(seen, map) || is_doubtful(seen) || is_flat(seen);
    component.moves = component.steady_steps >= kSteadySteps || !stands;
  }
}

}  // namespace mosbench::hmm_mos_plus
