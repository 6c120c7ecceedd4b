#include "core/methods/octomap/pipeline.hpp"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/scan_method.hpp"
#include "core/base/stage_clock.hpp"
#include "core/methods/octomap/log_odds_map.hpp"

namespace mosbench::octomap {
namespace {

constexpr double kReach_m = 1e6;
/// The tree holds so many voxels in each direction from its centre.
constexpr std::int32_t kTree_voxels = 1 << 15;

struct HeldScan {
  ScanUpdate update;
  LabelledScan result;
};

class Pipeline final : public SequentialMethod {
 public:
  Pipeline(const Config& config, const RunContext& context)
      : SequentialMethod(context, kReach_m, true), config_(checked(config)), map_(config) {}

  std::optional<MemoryUse> memory() const override;

 private:
  std::vector<LabelledScan> take(PosedScan& scan, LabelledScan result) override;
  std::vector<LabelledScan> release() override;
  void judge(const ScanUpdate& update, LabelledScan& result) const;
  void forget(const Voxel& sensor);

  Config config_;
  std::optional<VoxelGrid> grid_;  ///< around the first scan
  std::vector<RayWindow> windows_;
  LogOddsMap map_;
  Voxel forgotten_at_;          ///< where voxels were forgotten last
  std::vector<HeldScan> held_;  ///< all scans when judged at the end
};

std::vector<LabelledScan> Pipeline::take(PosedScan& scan, LabelledScan result) {
  const StageRecord record{result.stages, context().cpu_times};
  const Eigen::Vector3d sensor_m = scan.map_from_sensor.translation();
  if (!grid_) grid_ = grid_around(sensor_m, config_.voxel_size_m);
  forget(voxel_of(sensor_m, *grid_));
  ScanUpdate update =
      timed(record, "raycast", [&] { return update_of(scan, *grid_, config_, windows_, pool()); });
  // Before the first scan there is no map.
  if (config_.when == When::kBefore && result.scan_index > 0) judge(update, result);
  {
    const StageClock clock(record, "map_update");
    map_.enter(update);
  }
  if (config_.when == When::kAfter) judge(update, result);
  std::vector<LabelledScan> results;
  if (config_.when == When::kFinal) {
    update.free = {};
    held_.push_back({std::move(update), std::move(result)});
  } else {
    results.push_back(std::move(result));
  }
  return results;
}

std::vector<LabelledScan> Pipeline::release() {
  std::vector<LabelledScan> results;
  for (HeldScan& held : held_) {
    judge(held.update, held.result);
    results.push_back(std::move(held.result));
  }
  held_.clear();
  return results;
}

void Pipeline::judge(const ScanUpdate& update, LabelledScan& result) const {
  const StageClock clock({result.stages, context().cpu_times}, "labels");
  const std::vector<float> log_odds = map_.log_odds_of(update.hit);
  for (std::size_t i = 0; i < update.voxel_of_point.size(); ++i) {
    const std::uint32_t voxel = update.voxel_of_point[i];
    if (voxel == kNoVoxel || std::isnan(log_odds[voxel])) continue;
    if (log_odds[voxel] < 0) result.labels[i] = kMovingLabel;
    if (context().scores) result.scores[i] = -log_odds[voxel];
  }
  result.threshold = 0;
  result.judged = true;
}

/// Forgets voxels out of reach whenever the sensor has moved by a range.
void Pipeline::forget(const Voxel& sensor) {
  const double range_voxels = config_.max_range_m / config_.voxel_size_m;
  if (config_.when == When::kFinal) {
    const auto reach = static_cast<std::int32_t>(range_voxels) + 2;
    const std::int32_t farthest =
        std::max({std::abs(sensor.x), std::abs(sensor.y), std::abs(sensor.z)});
    if (farthest + reach < kTree_voxels) return;
    throw std::range_error("sensor position: is beyond the " + std::to_string(kTree_voxels) +
                           " voxels of OctoMap's tree, expected larger voxels or when=before");
  }
  const double x = sensor.x - forgotten_at_.x, y = sensor.y - forgotten_at_.y,
               z = sensor.z - forgotten_at_.z;
  if ((x * x + y * y) + z * z < range_voxels * range_voxels) return;
  map_.keep_within(sensor, 2 * range_voxels);
  forgotten_at_ = sensor;
}

std::optional<MemoryUse> Pipeline::memory() const {
  std::size_t bytes = map_.memory_bytes();
  for (const RayWindow& window : windows_) bytes += window.memory_bytes();
  for (const HeldScan& held : held_) {
    bytes += held.update.hit.memory_bytes() +
             (held.update.voxel_of_point.capacity() + held.result.labels.capacity()) *
                 sizeof(std::uint32_t);
  }
  return MemoryUse{bytes, map_.block_count()};
}

}  // namespace

std::unique_ptr<Method> make_pipeline(const Config& config, const RunContext& context) {
  return std::make_unique<Pipeline>(config, context);
}

std::string_view how_to_build() { return {}; }

}  // namespace mosbench::octomap
