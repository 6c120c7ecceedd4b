#include "core/methods/hmm_mos_plus/block_history.hpp"

#include <algorithm>

namespace mosbench::hmm_mos_plus {
namespace {

/// Turns are pruned before their age is beyond what 8 bits hold: it is below kMaxAgeTicks and
/// this at an update, and grows by kMaxAgeTicks until `within` takes none for young.
constexpr std::uint32_t kPruneTicks = 50;
static_assert(2 * BlockHistory::kMaxAgeTicks + kPruneTicks < 256);

}  // namespace

void BlockHistory::update(const BlockMask& observed, const hmm_mos::BlockStates& before,
                          const hmm_mos::BlockStates& after, const Tick& tick) {
  if (!(arrived_ | left_).any()) {
    pruned_ = tick.at;
  } else if (tick.at - pruned_ >= kPruneTicks) {
    arrived_ = within(arrived_, kMaxAgeTicks, tick.at);
    left_ = within(left_, kMaxAgeTicks, tick.at);
    sure_ = sure_ & arrived_;
    pruned_ = tick.at;
  }
  updated_ = tick.at;
  const BlockMask occupied = observed & after.occupied, free = observed & after.free;
  if (const BlockMask came = without(occupied, before.occupied); came.any()) {
    const BlockMask from_free = came & before.free;
    const BlockMask sure =
        without(from_free & free_low_ & free_high_, left_within(came, kReturnTicks, tick.at));
    for (BlockMask* mask : {&left_, &free_low_, &free_high_}) *mask = without(*mask, came);
    arrived_ = arrived_ | from_free;
    sure_ = sure_ | sure;
    occupied_[0] = occupied_[0] | came;
    turn(from_free, tick.at);
  }
  const BlockMask stayed_occupied = occupied & before.occupied;
  for (std::uint32_t i = std::min(tick.steps, kSettledTicks); i > 0; --i) {
    count_occupied(stayed_occupied);
  }
  const BlockMask freed = without(free, before.free);
  if (const BlockMask left = freed & before.occupied; left.any()) {
    forget(left);
    left_ = left_ | left;
    turn(left, tick.at);
  }
  free_low_ = free_low_ | freed;
  const BlockMask stayed_free = free & before.free;
  for (std::uint32_t i = std::min(tick.steps, kSureTicks); i > 0; --i) count_free(stayed_free);
}

/// Notes that voxels arrived or left.
void BlockHistory::turn(const BlockMask& voxels, std::uint32_t now) {
  if (!voxels.any()) return;
  if (!turned_at_) {
    turned_at_ = std::make_unique_for_overwrite<std::array<std::uint8_t, kBlockVoxels>>();
  }
  for_each_cell(voxels,
                [&](std::uint32_t cell) { (*turned_at_)[cell] = static_cast<std::uint8_t>(now); });
}

void BlockHistory::count_occupied(const BlockMask& voxels) {
  if (!voxels.any()) return;
  BlockMask carry = voxels;
  for (BlockMask& digit : occupied_) {
    const BlockMask both = digit & carry;
    digit = without(digit | carry, both);
    carry = both;
  }
  settled_ = settled_ | carry;  // 7 + 1
}

/// 1 -> 2 -> 3 -> 3.
void BlockHistory::count_free(const BlockMask& voxels) {
  if (!voxels.any()) return;
  const BlockMask high = free_high_ | (free_low_ & voxels);
  free_low_ = without(free_low_, without(voxels, free_high_)) | (voxels & free_high_);
  free_high_ = high;
}

void BlockHistory::forget(const BlockMask& voxels) {
  for (BlockMask* mask : {&arrived_, &left_, &sure_, &settled_, &free_low_, &free_high_,
                          &occupied_[0], &occupied_[1], &occupied_[2]}) {
    *mask = without(*mask, voxels);
  }
}

BlockMask BlockHistory::within(const BlockMask& turned, std::uint32_t ticks,
                               std::uint32_t now) const {
  BlockMask young;
  if (now - updated_ > kMaxAgeTicks) return young;
  for_each_cell(turned, [&](std::uint32_t cell) {
    const auto age = static_cast<std::uint8_t>(now - (*turned_at_)[cell]);
    if (age <= ticks) young.set(cell);
  });
  return young;
}

}  // namespace mosbench::hmm_mos_plus
