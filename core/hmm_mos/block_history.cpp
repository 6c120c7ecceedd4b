#include "core/hmm_mos/block_history.hpp"

namespace mosbench::hmm_mos {

void BlockHistory::update(const BlockMask& observed, const BlockStates& before,
                          const BlockStates& after, std::uint32_t scan_index) {
  if (arrived_.any()) {  // before their age is beyond what 8 bits hold
    arrived_ = within(arrived_, kMaxAgeScans, scan_index);
    sure_ = sure_ & arrived_;
  }
  updated_ = scan_index;
  const BlockMask occupied = observed & after.occupied, free = observed & after.free;
  if (const BlockMask came = without(occupied, before.occupied); came.any()) {
    const BlockMask from_free = came & before.free;
    arrived_ = without(arrived_, came) | from_free;
    sure_ = without(sure_, came) | (from_free & free_low_ & free_high_);
    settled_ = without(settled_, came);
    for (BlockMask* digit : {&free_low_, &free_high_, &occupied_[0], &occupied_[1], &occupied_[2]})
      *digit = without(*digit, came);
    occupied_[0] = occupied_[0] | came;
    if (!arrived_at_ && from_free.any()) {
      arrived_at_ = std::make_unique_for_overwrite<std::array<std::uint8_t, kBlockVoxels>>();
    }
    for_each_cell(from_free, [&](std::uint32_t cell) {
      (*arrived_at_)[cell] = static_cast<std::uint8_t>(scan_index);
    });
  }
  if (BlockMask carry = occupied & before.occupied; carry.any()) {
    for (BlockMask& digit : occupied_) {
      const BlockMask both = digit & carry;
      digit = without(digit | carry, both);
      carry = both;
    }
    settled_ = settled_ | carry;  // 7 + 1
  }
  if (const BlockMask left = without(free, before.free); left.any()) {
    forget(left);
    free_low_ = free_low_ | left;
  }
  if (const BlockMask stayed = free & before.free; stayed.any()) {  // 1 -> 2 -> 3 -> 3
    const BlockMask high = free_high_ | (free_low_ & stayed);
    free_low_ = without(free_low_, without(stayed, free_high_)) | (stayed & free_high_);
    free_high_ = high;
  }
}

void BlockHistory::forget(const BlockMask& voxels) {
  for (BlockMask* mask : {&arrived_, &sure_, &settled_, &free_low_, &free_high_, &occupied_[0],
                          &occupied_[1], &occupied_[2]}) {
    *mask = without(*mask, voxels);
  }
}

BlockMask BlockHistory::within(const BlockMask& arrivals, std::uint32_t scans,
                               std::uint32_t scan_index) const {
  BlockMask young;
  if (scan_index - updated_ > kMaxAgeScans) return young;
  for_each_cell(arrivals, [&](std::uint32_t cell) {
    // Ages at the last update are at most kMaxAgeScans, so that these are below 256.
    const auto age = static_cast<std::uint8_t>(scan_index - (*arrived_at_)[cell]);
    if (age <= scans) young.set(cell);
  });
  return young;
}

}  // namespace mosbench::hmm_mos
