#include "eval/engine/sequence_runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <future>
#include <iterator>
#include <memory>
#include <stdexcept>

#include "core/base/stage_clock.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/doctor/doctor.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/layouts/kitti_sequence.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/sequence/stamps.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/numbers.hpp"
#include "eval/engine/window_remark.hpp"
#include "eval/exec/child_process.hpp"
#include "eval/exec/exec_method.hpp"
#include "eval/exec/pipe_messages.hpp"
#include "eval/protocols/unsure.hpp"
#include "eval/result/machine.hpp"
#include "eval/result/result_scans.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// What scoring needs of a scan until its labels are final.
struct PendingScan {
  std::size_t points = 0;
  std::optional<std::vector<std::uint32_t>> truth;
  std::vector<Point> truth_points;  ///< only with truth, and only when the protocol has a range
};

/// A scan that was read and observed.
struct ReadyScan {
  Frame frame;
  std::unique_ptr<Observed> observed;
  double observe_ms;
};

/// What `work` returns; its std::range_error or ProgramError becomes a DataError that names the
/// scan.
template <typename Work>
auto naming_scan(const Sequence& sequence, std::size_t scan_index, Work&& work) {
  const auto scan = [&] {
    const auto own_file = sequence.scan_file(scan_index);
    return own_file.value_or(std::filesystem::path(sequence.name()) / sequence.stem(scan_index));
  };
  try {
    return work();
  } catch (const std::range_error& error) {
    throw DataError(scan().string() + ": " + error.what());  // which says what was expected
  } catch (const ProgramError& error) {
    throw DataError(scan(), error.wrong(), error.expected());
  }
}

/// Returns the conditions under which the method of `settings` runs on a sequence.
RunContext context_of(const Sequence& sequence, const RunSettings& settings) {
  RunContext context{
      .threads = settings.threads, .scan_count = sequence.size(), .scores = settings.keeps_scores};
  for (const ScanEntry& scan : sequence.recording().scans) {
    if (scan.stamp_ns) context.stamps_ns.push_back(*scan.stamp_ns);
  }
  if (context.stamps_ns.size() != sequence.size()) context.stamps_ns.clear();
  return context;
}

class SequenceRun {
 public:
  SequenceRun(const Sequence& sequence, const RunSettings& settings,
              const std::optional<std::filesystem::path>& folder)
      : sequence_(sequence),
        settings_(settings),
        folder_(folder),
        // A deferred task runs inside get(), on this thread: one thread then means one thread.
        launch_(settings.threads > 1 ? std::launch::async : std::launch::deferred),
        method_(settings.method->make(settings.method_settings, context_of(sequence, settings))) {
    // What stays is allocated before the large buffers that come and go.
    found_.scans.resize(sequence.size());
    timing_.threads = settings.threads;
    timing_.costs.resize(sequence.size());
    for (std::size_t k = 0; k < sequence.size(); ++k) found_.scans[k].stem = sequence.stem(k);
  }

  Result run() {
    const Clock::time_point start = Clock::now();
    Progress progress(title_of(sequence_, settings_), sequence_.size());
    std::future<ReadyScan> upcoming = prepare(0);
    for (std::size_t k = 0; k < sequence_.size(); ++k) {
      const Clock::time_point read_start = Clock::now();
      ReadyScan ready = upcoming.get();
      timing_.costs[k].read_ms = milliseconds_since(read_start);
      if (launch_ == std::launch::deferred) timing_.costs[k].read_ms -= ready.observe_ms;
      if (k + 1 < sequence_.size()) upcoming = prepare(k + 1);
      push(k, std::move(ready));
      progress.advance();
    }
    const std::size_t last = sequence_.size() - 1;
    for (LabelledScan& result : naming_scan(sequence_, last, [&] { return method_->finish(); })) {
      accept(std::move(result));
    }
    finish_settling();
    if (!pending_.empty()) fault(fmt::format("leaves {} scans without labels", pending_.size()));
    found_.from.fingerprint = fingerprint_.hex();
    found_.from.fingerprint_without_poses = fingerprint_without_poses_.hex();
    found_.remarks = method_->remarks();
    add_window_remark();
    if (auto doubt = sweeps_.doubt()) found_.doubts.push_back(std::move(*doubt));
    if (std::string open = unsure_.text(rule_); !open.empty())
      found_.doubts.push_back(std::move(open));
    timing_.wall_s = milliseconds_since(start) / 1e3;
    found_.timing = std::move(timing_);
    return std::move(found_);
  }

