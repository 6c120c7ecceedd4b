#include "core/methods/dynablox/ever_free_map.hpp"

namespace mosbench::dynablox {

void EverFreeMap::touch(const std::vector<BlockIndex>& wide_blocks, std::int32_t last_occupied) {
  tsdf::TsdfMap::Touched blocks = tsdf.touch(wide_blocks);
  histories.resize(tsdf.blocks.slot_count());
  for (const std::uint32_t slot : blocks.fresh) {
    histories[slot] = BlockHistory{};
    histories[slot].last_occupied = last_occupied;
  }
  touched = std::move(blocks.slots);
}

void EverFreeMap::add_voxels(int counter_to_reset) {
  for (const std::uint32_t slot : touched) {
    BlockHistory& history = histories[slot];
    if (history.voxels != kNoSlot || tsdf.blocks[slot].numbers == kNoSlot) continue;
    history.voxels = voxels.take();
    VoxelHistory& all = voxels[history.voxels];
    all.last_occupied.fill(history.last_occupied);
    all.runs.fill(history.run);
    history.worn = history.run >= counter_to_reset ? ~BlockMask{} : BlockMask{};
    history.recent = ~BlockMask{};  // may be: of no frame yet
    history.recent_frame = -1;
  }
}

void EverFreeMap::keep_near(const Eigen::Vector3d& sensor_m, const VoxelGrid& grid,
                            const tsdf::Config& config) {
  for (const std::uint32_t slot : tsdf.keep_near(sensor_m, grid, config)) {
    if (histories[slot].voxels != kNoSlot) voxels.give_back(histories[slot].voxels);
  }
}

std::size_t EverFreeMap::memory_bytes() const {
  return tsdf.memory_bytes() + voxels.memory_bytes() + histories.capacity() * sizeof(BlockHistory) +
         touched.capacity() * sizeof(std::uint32_t);
}

}  // namespace mosbench::dynablox
