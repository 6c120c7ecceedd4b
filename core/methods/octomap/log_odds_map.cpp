#include "core/methods/octomap/log_odds_map.hpp"

#include <octomap/octomap.h>

#include <cmath>
#include <limits>
#include <utility>

#include "core/voxel/block_map.hpp"

namespace mosbench::octomap {
namespace {

/// Length of a vector, rounded as by octomath.
double norm_of(const Eigen::Vector3f& v) {
  const float squares = (v.x() * v.x() + v.y() * v.y()) + v.z() * v.z();
  return std::sqrt(static_cast<double>(squares));
}

Voxel voxel_at(const Eigen::Vector3f& p, double voxels_per_m) {
  const auto index = [&](float c) {
    return static_cast<std::int32_t>(std::floor(voxels_per_m * static_cast<double>(c)));
  };
  return {index(p.x()), index(p.y()), index(p.z())};
}

/// Where rays start.
struct Start {
  Eigen::Vector3f at;
  Voxel voxel;
};

/// A ray from its sensor to a point, or as far as the range limit.
struct Line {
  std::size_t start;
  Eigen::Vector3f end;
  Voxel end_voxel;
  bool cut;
};

/// A scan in the single precision of the library.
class Lines {
 public:
  Lines(const PosedScan& scan, const VoxelGrid& grid, const Config& config)
      : config_(config), voxels_per_m_(1.0 / config.voxel_size_m) {
    const Eigen::Vector3d origin_m = grid.origin_voxels * grid.voxel_size_m;
    const Eigen::Vector3d sensor_m = scan.map_from_sensor.translation() - origin_m;
    const Eigen::Matrix3d rotation = scan.map_from_sensor.linear();
    if (scan.origins.empty()) add_start(sensor_m);
    for (const Eigen::Vector3d& place : scan.origins.positions_m) {
      add_start(rotation * place + sensor_m);
    }
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const Eigen::Vector3d p(scan.points[i].x, scan.points[i].y, scan.points[i].z);
      const Eigen::Vector3d ray = p - scan.origins.at(i);
      const double range_sq_m2 = (ray.x() * ray.x() + ray.y() * ray.y()) + ray.z() * ray.z();
      const bool takes_part =
          range_sq_m2 > config.min_range_m * config.min_range_m && std::isfinite(range_sq_m2);
      if (!takes_part) continue;
      const std::size_t start = scan.origins.empty() ? 0 : scan.origins.of_point[i];
      lines_.push_back(line_to(start, (rotation * p + sensor_m).cast<float>()));
      point_of_line_.push_back(i);
    }
  }

  std::span<const Line> all() const { return lines_; }
  std::size_t point_of(std::size_t line) const { return point_of_line_[line]; }

  VoxelBox box() const {
    VoxelBox box{starts_.front().voxel, starts_.front().voxel};
    for (const Start& start : starts_) box.include(start.voxel);
    for (const Line& line : lines_) box.include(line.end_voxel);
    box.widen(1);  // rounding may lead a ray past its end
    return box;
  }

  /// Appends the ray of a line that leaves the sensor's voxel.
  void append_ray(const Line& line, const Voxel& corner, const WindowBits& bits,
                  std::vector<ExactRay>& rays) const {
    const auto& [sensor, sensor_voxel] = starts_[line.start];
    if (line.end_voxel == sensor_voxel) return;
    Eigen::Vector3f direction = line.end - sensor;
    const auto length_m = static_cast<float>(norm_of(direction));
    direction /= length_m;
    const auto bit_of = [&](const Voxel& v) {
      return bits.at({v.x - corner.x, v.y - corner.y, v.z - corner.z});
    };
    const Voxel& end = line.end_voxel;
    const int steps = std::abs(end.x - sensor_voxel.x) + std::abs(end.y - sensor_voxel.y) +
                      std::abs(end.z - sensor_voxel.z);
    rays.push_back({BorderCrossings(sensor.cast<double>(), direction.cast<double>(), sensor_voxel,
                                    config_.voxel_size_m),
                    length_m, bit_of(sensor_voxel), bit_of(end),
                    static_cast<std::uint32_t>(steps)});
  }

 private:
  void add_start(const Eigen::Vector3d& sensor_m) {
    const Eigen::Vector3f at = sensor_m.cast<float>();
    starts_.push_back({at, voxel_at(at, voxels_per_m_)});
  }

  Line line_to(std::size_t start, const Eigen::Vector3f& point) const {
    const Eigen::Vector3f& sensor = starts_[start].at;
    Eigen::Vector3f direction = point - sensor;
    const double length_m = norm_of(direction);
    if (length_m <= config_.max_range_m) {
      return {start, point, voxel_at(point, voxels_per_m_), false};
    }
    direction /= static_cast<float>(length_m);
    const Eigen::Vector3f end = sensor + direction * static_cast<float>(config_.max_range_m);
    return {start, end, voxel_at(end, voxels_per_m_), true};
  }

  const Config& config_;
  double voxels_per_m_;
  std::vector<Start> starts_;
  std::vector<Line> lines_;
  std::vector<std::size_t> point_of_line_;
};

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

ScanUpdate update_of(const PosedScan& scan, const VoxelGrid& grid, const Config& config,
                     std::vector<RayWindow>& windows, ThreadPool& pool) {
  const Lines lines(scan, grid, config);
  ScanUpdate update;
  update.voxel_of_point.assign(scan.points.size(), kNoVoxel);
  for (std::size_t i = 0; i < lines.all().size(); ++i) {
    const Line& line = lines.all()[i];
    if (line.cut) continue;
    const std::uint32_t slot = update.hit.insert(block_of(line.end_voxel));
    const std::uint32_t cell = cell_of(line.end_voxel);
    update.hit.masks[slot].set(cell);
    update.voxel_of_point[lines.point_of(i)] = slot * kBlockVoxels + cell;
  }
  if (lines.all().empty()) return update;

  windows.resize(pool.size());
  BlockIndex first;
  for (RayWindow& window : windows) first = lay_out_around(lines.box(), window);
  const Voxel corner = mosbench::voxel_at(first, 0);
  const WindowBits bits(windows.front());
  // Neighbouring points go to different shares, so that all take about as long.
  const std::size_t shares = 4 * pool.size();
  pool.for_ranges(shares, 1, [&](std::size_t share, std::size_t, unsigned thread) {
    std::vector<ExactRay> rays;
    for (std::size_t i = share; i < lines.all().size(); i += shares) {
      lines.append_ray(lines.all()[i], corner, bits, rays);
    }
    cast_exact(rays, RayEnd::kBeforeEnd, windows[thread], 0, windows[thread]);
  });
  update.free = collect(windows, first, pool);
  return update;
}

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
