#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <mosbench/scan.hpp>
#include <optional>
#include <set>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "core/hmm_mos/config.hpp"

namespace mosbench::slow {

/// The obvious twin of the core: the method step by step with hash maps of single voxels, all pairs
/// and triple loops, in double precision. It shares no code with core/ but the config.
struct Voxel {
  int x = 0, y = 0, z = 0;
  auto operator<=>(const Voxel&) const = default;
};

struct VoxelHash {
  std::size_t operator()(const Voxel& v) const {
    const auto mix = [](int c) { return static_cast<std::size_t>(static_cast<unsigned>(c)); };
    return (mix(v.x) * 73856093u) ^ (mix(v.y) * 19349669u) ^ (mix(v.z) * 83492791u);
  }
};

template <typename Value>
using VoxelMap = std::unordered_map<Voxel, Value, VoxelHash>;
using VoxelSet = std::unordered_set<Voxel, VoxelHash>;

enum class State { kUnobserved, kOccupied, kFree };

struct MapRecord {
  double belief[3] = {1.0, 0.0, 0.0};  // unobserved, occupied, free
  State state = State::kUnobserved;
  int last_change = 0;
  int last_seen = 0;
};

struct ScanVoxel {
  int score = 0;
  int filtered = 0;
  int window_sum = 0;
  bool beside_unknown = false;
  bool is_dynamic = false;
  bool from_region = false;
};

struct Scan {
  std::vector<std::optional<Voxel>> voxel_of_point;
  VoxelSet measured;
  VoxelMap<ScanVoxel> occupied;
  Eigen::Vector3d sensor_m = Eigen::Vector3d::Zero();
};

struct RegionRecord {
  bool is_dynamic = false, high_confidence = false, beside_unknown = false;
  int score = 0;
  int last_seen = 0;
};

inline double squared(double value) { return value * value; }

inline double corner_distance_sq_m2(const Voxel& v, double voxel_size_m, const Eigen::Vector3d& t) {
  return squared(v.x * voxel_size_m - t.x()) + squared(v.y * voxel_size_m - t.y()) +
         squared(v.z * voxel_size_m - t.z());
}

/// Calls `visit` for every voxel within `radius` per axis, the centre included.
template <typename Visit>
void for_neighbours(const Voxel& v, int radius, Visit visit) {
  for (int dx = -radius; dx <= radius; ++dx)
    for (int dy = -radius; dy <= radius; ++dy)
      for (int dz = -radius; dz <= radius; ++dz) visit(Voxel{v.x + dx, v.y + dy, v.z + dz});
}

/// Otsu's threshold over 100 bins; nothing when no level separates the values.
inline std::optional<double> otsu(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  const auto [lo_it, hi_it] = std::minmax_element(values.begin(), values.end());
  const double lo = *lo_it, hi = *hi_it, width = (hi - lo) / 100;
  std::vector<double> count(100, 0.0);
  for (const double s : values) {
    const int bin = s - lo < 1e-3   ? 0
                    : hi - s < 1e-3 ? 99
                                    : static_cast<int>(std::ceil((s - lo) / width)) - 1;
    count[static_cast<std::size_t>(bin)] += 1;
  }
  double moment = 0;
  for (int i = 0; i < 100; ++i) moment += i * count[static_cast<std::size_t>(i)];
  const double total = static_cast<double>(values.size());
  double weight = 0, sum = 0, best = 0;
  std::optional<int> level;
  for (int i = 0; i < 100; ++i) {
    if (weight > 0 && total - weight > 0) {
      const double between =
          weight * (total - weight) * squared(sum / weight - (moment - sum) / (total - weight));
      if (between >= best) {
        best = between;
        level = i + 1;
      }
    }
    weight += count[static_cast<std::size_t>(i)];
    sum += i * count[static_cast<std::size_t>(i)];
  }
  if (!level) return std::nullopt;
  return lo + (*level - 1) * (hi - lo) / 100;
}

/// Squared distance in voxels to the nearest source voxel by comparing with every one of them.
inline double nearest_sq_voxels(const Voxel& v, const std::vector<Voxel>& sources) {
  std::int64_t best = std::numeric_limits<std::int64_t>::max();
  for (const Voxel& u : sources) {
    const std::int64_t dx = v.x - u.x, dy = v.y - u.y, dz = v.z - u.z;
    best = std::min(best, dx * dx + dy * dy + dz * dz);
  }
  return static_cast<double>(best);
}

/// Integer line from s to v as the authors' program walks it.
inline std::vector<Voxel> line(const Voxel& s, const Voxel& v) {
  int d[3] = {std::abs(v.x - s.x), std::abs(v.y - s.y), std::abs(v.z - s.z)};
  int g[3] = {s.x < v.x ? 1 : -1, s.y < v.y ? 1 : -1, s.z < v.z ? 1 : -1};
  const int longest = std::max({d[0], d[1], d[2]});
  int error[3] = {longest / 2, longest / 2, longest / 2};
  int q[3] = {s.x, s.y, s.z};
  std::vector<Voxel> visited;
  for (int step = 0; step <= longest; ++step) {
    visited.push_back({q[0], q[1], q[2]});
    for (int axis = 0; axis < 3; ++axis) {
      error[axis] -= d[axis];
      if (error[axis] < 0) {
        error[axis] += longest;
        q[axis] += g[axis];
      }
    }
  }
  return visited;
}

class Method {
 public:
  /// A sequence of unknown length ends at kNever.
  static constexpr int kNever = 1 << 30;

  Method(const Config& config, Variant variant, int scan_count)
      : config_(config), paper_(variant == Variant::kPaper2024), scan_count_(scan_count) {}

  /// Labels of every scan of the sequence, moving = true.
  std::vector<std::vector<bool>> run(const std::vector<std::vector<Point>>& scans,
                                     const std::vector<Pose>& poses);
  /// Window sum of every point's voxel, scan by scan; 0 where there is none.
  const std::vector<std::vector<std::int32_t>>& scores() const { return scores_; }

 private:
  Scan voxelize(std::span<const Point> points, const Pose& pose) const;
  VoxelSet raycast(const Scan& scan) const;
  void update_map(const VoxelSet& observed, const std::vector<Voxel>& sources);
  void evict(const Eigen::Vector3d& sensor_m);
  bool known(const Voxel& v) const;
  std::vector<bool> detect(Scan& scan);
  std::vector<bool> detect_as(std::size_t scan_index, Scan& scan);
  void score(Scan& scan) const;
  void filter(Scan& scan) const;
  void back_end(Scan& scan) const;
  void update_region(const Scan& scan, double threshold);

  Config config_;
  bool paper_;
  int scan_count_;
  int k_ = 0;
  VoxelMap<MapRecord> map_;
  std::deque<VoxelMap<int>> window_;
  VoxelSet carried_;
  VoxelMap<RegionRecord> region_;
  double region_threshold_ = 0;
  std::vector<std::vector<std::int32_t>> scores_;
};

}  // namespace mosbench::slow
