#include "eval/breakdown/breakdown.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "core/base/thread_pool.hpp"
#include "eval/breakdown/object_tracks.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

/// Largest clusters of false positives that are kept per scan; the rest are mostly single points.
constexpr std::size_t kFalseClustersPerScan = 50;

std::vector<ScanBreakdown> per_scan(const Sequence& sequence, const std::vector<std::size_t>& scans,
                                    const Predictions& predictions, const BreakdownTask& task) {
  std::vector<ScanBreakdown> parts(scans.size());
  ThreadPool pool(task.threads);
  Progress progress("break down " + sequence.name(), scans.size());
  std::mutex progress_mutex;
  pool.for_ranges(scans.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < end; ++i) {
      const Frame frame = sequence.read(scans[i]);
      parts[i] = break_down_scan(*task.protocol, task.range, frame, predictions.read(scans[i]));
      if (parts[i].false_positives.size() > kFalseClustersPerScan) {
        parts[i].false_positives.resize(kFalseClustersPerScan);
      }
      const std::lock_guard lock(progress_mutex);
      progress.advance();
    }
  });
  return parts;
}

void add(const BinCounts& part, BinCounts& sum) {
  for (std::size_t b = 0; b < sum.size(); ++b) sum[b] += part[b];
}

/// Bins between edges; the last one has no upper end.
class Bins {
 public:
  Bins(std::vector<double> edges, const char* unit) : edges_(std::move(edges)) {
    for (std::size_t b = 0; b < edges_.size(); ++b) {
      bins_.push_back({b + 1 < edges_.size()
                           ? fmt::format("{:g} to {:g} {}", edges_[b], edges_[b + 1], unit)
                           : fmt::format("from {:g} {}", edges_[b], unit)});
    }
  }
  RecallBin& at(double value) {
    std::size_t b = 0;
    while (b + 1 < edges_.size() && value >= edges_[b + 1]) ++b;
    return bins_[b];
  }
  std::vector<RecallBin> take() { return std::move(bins_); }

 private:
  std::vector<double> edges_;
  std::vector<RecallBin> bins_;
};

void add(const ObjectTrack& object, RecallBin& bin) {
  ++bin.count;
  bin.tp += object.found();
  bin.fn += object.points() - object.found();
}

}  // namespace

SequenceBreakdown break_down(const Sequence& sequence, const std::vector<std::size_t>& scans,
                             const Predictions& predictions, const BreakdownTask& task) {
  SequenceBreakdown breakdown;
  breakdown.sequence = sequence.name();
  breakdown.scans = scans;
  for (std::size_t k = 0; k < sequence.size(); ++k) breakdown.stems.push_back(sequence.stem(k));
  const ScanClock times = scan_times(sequence, scans);
  breakdown.stamped = times.stamped;
  std::vector<ScanObjects> objects;
  std::vector<ScanBreakdown> parts = per_scan(sequence, scans, predictions, task);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    add(parts[i].by_range, breakdown.by_range);
    add(parts[i].by_height, breakdown.by_height);
    objects.push_back({scans[i], times.times_s[i], std::move(parts[i].objects)});
    for (const ScanCluster& cluster : parts[i].false_positives) {
      breakdown.false_positives.push_back({scans[i], cluster});
    }
  }
  breakdown.objects = link_objects(objects);
  std::ranges::stable_sort(breakdown.false_positives, std::ranges::greater{},
                           [](const FalseCluster& found) { return found.cluster.points; });
  return breakdown;
}

std::vector<RecallBin> recall_by_size(const std::vector<ObjectTrack>& objects) {
  Bins bins({0.0, 0.5, 1.0, 2.0, 4.0, 8.0}, "m");
  for (const ObjectTrack& object : objects) add(object, bins.at(object.largest_size_m()));
  return bins.take();
}

std::vector<RecallBin> recall_by_speed(const std::vector<ObjectTrack>& objects) {
  Bins bins({0.0, 0.5, 1.0, 2.0, 5.0, 10.0}, "m/s");
  for (const ObjectTrack& object : objects) {
    if (const auto speed_m_s = object.speed_m_s()) add(object, bins.at(*speed_m_s));
  }
  return bins.take();
}

std::vector<RecallBin> recall_by_age(const std::vector<ObjectTrack>& objects) {
  Bins bins({0.0, 1.0, 4.0, 10.0, 30.0, 100.0}, "scans");
  for (const ObjectTrack& object : objects) {
    for (const Sighting& sighting : object.sightings) {
      const std::size_t age = sighting.scan_index - object.sightings.front().scan_index;
      RecallBin& bin = bins.at(static_cast<double>(age));
      ++bin.count;
      bin.tp += sighting.cluster.found;
      bin.fn += sighting.cluster.points - sighting.cluster.found;
    }
  }
  return bins.take();
}

}  // namespace mosbench
