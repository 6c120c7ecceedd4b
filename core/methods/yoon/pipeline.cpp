#include "core/methods/yoon/pipeline.hpp"

#include <limits>
#include <utility>

#include "core/base/method_row.hpp"
#include "core/base/stage_clock.hpp"
#include "core/methods/yoon/growth.hpp"
#include "core/methods/yoon/residual.hpp"

namespace mosbench::yoon {
namespace {

constexpr double kReach_m = 1e5;

/// Returns a flag for each point that is seen.
std::vector<std::uint8_t> seen_among(std::span<const Direction> directions) {
  std::vector<std::uint8_t> seen;
  seen.reserve(directions.size());
  for (const Direction& direction : directions) seen.push_back(direction.range_m > 0);
  return seen;
}

std::vector<Eigen::Vector3f> positions_of(std::span<const Point> points,
                                          const Pose& reference_from_sensor) {
  const Eigen::Isometry3f pose = reference_from_sensor.cast<float>();
  std::vector<Eigen::Vector3f> positions;
  positions.reserve(points.size());
  for (const Point& p : points) positions.push_back(pose * Eigen::Vector3f(p.x, p.y, p.z));
  return positions;
}

}  // namespace

Pipeline::Pipeline(const Config& config, const RunContext& context)
    : SequentialMethod(context, kReach_m),
      config_(checked(config)),
      angle_(config.neighbour_angle_rad, config.least_angle_rows) {}

std::vector<LabelledScan> Pipeline::take(PosedScan& scan, LabelledScan result) {
  angle_.measure(scan.points, config_.min_range_m);
  std::vector<Direction> own = timed({result.stages, context().cpu_times}, "directions", [&] {
    return directions_of(scan.points, Pose::Identity(),
                         {config_.min_range_m, std::numeric_limits<double>::max()}, pool());
  });
  if (past_.size() == static_cast<std::size_t>(config_.window_scans)) {
    judge(scan, own, past_.front(), result);
    past_.pop_front();
  }
  past_.push_back({std::move(scan), std::move(own)});
  std::vector<LabelledScan> results;
  results.push_back(std::move(result));
  return results;
}

void Pipeline::judge(const PosedScan& scan, const std::vector<Direction>& own,
                     const PastScan& reference, LabelledScan& result) {
  const StageRecord record{result.stages, context().cpu_times};
  const Pose reference_from_sensor =
      reference.scan.map_from_sensor.inverse() * scan.map_from_sensor;
  const auto queries = timed(record, "directions", [&] {
    return directions_of(scan.points, reference_from_sensor,
                         {config_.min_range_m, config_.max_range_m}, pool());
  });
  const auto looks = timed(record, "query", [&] {
    const DirectionGrid grid(reference.directions, angle_.rad());
    return looks_at(queries, grid, static_cast<float>(config_.free_margin_m), pool());
  });
  const auto points = positions_of(scan.points, reference_from_sensor);
  const auto reference_points = positions_of(reference.scan.points, Pose::Identity());
  const auto cells = timed(record, "cells", [&] {
    return PointCells(reference_points, seen_among(reference.directions), kFarthest_m);
  });
  std::vector<float> residuals_m(points.size());
  std::vector<std::uint8_t> moving(points.size());
  {
    const StageClock clock(record, "seeds");
    pool().for_ranges(points.size(), 512, [&](std::size_t begin, std::size_t end, unsigned) {
      for (std::size_t i = begin; i < end; ++i) {
        if (looks[i].finding != Look::Finding::kFree) continue;
        residuals_m[i] =
            residual_of(points[i], reference_points, cells, config_.planar_share).distance_m;
        moving[i] = residuals_m[i] > static_cast<float>(config_.seed_residual_m);
      }
    });
  }
  if (config_.last_step != LastStep::kSeeds) {
    const StageClock clock(record, "box_filter");
    // Points beyond the range limit are seen all the same.
    moving = filter_seeds(own, moving, angle_.rad());
  }
  if (config_.last_step == LastStep::kGrowth) {
    const StageClock clock(record, "growth");
    const std::vector<std::uint8_t> in_range = seen_among(queries);
    moving = grow(std::move(moving), {points, in_range, looks, reference_points, cells}, config_);
  }
  for (std::size_t i = 0; i < moving.size(); ++i) {
    if (moving[i] != 0) result.labels[i] = kMovingLabel;
  }
  if (context().scores) result.scores = std::move(residuals_m);
  result.threshold = config_.seed_residual_m;
  result.judged = true;
}

std::optional<MemoryUse> Pipeline::memory() const {
  std::size_t bytes = 0;
  for (const PastScan& past : past_) {
    bytes += past.scan.points.capacity() * sizeof(Point) +
             past.directions.capacity() * sizeof(Direction);
  }
  return MemoryUse{bytes, past_.size()};
}

void check(const Config& config) {
  check_ranges(config);
  check_range_limits(config.min_range_m, config.max_range_m);
}

/// "yoon": our reading of a method without published code.
MethodKind method_kind() {
  return {
      .name = "yoon",
      .title = "Yoon et al. (our reading)",
      .source =
          "Yoon, Tang, Barfoot: Mapless Online Detection of Dynamic Objects in 3D Lidar, CRV 2019, "
          "arXiv:1809.06972",
      .summary =
          "our reading: points in free space of a scan before, filtered and grown to objects",
      .defaults = settings_of(Config{}),
      .check = check_settings<Config>,
      .make = make_method<Pipeline, Config>,
      .score_name = "residual, m",
      .threshold_name = "residual of seeds, m"};
}

}  // namespace mosbench::yoon
