#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <mosbench/method.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/fields.hpp"
#include "core/tsdf/sensor_model.hpp"
#include "core/tsdf/tsdf_map.hpp"
#include "core/tsdf/tsdf_method.hpp"
#include "core/voxel/voxel_set.hpp"

namespace mosbench::lc_free_space {

/// What a point is judged by: its voxel and those beside it, or its voxel alone.
enum class Level { kCluster, kPoint };
inline constexpr std::array<std::string_view, 2> kLevelNames = {"cluster", "point"};

/// Every parameter. Those of the map are Dynablox's; the threshold is that of map_lookup.yaml on
/// the branch test of ethz-asl/dynablox, one voxel.
struct Config : tsdf::Config {
  Level level = Level::kCluster;
  double free_above_voxels = 1.0;  ///< theta / v

  float free_above_m() const { return static_cast<float>(free_above_voxels * voxel_size_m); }
  /// Returns the least distance that is free, as d > theta is d >= the next number.
  float least_free_m() const {
    return std::nextafter(free_above_m(), std::numeric_limits<float>::infinity());
  }
};

/// The one list of fields, as fields.hpp describes it.
template <typename AnyConfig, typename Visitor>
void visit_fields(AnyConfig& config, Visitor&& visit) {
  visit("level", config.level, kLevelNames,
        "points move with a voxel beside theirs, too, or by their own voxel");
  tsdf::visit_common_fields(config, visit);
  visit("free_above_voxels", config.free_above_voxels, FieldRange{0.0, 100.0},
        "theta, a voxel is free beyond this distance to a surface");
}

/// Throws std::invalid_argument "<key>: <what is wrong>, <what was expected>" for the first field
/// outside its range, range limits or a field of view that leave nothing, a range of too many
/// voxels, and a threshold that no distance exceeds.
void check(const Config& config);

/// Returns, by block of the scan's measured voxels, those that the map has observed and does not
/// hold near a surface.
std::vector<BlockMask> in_free_space(const VoxelSet& measured, const tsdf::TsdfMap& map);

/// Adds the measured voxels that share a face with a seed. Dynablox's clusters without their least
/// size hold the same voxels: those that are no seeds are not grown from.
std::vector<BlockMask> grown(const VoxelSet& measured, std::span<const BlockMask> seeds);

/// LC Free Space, a row of the tables of Dynablox (Schmid et al., RA-L 2023), which cites Modayil
/// and Kuipers, Robotics and Autonomous Systems 56, 2008: readings that fall into free space are
/// dynamic. Our reading, as no code was published: a point of scan k moves when its voxel, in the
/// truncated signed distances that Dynablox makes of the scans before, was observed (w > 1e-6) and
/// is farther than theta from a surface (d > theta). There is no burn-in, no neighbourhood and no
/// memory of what was free; "LC" is low confidence. With level=cluster, points of voxels that share
/// a face with such a one move, too, as in Dynablox's clusters, without its least size. Online.
/// Memory is bounded: the map is kept within map_radius_ranges. Scores are d, metres, 0 where it
/// was not observed; at the level of points, those above theta move.
class Pipeline final : public tsdf::TsdfMethod {
 public:
  /// Throws std::invalid_argument as `check` does, and for 0 threads.
  explicit Pipeline(const Config& config, const RunContext& context = {});

 private:
  void take(const tsdf::ObservedScan& observed, LabelledScan& result) override;
  MemoryUse map_memory() const override;

  void label(const VoxelizedScan& scan, LabelledScan& result);
  void score(const VoxelizedScan& scan, LabelledScan& result);

  Config config_;
  tsdf::TsdfMap map_;
};

}  // namespace mosbench::lc_free_space
