#include "eval/runs/sequence_runner.hpp"

#include <algorithm>
#include <chrono>
#include <deque>
#include <future>
#include <stdexcept>

#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/files/label_file.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "eval/results/dynamic_score_file.hpp"
#include "eval/results/machine.hpp"
#include "eval/results/progress.hpp"

namespace mosbench {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// What scoring needs of a scan until its labels are final.
struct PendingScan {
  std::optional<std::vector<std::uint32_t>> truth;
  std::vector<Point> truth_points;  ///< only with truth, and only when the protocol has a range
};

/// A scan that was read and observed.
struct ReadyScan {
  Frame frame;
  std::unique_ptr<Observed> observed;
  double observe_ms;
};

/// What `work` returns; its std::range_error becomes a DataError that names the scan.
template <typename Work>
auto naming_scan(const Sequence& sequence, std::size_t scan_index, Work&& work) {
  try {
    return work();
  } catch (const std::range_error& error) {
    const auto own_file = sequence.scan_file(scan_index);
    throw DataError(
        own_file.value_or(std::filesystem::path(sequence.name()) / sequence.stem(scan_index)),
        error.what(), "points and poses within reach of the voxel grid");
  }
}

class SequenceRun {
 public:
  SequenceRun(const Sequence& sequence, const RunSettings& settings,
              const std::filesystem::path& folder)
      : sequence_(sequence),
        settings_(settings),
        folder_(folder),
        // A deferred task runs inside get(), on this thread: one thread then means one thread.
        launch_(settings.threads > 1 ? std::launch::async : std::launch::deferred),
        method_(
            settings.method->make(settings.method_settings, {.threads = settings.threads,
                                                             .scan_count = sequence.size(),
                                                             .scores = settings.keeps_scores})) {
    // What stays is allocated before the large buffers that come and go.
    rows_.scans.resize(sequence.size());
    rows_.costs.resize(sequence.size());
    for (std::size_t k = 0; k < sequence.size(); ++k) rows_.scans[k].stem = sequence.stem(k);
  }

  SequenceRows run() {
    const Clock::time_point start = Clock::now();
    Progress progress(sequence_.name(), sequence_.size());
    std::future<ReadyScan> upcoming = prepare(0);
    for (std::size_t k = 0; k < sequence_.size(); ++k) {
      const Clock::time_point read_start = Clock::now();
      ReadyScan ready = upcoming.get();
      rows_.costs[k].read_ms = milliseconds_since(read_start);
      if (launch_ == std::launch::deferred) rows_.costs[k].read_ms -= ready.observe_ms;
      if (k + 1 < sequence_.size()) upcoming = prepare(k + 1);
      push(k, std::move(ready));
      progress.advance();
    }
    for (LabelledScan& result : method_->finish()) accept(std::move(result));
    finish_settling();
    rows_.fingerprint = fingerprint_.hex();
    rows_.remarks = method_->remarks();
    rows_.wall_s = milliseconds_since(start) / 1e3;
    return std::move(rows_);
  }

 private:
  std::future<ReadyScan> prepare(std::size_t scan_index) {
    // One scan at a time, so the fingerprint sees the frames in order.
    return std::async(launch_, [this, scan_index, frame = std::move(spent_)]() mutable {
      sequence_.read(scan_index, frame);
      fingerprint_.add(frame);
      const Clock::time_point start = Clock::now();
      std::unique_ptr<Observed> observed = naming_scan(sequence_, scan_index, [&] {
        return method_->observe(frame.points, frame.map_from_sensor);
      });
      return ReadyScan{std::move(frame), std::move(observed), milliseconds_since(start)};
    });
  }

  void push(std::size_t scan_index, ReadyScan ready) {
    const Clock::time_point start = Clock::now();
    std::vector<LabelledScan> finals = method_->push(std::move(ready.observed));
    rows_.costs[scan_index].push_ms = ready.observe_ms + milliseconds_since(start);
    rows_.costs[scan_index].resident_mib = resident_mib();
    remember(std::move(ready.frame));
    for (LabelledScan& result : finals) accept(std::move(result));
  }

  void remember(Frame frame) {
    PendingScan& scan = pending_.emplace_back();
    scan.truth = std::move(frame.truth);
    if (scan.truth && settings_.protocol->range_rule != RangeRule::kNone) {
      scan.truth_points = std::move(frame.points);
    }
    spent_ = std::move(frame);
  }

  void accept(LabelledScan result) {
    add_stages(result.stages, rows_, rows_.costs[result.scan_index]);
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
    ScanRow& row = rows_.scans[result.scan_index];
    row.points = result.labels.size();
    row.predicted_moving_points =
        static_cast<std::size_t>(std::ranges::count(result.labels, kMovingLabel));
    row.nonfinite_points = result.nonfinite_points;
    row.threshold = result.threshold;
    row.judged = result.judged;
    if (!scan.truth) return;
    row.counts = score_scan(*settings_.protocol, *scan.truth, result.labels, scan.truth_points,
                            settings_.range);
    row.truth_hash = truth_hash(*scan.truth);
  }

  void write(const LabelledScan& result) const {
    const std::string& stem = rows_.scans[result.scan_index].stem;
    write_labels(folder_ / "labels" / (stem + ".label"), result.labels);
    if (!settings_.keeps_scores) return;
    write_file_atomic(dynamic_score_file(folder_, stem), format_dynamic_scores(result.scores));
  }

  void finish_settling() {
    if (!settling_.valid()) return;
    std::vector<Point> points = settling_.get();
    if (spent_.points.empty()) spent_.points = std::move(points);
  }

  const Sequence& sequence_;
  const RunSettings& settings_;
  const std::filesystem::path& folder_;
  std::launch launch_;
  std::unique_ptr<Method> method_;
  ContentFingerprint fingerprint_;
  std::deque<PendingScan> pending_;
  Frame spent_;  ///< gives its memory to a coming frame
  SequenceRows rows_;
  /// Gives the points back that it scored with. Last: its end is awaited before what it uses goes.
  std::future<std::vector<Point>> settling_;
};

}  // namespace

SequenceRows run_sequence(const Sequence& sequence, const RunSettings& settings,
                          const std::filesystem::path& folder) {
  return SequenceRun(sequence, settings, folder).run();
}

std::vector<LabelledScan> push_scan(Method& method, const Sequence& sequence,
                                    std::size_t scan_index, const Frame& frame) {
  return naming_scan(sequence, scan_index,
                     [&] { return method.push(frame.points, frame.map_from_sensor); });
}

}  // namespace mosbench
