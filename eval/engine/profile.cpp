#include "eval/engine/profile.hpp"

#include <algorithm>
#include <iterator>
#include <memory>
#include <mosbench/method.hpp>

#include "core/base/stage_clock.hpp"
#include "datasets/text/numbers.hpp"
#include "eval/exec/child_process.hpp"
#include "eval/result/machine.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

using Clock = std::chrono::steady_clock;

/// What `work` costs.
template <typename Work>
Cost cost_of(Work&& work) {
  const Clock::time_point start = Clock::now();
  const double cpu_start_ms = process_cpu_ms();
  work();
  const double wall_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  return {wall_ms, process_cpu_ms() - cpu_start_ms};
}

std::optional<double> median_period_ms(const std::vector<std::int64_t>& stamps_ns) {
  std::vector<double> periods_ms;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    periods_ms.push_back(static_cast<double>(stamps_ns[i] - stamps_ns[i - 1]) * 1e-6);
  }
  if (periods_ms.empty()) return std::nullopt;
  const double median_ms = quantile(periods_ms, 0.5, QuantileRule::kNearestRank);
  return median_ms > 0 ? std::optional(median_ms) : std::nullopt;
}

/// Gives every stage to the scan in whose push it ran: a delayed one runs later than its own.
void add_stages(const std::vector<StageTime>& stages, SequenceProfile& profile) {
  for (const StageTime& stage : stages) {
    const auto later =
        std::ranges::upper_bound(profile.scans, stage.start, {}, &ScanProfile::start);
    // A stage that does not say when it began is the last scan's.
    ScanProfile& scan = later == profile.scans.begin() ? profile.scans.back() : *std::prev(later);
    scan.stages.push_back(stage);
    if (std::ranges::find(profile.stages, stage.name) == profile.stages.end()) {
      profile.stages.push_back(stage.name);
    }
  }
}

}  // namespace

SequenceProfile profile_sequence(const Sequence& sequence, const RunSettings& settings,
                                 std::size_t most_scans) {
  SequenceProfile profile{sequence.name(), settings.threads, std::nullopt, {}, {}, 0};
  take_most_memory_of_commands_mib();  // of commands before this one
  const std::size_t scans = std::min(sequence.size(), most_scans);
  // The whole length: the end of a delayed sequence is labelled in another way.
  RunContext context = context_of(sequence, settings);
  context.cpu_times = true;
  std::unique_ptr<Method> method = settings.method->make(settings.method_settings, context);
  std::vector<LabelledScan> finals;
  Progress progress("profile " + sequence.name(), scans);
  std::vector<std::int64_t> stamps_ns;
  Frame frame;
  for (std::size_t k = 0; k < scans; ++k) {
    ScanProfile& scan = profile.scans.emplace_back();
    scan.start = Clock::now();
    scan.read = cost_of([&] { sequence.read(k, frame); });
    if (frame.stamp_ns) stamps_ns.push_back(*frame.stamp_ns);
    scan.stem = frame.stem;
    scan.points = frame.points.size();
    scan.method = cost_of([&] { finals = push_scan(*method, sequence, k, frame); });
    scan.end = Clock::now();
    for (const LabelledScan& final_scan : finals) add_stages(final_scan.stages, profile);
    scan.resident_mib = resident_mib();
    scan.memory = method->memory();
    progress.advance();
  }
  for (const LabelledScan& final_scan : method->finish()) add_stages(final_scan.stages, profile);
  method.reset();  // a program's memory is known when it has ended
  profile.program_mib = take_most_memory_of_commands_mib();
  profile.period_ms = median_period_ms(stamps_ns);
  return profile;
}

}  // namespace mosbench
