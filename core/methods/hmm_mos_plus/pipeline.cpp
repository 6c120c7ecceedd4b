#include "core/methods/hmm_mos_plus/pipeline.hpp"

#include <memory>
#include <string>
#include <utility>

#include "core/base/method_row.hpp"
#include "core/base/stage_clock.hpp"
#include "core/methods/hmm_mos/pipeline.hpp"
#include "core/methods/hmm_mos_plus/config.hpp"
#include "core/methods/hmm_mos_plus/objects.hpp"
#include "core/tracks/judged_by_tracks.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos_plus {
namespace {

/// Returns the scores of a scan's points.
std::vector<float> seed_shares(const VoxelizedScan& scan,
                               const std::vector<Component>& components) {
  std::vector<float> of_voxel(scan.measured.block_count() * kBlockVoxels);
  for (const Component& component : components) {
    for (const std::uint32_t voxel : component.voxels) {
      of_voxel[voxel] = static_cast<float>(component.seed_share);
    }
  }
  std::vector<float> scores;
  for (const std::uint32_t voxel : scan.voxel_of_point) {
    scores.push_back(voxel == kNoVoxel ? 0 : of_voxel[voxel]);
  }
  return scores;
}

/// Returns why a scan's points move; `other` is why voxels are seeds that did not arrive.
std::vector<Reason> reasons_of(const VoxelizedScan& scan, const ScanMasks& arrived,
                               const ScanMasks& seeds, Reason other, const Motion& motion) {
  const auto reason_of = [&](std::uint32_t voxel) {
    const std::uint32_t slot = voxel / kBlockVoxels, cell = voxel % kBlockVoxels;
    if (!motion.objects[slot].test(cell)) {
      return motion.feet[slot].test(cell) ? Reason::kFeet : Reason::kNone;
    }
    if (!seeds[slot].test(cell)) return Reason::kGrown;
    return arrived[slot].test(cell) ? Reason::kArrived : other;
  };
  std::vector<Reason> reasons;
  for (const std::uint32_t voxel : scan.voxel_of_point) {
    reasons.push_back(voxel == kNoVoxel ? Reason::kNone : reason_of(voxel));
  }
  return reasons;
}

}  // namespace

Pipeline::Pipeline(const Config& config, const RunContext& context)
    : MappedMethod(checked(config).map, context),
      config_(config),
      tracks_(config),
      look_back_(config),
      attachments_(config),
      memory_(context.stamps_ns) {
  tell(memory_);
}

RememberedMap Pipeline::remembered() { return {map(), memory_, k()}; }

std::vector<LabelledScan> Pipeline::entered(hmm_mos::ObservedScan& current, LabelledScan begun) {
  HeldScan& held = held_.emplace_back();
  held.result = std::move(begun);
  held.scan = std::move(current.scan);
  held.tick = memory_.tick();
  const StageRecord record{held.result.stages, context().cpu_times};
  held.classes =
      timed(record, "arrivals", [&] { return classify(held.scan, remembered(), config_, pool()); });
  const auto n = static_cast<std::size_t>(config_.map.delay_scans);
  return held_.size() > n ? release(1) : std::vector<LabelledScan>{};
}

/// Labels a held scan with the map as it is now.
void Pipeline::judge(HeldScan& held) {
  const VoxelizedScan& scan = held.scan;
  LabelledScan& result = held.result;
  const StageRecord record{result.stages, context().cpu_times};
  const ScanMasks arrived = context().scores ? held.classes.seeds : ScanMasks();
  if (config_.map.delay_scans > 0) {
    const StageClock clock(record, "departures");
    add_departures(scan, remembered(), config_, pool(), held.classes);
  }
  const auto ground =
      timed(record, "ground", [&] { return std::make_shared<const Ground>(scan, config_); });
  LowVoxels low(scan, *ground);
  ArrivalClasses& classes = held.classes;
  if (predicts()) {
    timed(record, "look_back",
          [&] { look_back_.enter(scan, classes, ground, held.tick, remembered(), pool()); });
    const StageClock clock(record, "prediction");
    look_back_.add_seeds(scan, low, classes);
    tracks_.add_seeds(scan, low, held.tick, classes);
  }
  const Motion motion = timed(record, "objects", [&] {
    std::vector<Component> found = find_components(scan, classes, *ground, low, config_);
    tracks_.follow(scan, found, held.tick);
    attachments_.judge(scan, classes, low, held.tick.at, remembered(), found);
    return motion_of(scan, classes, low, std::move(found));
  });
  const StageClock clock(record, "labels");
  ScanMasks moving = motion.objects;
  for (std::size_t i = 0; i < moving.size(); ++i) moving[i] = moving[i] | motion.feet[i];
  result.labels = project_labels(scan, moving);
  if (context().scores) {
    result.scores = seed_shares(scan, motion.components);
    const Reason other = config_.map.delay_scans > 0 ? Reason::kDeparted : Reason::kPredicted;
    result.reasons = reasons_of(scan, arrived, classes.seeds, other, motion);
  }
  result.threshold = config_.min_seed_share;
  result.judged = k() > 0;  // the first scan has nothing to have arrived since
}

std::vector<LabelledScan> Pipeline::release(std::size_t count) {
  std::vector<LabelledScan> results;
  for (; count > 0; --count) {
    judge(held_.front());
    results.push_back(std::move(held_.front().result));
    held_.pop_front();
  }
  return results;
}

std::size_t Pipeline::held_bytes() const {
  std::size_t bytes = tracks_.memory_bytes() + look_back_.memory_bytes() +
                      attachments_.memory_bytes() + memory_.memory_bytes();
  for (const HeldScan& held : held_) {
    bytes += held.scan.memory_bytes() + held.classes.memory_bytes();
  }
  return bytes;
}

std::vector<std::string> Pipeline::remarks() const {
  // The end of a sequence is labelled otherwise than by hmm-mos.
  return hmm_mos::remarks_on_delay(config_.map, {});
}

void check(const Config& config) {
  check_ranges(config);
  hmm_mos::check(config.map);
}

/// "hmm-mos-plus": the paper's method, completed to objects.
MethodKind method_kind() {
  return {.name = "hmm-mos-plus",
          .title = "HMM-MOS plus",
          .source = "mosbench, docs/methods/hmm_mos_plus.md",
          .summary = "objects that arrive in space known to be free, on the map of hmm-mos",
          .defaults = settings_of(Config{}),
          .check = check_settings<Config>,
          .make = tracks::make_method<Pipeline, Config>,
          .score_name = "share of seeds",
          .threshold_name = "least share of seeds",
          .takes_origins = true,
          .gives_reasons = true,
          .words = {{.name = "moving",
                     .usual = "now",
                     .value = "ever",
                     .number = "SECONDS",
                     .takes = {"seed_age_s", "object_age_s", "fresh_age_s"},
                     .sets = {{"max_aged_share", 1}},
                     .lacking = "does not remember what moved"}}};
}

}  // namespace mosbench::hmm_mos_plus
