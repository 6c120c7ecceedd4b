#include "eval/breakdown/breakdown.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>

#include "core/base/thread_pool.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

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

/// Points of moving objects with the property by which they are sorted.
struct SeenPoints {
  double property;
  std::size_t points, found;
};

/// Sorts into bins between edges; the last one has no upper end.
std::vector<RecallBin> binned(const std::vector<double>& edges, const char* unit,
                              const std::vector<SeenPoints>& seen) {
  std::vector<RecallBin> bins;
  for (std::size_t b = 0; b + 1 < edges.size(); ++b) {
    bins.push_back({fmt::format("{:g} to {:g} {}", edges[b], edges[b + 1], unit)});
  }
  bins.push_back({fmt::format("from {:g} {}", edges.back(), unit)});
  for (const auto& [property, points, found] : seen) {
    std::size_t b = 0;
    while (b + 1 < edges.size() && property >= edges[b + 1]) ++b;
    ++bins[b].count;
    bins[b].tp += found;
    bins[b].fn += points - found;
  }
  return bins;
}

ordered_json metrics_json(const Confusion& counts) {
  ordered_json json = counts_json(counts);
  for (const Metric metric : kBriefMetrics) {
    json[std::string(row_of(metric).key)] = json_or_null(metric_of(counts, metric));
  }
  return json;
}

ordered_json bins_json(const BinEdges& edges, const BinCounts& bins) {
  ordered_json json = ordered_json::array();
  for (std::size_t b = 0; b < bins.size(); ++b) {
    ordered_json bin = {
        {"from_m", edges[b] < -1e9 ? ordered_json(nullptr) : ordered_json(edges[b])}};
    bin["to_m"] = b + 1 < bins.size() ? ordered_json(edges[b + 1]) : ordered_json(nullptr);
    bin.update(metrics_json(bins[b]));
    json.push_back(std::move(bin));
  }
  return json;
}

/// `counted` is what the bins count: objects or sightings.
ordered_json recall_json(const char* counted, const std::vector<RecallBin>& bins) {
  ordered_json json = ordered_json::array();
  for (const RecallBin& bin : bins) {
    json.push_back({{"name", bin.name}, {counted, bin.count}, {"tp", bin.tp}, {"fn", bin.fn}});
  }
  return json;
}

ordered_json position(const Eigen::Vector3d& position_m) {
  return {position_m.x(), position_m.y(), position_m.z()};
}

std::vector<const ObjectTrack*> worst_of(const std::vector<ObjectTrack>& objects,
                                         std::size_t at_most) {
  std::vector<const ObjectTrack*> sorted;
  for (const ObjectTrack& object : objects) sorted.push_back(&object);
  std::ranges::stable_sort(sorted, std::ranges::greater{}, [](const ObjectTrack* object) {
    return object->points() - object->found();
  });
  sorted.resize(std::min(at_most, sorted.size()));
  return sorted;
}

ordered_json object_json(const SequenceBreakdown& breakdown, const ObjectTrack& object) {
  const Sighting& first = object.sightings.front();
  const Sighting& last = object.sightings.back();
  return {{"first_scan", breakdown.stems[first.scan_index]},
          {"last_scan", breakdown.stems[last.scan_index]},
          {"instance", first.cluster.instance},
          {"sightings", object.sightings.size()},
          {"points", object.points()},
          {"tp", object.found()},
          {"recall", object.recall()},
          {"mean_range_m", object.mean_range_m()},
          {"largest_size_m", object.largest_size_m()},
          {"speed_m_s", json_or_null(object.speed_m_s())},
          {"detection_delay_scans", json_or_null(object.detection_delay_scans())},
          {"first_position_map_m", position(first.cluster.centre_map_m)},
          {"last_position_map_m", position(last.cluster.centre_map_m)}};
}

