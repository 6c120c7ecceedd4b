#include "core/methods/dynablox/clusters.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace mosbench::dynablox {
namespace {

/// Numbers of clusters by voxel, for the blocks of a scan that have any.
class Owners {
 public:
  explicit Owners(const VoxelizedScan& scan)
      : scan_(scan), owned_(scan.measured.block_count()), places_(owned_.size(), kNoSlot) {}

  bool owned(std::uint32_t voxel) const {
    return owned_[voxel / kBlockVoxels].test(voxel % kBlockVoxels);
  }
  std::uint32_t owner(std::uint32_t voxel) const {
    return owned(voxel) ? owners_[place(voxel)] : kNoCluster;
  }
  void set(std::uint32_t voxel, std::uint32_t cluster) {
    const std::uint32_t slot = voxel / kBlockVoxels;
    if (places_[slot] == kNoSlot) {
      places_[slot] = static_cast<std::uint32_t>(owners_.size() / kBlockVoxels);
      owners_.resize(owners_.size() + kBlockVoxels);
    }
    owned_[slot].set(voxel % kBlockVoxels);
    owners_[place(voxel)] = cluster;
  }
  /// Returns the number of a voxel of the scan, kNoVoxel where the scan has no point.
  std::uint32_t at(const Voxel& voxel) const {
    const std::uint32_t slot = scan_.measured.find(block_of(voxel));
    if (slot == kNoSlot || !scan_.measured.masks[slot].test(cell_of(voxel))) return kNoVoxel;
    return slot * kBlockVoxels + cell_of(voxel);
  }
  Voxel voxel(std::uint32_t number) const {
    return voxel_at(scan_.measured.blocks[number / kBlockVoxels], number % kBlockVoxels);
  }

 private:
  std::size_t place(std::uint32_t voxel) const {
    return std::size_t{places_[voxel / kBlockVoxels]} * kBlockVoxels + voxel % kBlockVoxels;
  }

  const VoxelizedScan& scan_;
  std::vector<BlockMask> owned_;
  std::vector<std::uint32_t> places_;  // by slot
  std::vector<std::uint32_t> owners_;
};

constexpr std::array<Voxel, 6> kFaces = {
    {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

Voxel moved(const Voxel& v, const Voxel& by) { return {v.x + by.x, v.y + by.y, v.z + by.z}; }

void grow(std::uint32_t first, std::uint32_t number, std::span<const BlockMask> seeds,
          Owners& owners, Cluster& cluster) {
  std::vector<std::uint32_t> stack{first};
  owners.set(first, number);
  cluster.voxels.push_back(first);
  while (!stack.empty()) {
    const Voxel voxel = owners.voxel(stack.back());
    stack.pop_back();
    for (const Voxel& face : kFaces) {
      const std::uint32_t next = owners.at(moved(voxel, face));
      if (next == kNoVoxel || owners.owned(next)) continue;
      owners.set(next, number);
      cluster.voxels.push_back(next);
      if (seeds[next / kBlockVoxels].test(next % kBlockVoxels)) stack.push_back(next);
    }
  }
}

std::vector<Cluster> grown(const VoxelizedScan& scan, std::span<const BlockMask> seeds,
                           Owners& owners) {
  std::vector<std::uint32_t> slots(seeds.size());
  std::iota(slots.begin(), slots.end(), 0U);
  std::erase_if(slots, [&](std::uint32_t slot) { return !seeds[slot].any(); });
  std::ranges::sort(slots, {}, [&](std::uint32_t slot) {
    const BlockIndex& block = scan.measured.blocks[slot];
    return std::array{block.z, block.y, block.x};
  });
  std::vector<Cluster> clusters;
  for (const std::uint32_t slot : slots) {
    for_each_cell(seeds[slot], [&](std::uint32_t cell) {
      const std::uint32_t seed = slot * kBlockVoxels + cell;
      if (owners.owned(seed)) return;
      const auto number = static_cast<std::uint32_t>(clusters.size());
      grow(seed, number, seeds, owners, clusters.emplace_back());
    });
  }
  return clusters;
}

VoxelBox box_of(const Cluster& cluster, const Owners& owners, const VoxelGrid& grid) {
  VoxelBox box{};
  bool first = true;
  for (const std::uint32_t number : cluster.voxels) {
    const Voxel voxel = owners.voxel(number);
    const std::array<std::int32_t, 3> at{voxel.x, voxel.y, voxel.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto origin =
          static_cast<std::int64_t>(grid.origin_voxels[static_cast<Eigen::Index>(axis)]);
      const std::int64_t coordinate = at[axis] + origin;
      box.low[axis] = first ? coordinate : std::min(box.low[axis], coordinate);
      box.high[axis] = first ? coordinate : std::max(box.high[axis], coordinate);
    }
    first = false;
  }
  return box;
}

/// Returns the offsets of voxels at most so far away, without the voxel itself.
std::vector<Voxel> offsets_within(double voxels) {
  // Twice the rounding of 0.2 m in single precision, so that neighbours by a face count as near.
  const double limit = voxels * voxels * (1 + 1e-3);
  const int reach = static_cast<int>(std::floor(voxels + 0.5));
  std::vector<Voxel> offsets;
  for (int z = -reach; z <= reach; ++z) {
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        const int sq = x * x + y * y + z * z;
        if (sq > 0 && sq <= limit) offsets.push_back({x, y, z});
      }
    }
  }
  return offsets;
}

/// Returns, by cluster, the later ones that have a voxel near one of its own, in rising order.
std::vector<std::vector<std::uint32_t>> later_neighbours(const std::vector<Cluster>& clusters,
                                                         const Owners& owners,
                                                         double separation_voxels) {
  const std::vector<Voxel> offsets = offsets_within(separation_voxels);
  std::vector<std::vector<std::uint32_t>> later(clusters.size());
  for (std::uint32_t i = 0; i < clusters.size(); ++i) {
    for (const std::uint32_t number : clusters[i].voxels) {
      const Voxel voxel = owners.voxel(number);
      for (const Voxel& offset : offsets) {
        const std::uint32_t near = owners.at(moved(voxel, offset));
        if (near == kNoVoxel) continue;
        const std::uint32_t other = owners.owner(near);
        if (other != kNoCluster && other > i) later[i].push_back(other);
      }
    }
    std::ranges::sort(later[i]);
    // clang cannot read std::ranges::unique of GCC 12.
    later[i].erase(std::unique(later[i].begin(), later[i].end()), later[i].end());
  }
  return later;
}

/// Returns the cluster that each one becomes part of, itself if none.
std::vector<std::uint32_t> merged(const std::vector<Cluster>& clusters, const Owners& owners,
                                  const Config& config) {
  std::vector<std::uint32_t> into(clusters.size());
  std::iota(into.begin(), into.end(), 0U);
  if (config.cluster_separation_voxels <= 0) return into;
  const auto later = later_neighbours(clusters, owners, config.cluster_separation_voxels);
  for (std::uint32_t i = 0; i < clusters.size(); ++i) {
    if (into[i] != i) continue;
    for (const std::uint32_t j : later[i]) {
      if (into[j] == j && overlap(clusters[i].box, clusters[j].box,
                                  config.cluster_separation_voxels, config.box_test)) {
        into[j] = i;
      }
    }
  }
  return into;
}

bool is_object(const Cluster& cluster, const Config& config) {
  double diagonal_sq = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double side_m = static_cast<double>(cluster.box.high[axis] - cluster.box.low[axis] + 1) *
                          config.voxel_size_m;
    diagonal_sq += side_m * side_m;
  }
  const double extent_m = std::sqrt(diagonal_sq);
  return cluster.points >= static_cast<std::size_t>(config.min_cluster_points) &&
         cluster.points <= static_cast<std::size_t>(config.max_cluster_points) &&
         extent_m >= config.min_cluster_extent_m && extent_m <= config.max_cluster_extent_m;
}

