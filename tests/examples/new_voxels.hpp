#pragma once

// A method of one's own, whole: a point moves when its voxel was empty in all scans before. To run
// it as `mosbench run --method new-voxels`, put this into core/methods/new_voxels/pipeline.hpp,
// method_kind() into a row.cpp beside it, and the row into core/methods/methods.cpp.
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/fields.hpp"
#include "core/base/method_row.hpp"
#include "core/base/scan_method.hpp"
#include "core/base/stage_clock.hpp"

namespace mosbench::new_voxels {

/// Every method has the two ranges, by these names: presets and benchmarks set them.
struct Config {
  double min_range_m = 0.5;
  double max_range_m = 20.0;
  double voxel_size_m = 0.5;
};

template <typename AnyConfig, typename Visitor>
void visit_fields(AnyConfig& config, Visitor&& visit) {
  visit("min_range_m", config.min_range_m, FieldRange{0.0, 1000.0},
        "points at or nearer than this never take part");
  visit("max_range_m", config.max_range_m, FieldRange{0.1, 1000.0},
        "points farther than this never take part");
  visit("voxel_size_m", config.voxel_size_m, FieldRange{0.01, 10.0}, "edge of a voxel");
}

inline void check(const Config& config) {
  check_ranges(config);
  check_range_limits(config.min_range_m, config.max_range_m);
}

using Voxel = std::tuple<std::int64_t, std::int64_t, std::int64_t>;

/// Returns the voxel of each point; none for a point out of range or not finite.
inline std::vector<std::optional<Voxel>> voxels_of(const PosedScan& scan, const Config& config) {
  std::vector<std::optional<Voxel>> voxels;
  for (const Point& point : scan.points) {
    auto& voxel = voxels.emplace_back();
    const Eigen::Vector3d p(point.x, point.y, point.z);
    const double range_m = p.norm();  // NaN is in no range
    if (!(range_m > config.min_range_m && range_m <= config.max_range_m)) continue;
    const Eigen::Vector3d place = scan.map_from_sensor * p / config.voxel_size_m;
    voxel.emplace(std::llround(place.x()), std::llround(place.y()), std::llround(place.z()));
  }
  return voxels;
}

class NewVoxels final : public SequentialMethod {
 public:
  explicit NewVoxels(const Config& config, const RunContext& context = {})
      : SequentialMethod(context, kReach_m), config_(checked(config)) {}

 private:
  static constexpr double kReach_m = 1e6;  // farther points are refused, not left out

  std::vector<LabelledScan> take(PosedScan& scan, LabelledScan result) override {
    const StageRecord record{result.stages, context().cpu_times};
    const auto voxels = timed(record, "voxels", [&] { return voxels_of(scan, config_); });
    timed(record, "labels", [&] { label(voxels, result); });
    return {std::move(result)};
  }

  void label(const std::vector<std::optional<Voxel>>& voxels, LabelledScan& result) {
    result.judged = result.scan_index > 0;  // the first scan has nothing to have moved from
    for (std::size_t i = 0; i < voxels.size(); ++i) {
      if (!result.judged || !voxels[i] || seen_.contains(*voxels[i])) continue;
      result.labels[i] = kMovingLabel;
      if (context().scores) result.scores[i] = 1;
    }
    for (const auto& voxel : voxels) {
      if (voxel) seen_.insert(*voxel);
    }
  }

  Config config_;
  std::set<Voxel> seen_;
};

inline MethodKind method_kind() {
  return {.name = "new-voxels",
          .title = "New voxels",
          .source = "mosbench, tests/examples/new_voxels.hpp",
          .summary = "points in voxels that were empty in all scans before",
          .defaults = settings_of(Config{}),
          .check = check_settings<Config>,
          .make = make_method<NewVoxels, Config>};
}

}  // namespace mosbench::new_voxels