Sheet bins_sheet(const char* title, const BinEdges& edges, const BinCounts& bins) {
  Sheet sheet{.columns = {{title, Unit::kText}}};
  for (const Metric metric : kBriefMetrics) {
    sheet.columns.push_back({std::string(row_of(metric).title), Unit::kPercent});
  }
  for (const char* name : {"TP", "FP", "FN"}) sheet.columns.push_back({name});
  for (std::size_t b = 0; b < bins.size(); ++b) {
    if (bins[b].tp + bins[b].fp + bins[b].fn == 0) continue;
    const std::string from = edges[b] < -1e9 ? "below" : fmt::format("{:g} to", edges[b]);
    std::vector<Cell>& cells = sheet.rows.emplace_back();
    cells.emplace_back(b + 1 < bins.size() ? fmt::format("{} {:g} m", from, edges[b + 1])
                                           : fmt::format("from {:g} m", edges[b]));
    for (const Metric metric : kBriefMetrics) {
      cells.push_back(or_missing(metric_of(bins[b], metric)));
    }
    cells.insert(cells.end(), {bins[b].tp, bins[b].fp, bins[b].fn});
  }
  return sheet;
}

Sheet recall_sheet(const char* title, const char* counted, const std::vector<RecallBin>& bins) {
  Sheet sheet{
      .columns = {{title, Unit::kText}, {counted}, {"recall", Unit::kPercent}, {"TP"}, {"FN"}}};
  for (const RecallBin& bin : bins) {
    if (bin.count == 0) continue;
    sheet.rows.push_back({bin.name, std::uint64_t{bin.count},
                          static_cast<double>(bin.tp) / static_cast<double>(bin.tp + bin.fn),
                          bin.tp, bin.fn});
  }
  return sheet;
}

Sheet objects_sheet(const SequenceBreakdown& breakdown, std::size_t at_most) {
  Sheet sheet{.columns = {{"worst objects", Unit::kText},
                          {"scans"},
                          {"points"},
                          {"recall", Unit::kPercent},
                          {"range m", Unit::kNumber, 1},
                          {"size m", Unit::kNumber, 1},
                          {"m/s", Unit::kNumber, 1},
                          {"delay"},
                          {"position in the map m"}}};
  for (const ObjectTrack* object : worst_of(breakdown.objects, at_most)) {
    const Sighting& first = object->sightings.front();
    const auto delay = object->detection_delay_scans();
    sheet.rows.push_back({"from " + breakdown.stems[first.scan_index],
                          std::uint64_t{object->sightings.size()}, std::uint64_t{object->points()},
                          object->recall(), object->mean_range_m(), object->largest_size_m(),
                          or_missing(object->speed_m_s()),
                          delay ? Cell(std::uint64_t{*delay}) : Cell("never"),
                          position_text(first.cluster.centre_map_m)});
  }
  return sheet;
}

Sheet false_positives_sheet(const SequenceBreakdown& breakdown, std::size_t at_most) {
  Sheet sheet{.columns = {{"worst false positives", Unit::kText},
                          {"points"},
                          {"range m", Unit::kNumber, 1},
                          {"size m", Unit::kNumber, 1},
                          {"position in the map m"}}};
  const auto& clusters = breakdown.false_positives;
  for (std::size_t i = 0; i < std::min(at_most, clusters.size()); ++i) {
    const ScanCluster& cluster = clusters[i].cluster;
    sheet.rows.push_back({"scan " + breakdown.stems[clusters[i].scan_index],
                          std::uint64_t{cluster.points}, cluster.range_m, cluster.size_m,
                          position_text(cluster.centre_map_m)});
  }
  return sheet;
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
  std::vector<SeenPoints> seen;
  for (const ObjectTrack& object : objects) {
    seen.push_back({object.largest_size_m(), object.points(), object.found()});
  }
  return binned({0.0, 0.5, 1.0, 2.0, 4.0, 8.0}, "m", seen);
}