 private:
  /// A program of the user's names its settings as it likes.
  void add_window_remark() {
    if (settings_.method->name == kExecKind) return;
    const auto step_s = usual_step_s(sequence_.recording().scans);
    std::string remark = window_remark(settings_.method_settings, step_s);
    if (!remark.empty()) found_.remarks.push_back(std::move(remark));
  }

  std::future<ReadyScan> prepare(std::size_t scan_index) {
    // One scan at a time, so the fingerprints see the frames in order.
    return std::async(launch_, [this, scan_index, frame = std::move(spent_)]() mutable {
      sequence_.read(scan_index, frame);
      sweeps_.add(scan_index, frame);
      fingerprint_.add(frame);
      fingerprint_without_poses_.add(frame);
      const Clock::time_point start = Clock::now();
      std::unique_ptr<Observed> observed = naming_scan(sequence_, scan_index, [&] {
        return method_->observe(frame.points, frame.map_from_sensor, frame.origins);
      });
      return ReadyScan{std::move(frame), std::move(observed), milliseconds_since(start)};
    });
  }

  void push(std::size_t scan_index, ReadyScan ready) {
    const Clock::time_point start = Clock::now();
    std::vector<LabelledScan> finals = naming_scan(
        sequence_, scan_index, [&] { return method_->push(std::move(ready.observed)); });
    timing_.costs[scan_index].push_ms = ready.observe_ms + milliseconds_since(start);
    timing_.costs[scan_index].resident_mib =
        resident_mib() - static_cast<double>(sequence_.kept_bytes()) / (1 << 20);
    remember(std::move(ready.frame));
    for (LabelledScan& result : finals) accept(std::move(result));
  }

  void remember(Frame frame) {
    PendingScan& scan = pending_.emplace_back();
    scan.points = frame.points.size();
    scan.truth = std::move(frame.truth);
    if (scan.truth && settings_.protocol->range_rule != RangeRule::kNone) {
      scan.truth_points = std::move(frame.points);
    }
    spent_ = std::move(frame);
  }

  /// A method is code of others: what it must not return is a fault of it, never a number.
  void check(const LabelledScan& result) {
    if (pending_.empty() || result.scan_index != accepted_) {
      fault(fmt::format("labels scan {}, expected {}", result.scan_index, accepted_));
    }
    const std::size_t points = pending_.front().points;
    const PointFiles wanted = settings_.point_files();
    const std::size_t scores = wanted.scores ? points : result.scores.size();
    const std::size_t reasons = wanted.reasons ? points : result.reasons.size();
    const std::size_t objects = wanted.objects ? points : result.objects.size();
    if (result.labels.size() != points || result.scores.size() != scores ||
        result.reasons.size() != reasons || result.objects.size() != objects) {
      fault(fmt::format(
          "has {} labels, {} scores, {} reasons and {} objects for the {} points of scan {}",
          result.labels.size(), result.scores.size(), result.reasons.size(), result.objects.size(),
          points, accepted_));
    }
    ++accepted_;
  }

  [[noreturn]] void fault(const std::string& wrong) const {
    throw std::logic_error(fmt::format("method {} {}", settings_.method->name, wrong));
  }

  void accept(LabelledScan result) {
    check(result);
    add_stages(result.stages, timing_, timing_.costs[result.scan_index]);
    finish_settling();
    settling_ = std::async(
        launch_, [this, scan = std::move(pending_.front()), result = std::move(result)]() mutable {
          score(scan, result);
          write(result);
          return std::move(scan.truth_points);
        });
    pending_.pop_front();
  }

