#include "core/methods/hmm_mos/pipeline.hpp"

#include <utility>

#include "core/base/stage_clock.hpp"
#include "core/methods/hmm_mos/label_projection.hpp"

namespace mosbench::hmm_mos {

Pipeline::Pipeline(const Config& config, const RunContext& context)
    : MappedMethod(checked(config), context), config_(config) {}

std::vector<LabelledScan> Pipeline::entered(ObservedScan& current) {
  const std::uint32_t k = mapping().k();
  if (!detector_) detector_.emplace(config_, mapping().grid());
  LabelledScan result = begun_result(current, k);
  held_.push_back({std::move(current.scan), std::move(result)});

  const DueScans due = due_at(k, config_, context().scan_count);
  if (due.none_yet) detector_->skip();
  if (due.oldest) judge(held_.front());
  if (due.newest) judge(held_.back());
  const auto n = static_cast<std::size_t>(config_.delay_scans);
  return held_.size() > n ? release(1) : std::vector<LabelledScan>{};
}

void Pipeline::judge(HeldScan& held) {
  LabelledScan& result = held.result;
  const StageRecord record{result.stages, context().cpu_times};
  const Detection found =
      detector_->detect(held.scan, mapping().map(), mapping().k(), mapping().pool(), record);
  result.judged = true;
  result.threshold = found.threshold;
  const StageClock clock(record, "labels");
  result.labels = project_labels(held.scan, found.moving);
  if (context().scores) result.scores = project_scores(held.scan, found.sums);
}

/// Returns the oldest held scans; points of scans that were not judged are static.
std::vector<LabelledScan> Pipeline::release(std::size_t count) {
  std::vector<LabelledScan> results;
  for (; count > 0; --count) {
    const std::size_t points = held_.front().scan.voxel_of_point.size();
    LabelledScan& result = results.emplace_back(std::move(held_.front().result));
    held_.pop_front();
    result.labels.resize(points, kStaticLabel);
    if (context().scores) result.scores.resize(points, 0);
  }
  return results;
}

std::size_t Pipeline::held_bytes() const {
  std::size_t bytes = detector_ ? detector_->memory_bytes() : 0;
  for (const HeldScan& held : held_) {
    bytes += held.scan.memory_bytes() + held.result.labels.capacity() * sizeof(std::uint32_t) +
             held.result.scores.capacity() * sizeof(float);
  }
  return bytes;
}

std::vector<std::string> Pipeline::remarks() const { return remarks_on_delay(config_, context()); }

std::vector<std::string> remarks_on_delay(const Config& config, const RunContext& context) {
  const auto delay = static_cast<std::size_t>(config.delay_scans);
  if (delay == 0 || !context.scan_count) return {};
  const std::string scans = std::to_string(delay) + " scans";
  if (*context.scan_count <= delay) {
    return {"shorter than the delay of " + scans + ": every scan is labelled static"};
  }
  return {"the last " + scans + " have no " + std::to_string(delay) +
          " later ones: the first of them is labelled static and the others are judged online, as "
          "the authors' program does"};
}

}  // namespace mosbench::hmm_mos
