#include "core/methods/hmm_mos/global_window.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

#include "core/base/multiarch.hpp"

namespace mosbench::hmm_mos {
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
  const auto write = [&](const BlockMask& to, std::uint32_t index, int plane) {
    BlockMask& bits = bits_[static_cast<std::size_t>(plane)];
    bits = (index >> plane & 1u) != 0 ? bits | to : without(bits, to);
  };
  if (const std::uint32_t upper = scan_index >> kLowPlanes << kLowPlanes; upper != upper_) {
    for (int plane = kLowPlanes; plane < planes; ++plane) write(recent_, upper_, plane);
    upper_ = upper;
    recent_ = {};
  }
  for (int plane = 0; plane < std::min(kLowPlanes, planes); ++plane) {
    write(voxels, scan_index, plane);
  }
  recent_ = recent_ | voxels;
}

/// age = scan_index - last_seen, subtracted bit by bit.
LastSeen::Ages::Ages(const LastSeen& last_seen, std::uint32_t scan_index, int planes)
    : planes_(planes) {
  BlockMask borrow;
  for (int plane = 0; plane < planes; ++plane) {
    const auto at = static_cast<std::size_t>(plane);
    const BlockMask now = all_or_none((scan_index >> plane & 1u) != 0);
    BlockMask then = last_seen.bits_[at];
    if (plane >= kLowPlanes) {
      const BlockMask recent = all_or_none((last_seen.upper_ >> plane & 1u) != 0);
      then = without(then, last_seen.recent_) | (recent & last_seen.recent_);
    }
    const BlockMask difference = without(now | then, now & then);
    bits_[at] = without(difference | borrow, difference & borrow);
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

Eviction::Eviction(const Config& config, const VoxelGrid& grid)
    : grid_(grid),
      evict_radius_m_((config.variant == Variant::kPaper2024 ? 2.0 : 1.5) * config.max_range_m),
      positions_kept_(kSweepScans + static_cast<std::size_t>(config.delay_scans) + 1) {
  const double asked_m =
      config.max_range_m + (config.kernel_width_voxels + 2) * config.voxel_size_m * std::sqrt(3.0);
  safe_path_m_ = evict_radius_m_ - asked_m;
}

std::optional<Sweep> Eviction::enter(const Eigen::Vector3d& sensor_m) {
  while (sensors_m_.size() > positions_kept_) sensors_m_.pop_front();
  const std::size_t earlier = sensors_m_.size();
  sensors_m_.push_back(sensor_m);
  double path_m = rays_from_m_;
  for (std::size_t i = 1; i < sensors_m_.size(); ++i) {
    path_m += (sensors_m_[i] - sensors_m_[i - 1]).norm();
  }
  const bool was_fast = fast_;
  fast_ = path_m > safe_path_m_;
  std::optional<Sweep> due;
  if (fast_ && !was_fast && earlier > 0) due = Sweep{0, 1, 0, earlier};
  return due;
}

Sweep Eviction::sweep_after(std::uint32_t scan_index) const {
  const std::size_t sensors = sensors_m_.size();
  if (fast_) return {0, 1, sensors - 1, sensors};
  return {scan_index % kSweepScans, kSweepScans,
          sensors - std::min<std::size_t>(sensors, kSweepScans), sensors};
}

BlockMask Eviction::within(const Sweep& sweep, const BlockIndex& block, BlockMask voxels) const {
  for (std::size_t i = sweep.first_position; i < sweep.last_position; ++i) {
    voxels = within_range(grid_, block, voxels, sensors_m_[i], evict_radius_m_);
  }
  return voxels;
}

}  // namespace mosbench::hmm_mos
