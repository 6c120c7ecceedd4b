#include "core/methods/hmm_mos/eviction.hpp"

#include <algorithm>
#include <cmath>

namespace mosbench::hmm_mos {

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
  double path_m = 0;
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