  void score(const PendingScan& scan, const LabelledScan& result) {
    ScanRow& row = found_.scans[result.scan_index];
    row.points = result.labels.size();
    row.predicted_moving_points =
        static_cast<std::size_t>(std::ranges::count(result.labels, kMovingLabel));
    row.nonfinite_points = result.nonfinite_points;
    row.threshold = result.threshold;
    row.judged = result.judged;
    row.label_hash = hash_of_labels(result.labels);
    if (!scan.truth) return;
    row.counts = score_scan(*settings_.protocol, *scan.truth, result.labels, scan.truth_points,
                            settings_.range);
    if (is_unsure_) {
      unsure_.add(rule_, *scan.truth, result.labels, scan.truth_points);
    }
    row.truth_hash = hash_of_labels(*scan.truth);
  }

  void write(const LabelledScan& result) const {
    if (!folder_) return;
    const std::string& stem = found_.scans[result.scan_index].stem;
    write_labels(*folder_ / "labels" / (stem + ".label"), result.labels);
    const PointFiles wanted = settings_.point_files();
    if (wanted.scores) {
      write_file_atomic(dynamic_score_file(*folder_, stem), format_dynamic_scores(result.scores));
    }
    if (wanted.reasons) {
      write_file_atomic(reason_file(*folder_, stem), format_reasons(result.reasons));
    }
    if (wanted.objects) write_labels(object_file(*folder_, stem), result.objects);
  }

  void finish_settling() {
    if (!settling_.valid()) return;
    std::vector<Point> points = settling_.get();
    if (spent_.points.empty()) spent_.points = std::move(points);
  }

  const Sequence& sequence_;
  const RunSettings& settings_;
  const std::optional<std::filesystem::path>& folder_;
  const ScoreRule rule_{settings_.protocol, settings_.range};
  const bool is_unsure_ = has_unsure_truth(sequence_.recording());
  UnsureBounds unsure_;
  std::launch launch_;
  std::unique_ptr<Method> method_;
  SweepWatch sweeps_{sequence_};
  ContentFingerprint fingerprint_;
  ContentFingerprint fingerprint_without_poses_{ContentFingerprint::Of::kAllButPoses};
  std::deque<PendingScan> pending_;
  std::size_t accepted_ = 0;  ///< results
  Frame spent_;               ///< gives its memory to a coming frame
  Result found_;
  Timing timing_;
  /// Gives the points back that it scored with. Last: its end is awaited before what it uses goes.
  std::future<std::vector<Point>> settling_;
};

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

std::string title_of(const Sequence& sequence, const RunSettings& settings) {
  const std::string& name = sequence.name();
  return settings.is_one_of_several ? fmt::format("{}, {}", settings.method->name, name) : name;
}

Result run_sequence(const Sequence& sequence, const RunSettings& settings,
                    const std::optional<std::filesystem::path>& folder) {
  return SequenceRun(sequence, settings, folder).run();
}

std::vector<LabelledScan> push_scan(Method& method, const Sequence& sequence,
                                    std::size_t scan_index, const Frame& frame) {
  return naming_scan(sequence, scan_index, [&] {
    return method.push(frame.points, frame.map_from_sensor, frame.origins);
  });
}

SequenceProfile profile_sequence(const Sequence& sequence, const RunSettings& settings,
                                 std::size_t most_scans) {
  SequenceProfile profile{sequence.name(), settings.threads, std::nullopt, {}, {}};
  take_cost_of_commands();  // of commands before this one
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
  const CommandCost program = take_cost_of_commands();
  profile.program_mib = program.most_memory_mib;
  profile.program_cpu_s = program.cpu_s;
  profile.period_ms = median_period_ms(stamps_ns);
  return profile;
}

}  // namespace mosbench