/// Keeps the clusters that are objects, in their order, and renumbers the points.
void keep_objects(Clusters& all, const Config& config) {
  std::vector<std::uint32_t> renumbered(all.clusters.size(), kNoCluster);
  std::vector<Cluster> kept;
  for (std::size_t i = 0; i < all.clusters.size(); ++i) {
    if (all.clusters[i].points == 0 || !is_object(all.clusters[i], config)) continue;
    renumbered[i] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(std::move(all.clusters[i]));
  }
  for (std::uint32_t& cluster : all.of_point) {
    if (cluster != kNoCluster) cluster = renumbered[cluster];
  }
  all.clusters = std::move(kept);
}

}  // namespace

bool overlap(const VoxelBox& a, const VoxelBox& b, double margin_voxels, BoxTest test) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t other = axis == 2 && test == BoxTest::kAuthors ? 0 : axis;
    // Boxes reach half a voxel beyond the centres of their outermost voxels.
    if (static_cast<double>(a.low[axis] - b.high[other] - 1) > margin_voxels) return false;
    if (static_cast<double>(b.low[axis] - a.high[axis] - 1) > margin_voxels) return false;
  }
  return true;
}

Clusters find_clusters(const VoxelizedScan& scan, std::span<const BlockMask> seeds,
                       const VoxelGrid& grid, const Config& config) {
  Owners owners(scan);
  Clusters result;
  result.clusters = grown(scan, seeds, owners);
  for (Cluster& cluster : result.clusters) cluster.box = box_of(cluster, owners, grid);
  const std::vector<std::uint32_t> into = merged(result.clusters, owners, config);
  result.of_point.assign(scan.voxel_of_point.size(), kNoCluster);
  if (result.clusters.empty()) return result;
  for (std::size_t i = 0; i < result.of_point.size(); ++i) {
    const std::uint32_t voxel = scan.voxel_of_point[i];
    if (voxel == kNoVoxel || !owners.owned(voxel)) continue;
    result.of_point[i] = into[owners.owner(voxel)];
    ++result.clusters[result.of_point[i]].points;
  }
  keep_objects(result, config);
  return result;
}

std::vector<Tracks::Track> Tracks::follow(const std::vector<Eigen::Vector3d>& centres_m) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < previous_m_.size(); ++i) {
    for (std::size_t j = 0; j < centres_m.size(); ++j) {
      const double distance_m = (previous_m_[i] - centres_m[j]).norm();
      if (distance_m <= max_distance_m_) pairs.emplace_back(distance_m, i, j);
    }
  }
  std::ranges::sort(pairs);
  std::vector<Track> tracks(centres_m.size());
  std::vector<bool> continued(previous_m_.size());
  for (const auto& [distance_m, i, j] : pairs) {
    if (continued[i] || tracks[j].number != 0) continue;
    continued[i] = true;
    tracks[j] = {tracks_[i].number, tracks_[i].scans + 1};
  }
  for (Track& track : tracks) {
    if (track.number == 0) track.number = ++last_number_;
  }
  previous_m_ = centres_m;
  tracks_ = tracks;
  return tracks;
}

}  // namespace mosbench::dynablox
