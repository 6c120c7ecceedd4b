#include "core/methods/hmm_mos_plus/block_history.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/scan_steps.hpp"

namespace mosbench::hmm_mos_plus {
namespace {

constexpr double kTick_ns = TickClock::kSeconds * 1e9;
/// More periods than these between two scans change nothing any more.
constexpr double kLongestGapPeriods = 1e4;

/// Turns are pruned before their age is beyond what 8 bits hold: it is below kMaxAgeTicks and
/// this at an update, and grows by kMaxAgeTicks until `within` takes none for young.
constexpr std::uint32_t kPruneTicks = 50;
static_assert(2 * BlockHistory::kMaxAgeTicks + kPruneTicks < 256);

}  // namespace

TickClock::TickClock(std::span<const std::int64_t> stamps_ns) {
  const std::vector<double> apart_ns = scan_steps_ns(stamps_ns);
  const std::optional<double> period_ns = scan_period_ns(apart_ns);
  if (!period_ns) return;
  const double measured = *period_ns / kTick_ns;
  const double ticks_per_period = measured >= 0.8 && measured <= 1.25 ? 1.0 : measured;
  double periods = 0, last_tick = 0;
  const double period_s = ticks_per_period * kSeconds;
  ticks_.push_back({.period_s = period_s});
  for (const double distance_ns : apart_ns) {
    const double passed = std::clamp(std::round(distance_ns / *period_ns), 1.0, kLongestGapPeriods);
    periods += passed;
    const double tick = std::floor(periods * ticks_per_period);
    const auto steps = static_cast<std::uint32_t>(std::min(tick - last_tick, 1e9));
    ticks_.push_back(
        {ticks_.back().at + steps, steps, static_cast<std::uint32_t>(passed), period_s});
    last_tick = tick;
  }
}

Tick TickClock::of(std::uint32_t scan_index) const {
  if (scan_index < ticks_.size()) return ticks_[scan_index];
  if (ticks_.empty()) return {.at = scan_index};
  const auto behind = scan_index - static_cast<std::uint32_t>(ticks_.size() - 1);
  return {.at = ticks_.back().at + behind};
}

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
