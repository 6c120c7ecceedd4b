#include "core/last_seen.hpp"

#include <bit>
#include <cassert>

#include "core/multiarch.hpp"

namespace mosbench {
namespace {

BlockMask all_or_none(bool all) { return all ? ~BlockMask{} : BlockMask{}; }

}  // namespace

int LastSeen::planes_for(std::uint32_t max_age) {
  const auto planes = static_cast<int>(std::bit_width(max_age));
  assert(planes <= kMaxPlanes);
  return planes;
}

MOSBENCH_MULTIARCH void LastSeen::stamp(const BlockMask& voxels, std::uint32_t scan_index,
                                        int planes) {
  for (int plane = 0; plane < planes; ++plane) {
    BlockMask& bits = bits_[static_cast<std::size_t>(plane)];
    bits = (scan_index >> plane & 1u) != 0 ? bits | voxels : without(bits, voxels);
  }
}

/// age = scan_index - last_seen, subtracted bit by bit.
LastSeen::Ages::Ages(const LastSeen& last_seen, std::uint32_t scan_index, int planes)
    : planes_(planes) {
  BlockMask borrow;
  for (std::size_t plane = 0; plane < static_cast<std::size_t>(planes); ++plane) {
    const BlockMask now = all_or_none((scan_index >> plane & 1u) != 0);
    const BlockMask& then = last_seen.bits_[plane];
    const BlockMask difference = without(now | then, now & then);
    bits_[plane] = without(difference | borrow, difference & borrow);
    borrow = without(then | borrow, now) | (then & borrow);
  }
}

BlockMask LastSeen::Ages::at_least(std::uint32_t age) const {
  if (age >> planes_ != 0) return {};
  BlockMask below;
  for (std::size_t plane = 0; plane < static_cast<std::size_t>(planes_); ++plane) {
    const bool bit = (age >> plane & 1u) != 0;
    // Higher bits decide; equal ones leave the decision to those below.
    below = bit ? below | ~bits_[plane] : without(below, bits_[plane]);
  }
  return ~below;
}

std::uint32_t LastSeen::Ages::greatest(const BlockMask& voxels) const {
  BlockMask candidates = voxels;
  std::uint32_t age = 0;
  for (int plane = planes_ - 1; plane >= 0; --plane) {
    const BlockMask with_bit = candidates & bits_[static_cast<std::size_t>(plane)];
    if (!with_bit.any()) continue;
    candidates = with_bit;
    age |= 1u << plane;
  }
  return age;
}

}  // namespace mosbench
