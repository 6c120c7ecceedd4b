#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string_view>
#include <unordered_map>

#include "eval/result/result_scans.hpp"
#include "eval/static_map/map_score.hpp"

namespace mosbench {

/// The first static point that was seen in a voxel.
struct MapPoint {
  Eigen::Vector3d position_map_m;
  float intensity;
};

/// What decides which points become a map.
struct StaticMapConfig {
  double voxel_m = 0.1;
  RangeGate range = {0.0, -1.0};  ///< of the points that are taken, from the sensor
  /// Whether voxels that more moving than static points hit are left out.
  bool by_majority = false;
  /// Voxels in memory, 64 bytes each. Beyond them, those farthest from the sensor wait in files.
  std::size_t most_voxels = std::size_t{1} << 24;
};

/// Collects what stands still in a drive, a point per voxel.
class StaticMap {
 public:
  /// `spill_folder` is made when memory is full, and removed at the end.
  StaticMap(const StaticMapConfig& config, std::filesystem::path spill_folder);
  StaticMap(const StaticMap&) = delete;
  StaticMap& operator=(const StaticMap&) = delete;
  ~StaticMap();

  /// Throws DataError where a full memory cannot be written to files.
  void add(const JudgedScan& scan);
  const StaticMapConfig& config() const { return config_; }
  /// Calls `visit` for each point, in the order of their places, tile by tile.
  void for_each(const std::function<void(const MapPoint&)>& visit) const;
  std::uint64_t size() const;
  /// Counts voxels with truth as ERASOR does (Lim et al., RA-L 2021): how many static ones hold a
  /// point of the map, and how many that moving points alone hit hold none.
  MapCounts voxels_with_truth() const;

 private:
  struct Voxel {
    std::array<float, 3> in_tile_m{};
    float intensity = 0.0F;
    std::uint32_t static_points = 0, moving_points = 0;  ///< by the labels
    bool truth_static = false, truth_moving = false;
  };
  using Tile = std::unordered_map<std::uint32_t, Voxel>;  ///< by the place in the tile
  using Place = std::array<std::int64_t, 3>;

  void add_point(const Eigen::Vector3d& position_m, float intensity, PointOutcome outcome);
  Tile& tile_at(const Place& place);
  void spill_far_from(const Eigen::Vector3d& sensor_m);
  void for_each_tile(const std::function<void(const Place&, const Tile&)>& visit) const;
  std::filesystem::path file_of(const Place& place) const;
  Tile read_tile(const Place& place) const;
  bool is_kept(const Voxel& voxel) const;
  double side_m() const;

  StaticMapConfig config_;
  std::filesystem::path spill_folder_;
  std::map<Place, Tile> tiles_;  ///< in memory
  std::set<Place> spilled_;      ///< in files
  std::size_t voxels_ = 0;       ///< in memory
};

/// Reads the scans of a result but those in which the method did not look for motion: they may hold
/// anything. Tells its progress. Throws DataError, also where there is no such scan.
void for_each_judged(const ResultScans& scans,
                     const std::function<void(const JudgedScan& scan)>& visit);

/// Takes the bytes of a file, one part after the other.
using ByteSink = std::function<void(std::string_view bytes)>;
/// Hand over a binary file of x, y, z and intensity: PLY with float64, and PCD with float32, as
/// PCL's own points have it. The second throws DataError naming `file` where float32 is too coarse.
void format_ply(const StaticMap& map, const ByteSink& sink);
void format_pcd(const StaticMap& map, const std::filesystem::path& file, const ByteSink& sink);

}  // namespace mosbench
