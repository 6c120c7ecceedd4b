#include "core/methods/underwood/pipeline.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>

#include "core/base/method_row.hpp"
#include "core/base/stage_clock.hpp"

namespace mosbench::underwood {
namespace {

constexpr double kReach_m = 1e6;

}  // namespace

Pipeline::Pipeline(const Config& config, const RunContext& context)
    : SequentialMethod(context, kReach_m),
      config_(checked(config)),
      angle_(config.neighbour_angle_rad, config.least_angle_rows) {}

std::vector<LabelledScan> Pipeline::take(PosedScan& scan, LabelledScan result) {
  angle_.measure(scan.points, config_.min_range_m);
  HeldScan& current = held_.emplace_back();
  {
    const StageClock clock({result.stages, context().cpu_times}, "directions");
    current.directions =
        directions_of(scan.points, Pose::Identity(),
                      {config_.min_range_m, std::numeric_limits<double>::max()}, pool());
  }
  current.scan = std::move(scan);
  current.result = std::move(result);
  ++unreleased_;
  std::vector<LabelledScan> results;
  if (unreleased_ > static_cast<std::size_t>(config_.delay_scans)) {
    judge(held_.size() - unreleased_);
    results.push_back(std::move(held_[held_.size() - unreleased_--].result));
  }
  const auto kept = static_cast<std::size_t>(config_.reference_offset_scans * config_.references +
                                             config_.delay_scans);
  if (held_.size() > kept) held_.pop_front();
  return results;
}

std::vector<LabelledScan> Pipeline::release() {
  std::vector<LabelledScan> results;
  while (unreleased_ > 0) {
    judge(held_.size() - unreleased_);
    results.push_back(std::move(held_[held_.size() - unreleased_--].result));
  }
  return results;
}

/// Returns the scans that one of the held scans is compared with.
std::vector<const Pipeline::HeldScan*> Pipeline::references_of(std::size_t place) const {
  std::vector<const HeldScan*> references;
  const auto n = static_cast<std::size_t>(config_.reference_offset_scans);
  for (std::size_t i = 1; i <= static_cast<std::size_t>(config_.references); ++i) {
    if (place >= i * n) references.push_back(&held_[place - i * n]);
  }
  const std::size_t later = place + static_cast<std::size_t>(config_.delay_scans);
  if (later > place && later < held_.size()) references.push_back(&held_[later]);
  return references;
}

void Pipeline::judge(std::size_t place) {
  HeldScan& judged = held_[place];
  LabelledScan& result = judged.result;
  const StageRecord record{result.stages, context().cpu_times};
  const std::vector<const HeldScan*> references = references_of(place);
  if (references.size() < static_cast<std::size_t>(config_.min_votes)) return;
  const auto tolerance_m = static_cast<float>(config_.range_tolerance_m);
  // Smaller margins are of no interest unless they are asked for.
  const float least_m = context().scores ? 0 : tolerance_m;
  std::vector<std::vector<Look>> looks;
  for (const HeldScan* reference : references) {
    const Pose reference_from_sensor =
        reference->scan.map_from_sensor.inverse() * judged.scan.map_from_sensor;
    const auto queries = timed(record, "directions", [&] {
      return directions_of(judged.scan.points, reference_from_sensor,
                           {config_.min_range_m, config_.max_range_m}, pool());
    });
    const auto grid =
        timed(record, "grid", [&] { return DirectionGrid(reference->directions, angle_.rad()); });
    looks.push_back(
        timed(record, "query", [&] { return looks_at(queries, grid, least_m, pool()); }));
  }
  const StageClock clock(record, "labels");
  const auto votes = static_cast<std::ptrdiff_t>(config_.min_votes);
  std::vector<float> of_point(looks.size());
  for (std::size_t i = 0; i < result.labels.size(); ++i) {
    for (std::size_t r = 0; r < looks.size(); ++r) of_point[r] = looks[r][i].margin_m;
    std::nth_element(of_point.begin(), of_point.begin() + votes - 1, of_point.end(),
                     std::greater<>());
    const float margin_m = of_point[static_cast<std::size_t>(votes - 1)];
    if (margin_m >= tolerance_m) result.labels[i] = kMovingLabel;
    if (context().scores) result.scores[i] = margin_m;
  }
  result.threshold = tolerance_m;
  result.judged = true;
}

std::optional<MemoryUse> Pipeline::memory() const {
  std::size_t bytes = 0;
  for (const HeldScan& scan : held_) {
    bytes += scan.scan.points.capacity() * sizeof(Point) +
             scan.directions.capacity() * sizeof(Direction) +
             scan.result.labels.capacity() * sizeof(std::uint32_t);
  }
  return MemoryUse{bytes, held_.size()};
}

void check(const Config& config) {
  check_ranges(config);
  check_range_limits(config.min_range_m, config.max_range_m);
  const int references = config.references + (config.delay_scans > 0 ? 1 : 0);
  if (config.min_votes > references) {
    throw std::invalid_argument("min_votes: " + std::to_string(config.min_votes) +
                                " is more than the references, expected at most " +
                                std::to_string(references));
  }
}

/// "underwood": explicit change detection between two scans.
MethodKind method_kind() {
  return {
      .name = "underwood",
      .title = "Underwood et al.",
      .source =
          "Underwood, Gillsjo, Bailey, Vlaskine: Explicit 3D Change Detection using Ray-Tracing in "
          "Spherical Coordinates, ICRA 2013",
      .summary = "points in space that a scan one second before saw past",
      .defaults = settings_of(Config{}),
      .check = check_settings<Config>,
      .make = make_method<Pipeline, Config>,
      .score_name = "margin, m",
      .threshold_name = "range tolerance, m"};
}

}  // namespace mosbench::underwood