std::vector<RecallBin> recall_by_speed(const std::vector<ObjectTrack>& objects) {
  std::vector<SeenPoints> seen;
  for (const ObjectTrack& object : objects) {
    const auto speed_m_s = object.speed_m_s();
    if (speed_m_s) seen.push_back({*speed_m_s, object.points(), object.found()});
  }
  return binned({0.0, 0.5, 1.0, 2.0, 5.0, 10.0}, "m/s", seen);
}

std::vector<RecallBin> recall_by_age(const std::vector<ObjectTrack>& objects) {
  std::vector<SeenPoints> seen;
  for (const ObjectTrack& object : objects) {
    for (const auto& [scan_index, unused, cluster] : object.sightings) {
      const std::size_t age_scans = scan_index - object.sightings.front().scan_index;
      seen.push_back({static_cast<double>(age_scans), cluster.points, cluster.found});
    }
  }
  return binned({0.0, 1.0, 4.0, 10.0, 30.0, 100.0}, "scans", seen);
}

ordered_json to_json(const SequenceBreakdown& breakdown, std::size_t at_most) {
  ordered_json json = {
      {"name", breakdown.sequence},
      {"scans", breakdown.scans.size()},
      {"by_range", bins_json(kRangeEdges_m, breakdown.by_range)},
      {"by_height", bins_json(kHeightEdges_m, breakdown.by_height)},
      {"by_object_size", recall_json("objects", recall_by_size(breakdown.objects))},
      {"by_object_speed", recall_json("objects", recall_by_speed(breakdown.objects))},
      {"by_object_age", recall_json("sightings", recall_by_age(breakdown.objects))},
      {"speed_clock", breakdown.stamped ? "stamps" : "10 Hz assumed"},
      {"object_count", breakdown.objects.size()},
      {"objects", ordered_json::array()},
      {"false_positive_clusters", ordered_json::array()}};
  if (breakdown.reasons) json["by_reason"] = to_json(*breakdown.reasons);
  for (const ObjectTrack* object : worst_of(breakdown.objects, at_most)) {
    json["objects"].push_back(object_json(breakdown, *object));
  }
  const auto& clusters = breakdown.false_positives;
  for (std::size_t i = 0; i < std::min(at_most, clusters.size()); ++i) {
    const ScanCluster& cluster = clusters[i].cluster;
    json["false_positive_clusters"].push_back({{"scan", breakdown.stems[clusters[i].scan_index]},
                                               {"points", cluster.points},
                                               {"range_m", cluster.range_m},
                                               {"size_m", cluster.size_m},
                                               {"position_map_m", position(cluster.centre_map_m)}});
  }
  return json;
}

std::vector<Sheet> breakdown_sheets(const SequenceBreakdown& breakdown, const BreakdownParts& parts,
                                    std::size_t at_most) {
  const std::string headline = fmt::format(
      "sequence {}: {}, {}, speeds {}", breakdown.sequence, counted(breakdown.scans.size(), "scan"),
      counted(breakdown.objects.size(), "moving object"),
      breakdown.stamped ? "by the scans' stamps"
                        : "as if scans came at 10 Hz, as not all have rising stamps");
  std::vector<Sheet> sheets;
  const auto& objects = breakdown.objects;
  if (parts.range) sheets.push_back(bins_sheet("range", kRangeEdges_m, breakdown.by_range));
  if (parts.height) {
    sheets.push_back(bins_sheet("height above sensor", kHeightEdges_m, breakdown.by_height));
  }
  if (parts.object) {
    sheets.push_back(recall_sheet("object size", "objects", recall_by_size(objects)));
    sheets.push_back(recall_sheet("object speed", "objects", recall_by_speed(objects)));
    sheets.push_back(recall_sheet("scans since first seen", "sightings", recall_by_age(objects)));
    sheets.push_back(objects_sheet(breakdown, at_most));
    sheets.push_back(false_positives_sheet(breakdown, at_most));
  }
  if (breakdown.reasons) sheets.push_back(reasons_sheet(*breakdown.reasons));
  sheets.front().lead.push_back(headline);
  return sheets;
}

}  // namespace mosbench
