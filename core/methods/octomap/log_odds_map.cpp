#include "core/methods/octomap/log_odds_map.hpp"

#include <octomap/octomap.h>

#include <cmath>
#include <limits>
#include <utility>

#include "core/voxel/block_map.hpp"

namespace mosbench::octomap {
namespace {

using Node = ::octomap::OcTreeNode;

/// A block is a node three levels above the leaves.
constexpr unsigned kBlockDepth = 13;

/// The child of a node three, two or one levels above the leaves that holds a cell of the block;
/// `level` is 2, 1 or 0.
unsigned child_of(std::uint32_t cell, unsigned level) {
  const unsigned x = cell >> level & 1, y = cell >> (3 + level) & 1, z = cell >> (6 + level) & 1;
  return x | y << 1 | z << 2;
}

class Tree final : public ::octomap::OcTree {
 public:
  explicit Tree(const Config& config) : OcTree(config.voxel_size_m) {
    setProbHit(config.hit_probability);
    setProbMiss(config.miss_probability);
    setClampingThresMin(config.lowest_probability);
    setClampingThresMax(config.highest_probability);
  }

  Node* child(Node* node, unsigned position) {
    return nodeChildExists(node, position) ? getNodeChild(node, position)
                                           : createNodeChild(node, position);
  }

  /// Returns the node of a block, made when absent.
  Node* block(const BlockIndex& index) {
    if (root == nullptr) {
      root = new Node();
      ++tree_size;
    }
    const Voxel corner = voxel_at(index, 0);
    const auto key_of = [&](std::int32_t c) {
      return static_cast<::octomap::key_type>(c + (1 << 15));
    };
    const ::octomap::OcTreeKey key(key_of(corner.x), key_of(corner.y), key_of(corner.z));
    Node* node = root;
    for (unsigned depth = 0; depth < kBlockDepth; ++depth) {
      node = child(node, ::octomap::computeChildIdx(key, static_cast<int>(tree_depth - 1 - depth)));
    }
    return node;
  }

  float hit() const { return prob_hit_log; }
  float miss() const { return prob_miss_log; }
};

/// The nodes of one block, looked up once each.
class BlockNodes {
 public:
  BlockNodes(Tree& tree, Node* block) : tree_(tree), block_(block) {}

  /// Returns the leaf of a cell, made when absent.
  Node* leaf(std::uint32_t cell) {
    const unsigned octant = child_of(cell, 2), within = child_of(cell, 1);
    Node*& eighth = eighths_[octant];
    if (eighth == nullptr) eighth = tree_.child(block_, octant);
    Node*& parent = parents_[octant * 8 + within];
    if (parent == nullptr) parent = tree_.child(eighth, within);
    return tree_.child(parent, child_of(cell, 0));
  }

 private:
  Tree& tree_;
  Node* block_;
  std::array<Node*, 8> eighths_{};
  std::array<Node*, 64> parents_{};
};

/// Returns the leaf of a cell, or null.
const Node* find_leaf(const Tree& tree, const Node* node, std::uint32_t cell) {
  for (const unsigned level : {2U, 1U, 0U}) {
    const unsigned position = child_of(cell, level);
    if (!tree.nodeChildExists(node, position)) return nullptr;
    node = tree.getNodeChild(node, position);
  }
  return node;
}

}  // namespace

struct LogOddsMap::State {
  explicit State(const Config& map_config)
      : config(map_config), tree(std::make_unique<Tree>(config)) {}

  Node* block(const BlockIndex& index) {
    const auto [slot, is_new] = blocks.find_or_add(index);
    if (is_new) blocks[slot] = tree->block(index);
    return blocks[slot];
  }

  void add(const BlockIndex& index, const BlockMask& cells, float log_odds) {
    if (!cells.any()) return;
    BlockNodes nodes(*tree, block(index));
    for_each_cell(cells,
                  [&](std::uint32_t cell) { tree->updateNodeLogOdds(nodes.leaf(cell), log_odds); });
  }

  Config config;
  std::unique_ptr<Tree> tree;
  BlockMap<Node*> blocks;
};

LogOddsMap::LogOddsMap(const Config& config) : state_(std::make_unique<State>(config)) {}
LogOddsMap::~LogOddsMap() = default;

void LogOddsMap::enter(const ScanUpdate& update) {
  for (std::size_t i = 0; i < update.free.blocks.size(); ++i) {
    const BlockMask* hit = update.hit.mask_of(update.free.blocks[i]);
    const BlockMask missed =
        hit == nullptr ? update.free.masks[i] : without(update.free.masks[i], *hit);
    state_->add(update.free.blocks[i], missed, state_->tree->miss());
  }
  for (std::size_t i = 0; i < update.hit.block_count(); ++i) {
    state_->add(update.hit.blocks[i], update.hit.masks[i], state_->tree->hit());
  }
}

std::vector<float> LogOddsMap::log_odds_of(const VoxelSet& voxels) const {
  std::vector<float> log_odds(voxels.block_count() * kBlockVoxels,
                              std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < voxels.block_count(); ++i) {
    const std::uint32_t slot = state_->blocks.find(voxels.blocks[i]);
    if (slot == kNoSlot) continue;
    for_each_cell(voxels.masks[i], [&](std::uint32_t cell) {
      const Node* leaf = find_leaf(*state_->tree, state_->blocks[slot], cell);
      if (leaf != nullptr) log_odds[i * kBlockVoxels + cell] = leaf->getLogOdds();
    });
  }
  return log_odds;
}

/// Nodes cannot be taken out of the library's tree without losing memory: what stays is copied.
void LogOddsMap::keep_within(const Voxel& centre, double radius_voxels) {
  State kept(state_->config);
  state_->blocks.for_each_slot([&](std::uint32_t slot) {
    const BlockIndex& index = state_->blocks.index_of(slot);
    const Voxel corner = voxel_at(index, 0);
    const double x = corner.x - centre.x, y = corner.y - centre.y, z = corner.z - centre.z;
    if ((x * x + y * y) + z * z > radius_voxels * radius_voxels) return;
    BlockNodes nodes(*kept.tree, kept.block(index));
    for (std::uint32_t cell = 0; cell < kBlockVoxels; ++cell) {
      const Node* leaf = find_leaf(*state_->tree, state_->blocks[slot], cell);
      if (leaf != nullptr) nodes.leaf(cell)->setLogOdds(leaf->getLogOdds());
    }
  });
  *state_ = std::move(kept);
}

std::vector<Leaf> LogOddsMap::leaves() const {
  std::vector<Leaf> leaves;
  state_->blocks.for_each_slot([&](std::uint32_t slot) {
    for (std::uint32_t cell = 0; cell < kBlockVoxels; ++cell) {
      const Node* leaf = find_leaf(*state_->tree, state_->blocks[slot], cell);
      if (leaf == nullptr) continue;
      leaves.push_back({voxel_at(state_->blocks.index_of(slot), cell), leaf->getLogOdds()});
    }
  });
  return leaves;
}

std::size_t LogOddsMap::block_count() const { return state_->blocks.size(); }

/// A node is allocated for itself, and its eight children as an array of pointers.
std::size_t LogOddsMap::memory_bytes() const {
  constexpr std::size_t kAllocation_bytes = 16;
  const std::size_t nodes = state_->tree->size();
  const std::size_t inner = nodes - state_->tree->getNumLeafNodes();
  return nodes * (sizeof(Node) + kAllocation_bytes) +
         inner * (8 * sizeof(void*) + kAllocation_bytes) + state_->blocks.memory_bytes();
}

}  // namespace mosbench::octomap
