#include "eval/statistics/statistics_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "eval/answer/answer_text.hpp"
#include "eval/answer/csv.hpp"
#include "eval/answer/text_table.hpp"
#include "eval/protocols/counts_json.hpp"
#include "eval/statistics/scan_spacing.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

template <typename Value>
ordered_json spread_json(const Value& value) {
  return {{"value", json_or_null(value.value)},
          {"standard_error", json_or_null(value.standard_error)},
          {"low", value.interval ? ordered_json(value.interval->low) : ordered_json(nullptr)},
          {"high", value.interval ? ordered_json(value.interval->high) : ordered_json(nullptr)},
          {"no_interval",
           value.no_interval.empty() ? ordered_json(nullptr) : ordered_json(value.no_interval)}};
}

std::vector<std::string> estimate_cells(const std::string& name, std::size_t scans,
                                        const Estimates& estimates) {
  std::vector<std::string> cells = {name, fmt::format("{}", scans)};
  for (const Estimate& metric : estimates.metrics) {
    cells.push_back(percent_text(metric.value));
    cells.push_back(interval_text(metric.interval, "{:.1f}"));
  }
  return cells;
}

/// Says per row why its IoU has no interval; empty where all have one.
std::string no_intervals(const std::vector<std::pair<std::string, const Estimate*>>& rows) {
  std::string text;
  for (const auto& [name, metric] : rows) {
    if (metric->no_interval.empty()) continue;
    text += fmt::format("no interval for {}: {}\n", name, metric->no_interval);
  }
  return text;
}

ordered_json scan_json(const SequenceResult& sequence, const ScanRow& row) {
  ordered_json json = {
      {"sequence", sequence.sequence.text()}, {"scan", row.stem}, {"points", row.points}};
  json.update(counts_json(*row.counts));
  const MetricValues values = metrics_of(*row.counts);
  for (std::size_t m = 0; m < values.size(); ++m) {
    json[std::string(kMetricNames[m])] =
        std::isnan(values[m]) ? ordered_json(nullptr) : ordered_json(values[m]);
  }
  return json;
}

std::string headline(const ResultSet& set) {
  const SequenceResult& first = set.front();
  std::string text =
      fmt::format("{}, {}; data set {}, protocol {}{}", first.method, first.setting, first.dataset,
                  first.protocol->name,
                  first.simulated ? "; SIMULATED: not comparable with published numbers" : "");
  for (const std::string& warning : warnings(set)) text += "; " + warning;
  return text;
}

}  // namespace

std::string interval_text(const std::optional<Interval>& interval, const char* style) {
  if (!interval) return "none";
  return fmt::format("[{}, {}]", percent_text(interval->low, style),
                     percent_text(interval->high, style));
}

RunStatistics run_statistics(const ResultSet& set) {
  const std::vector<SequenceCounts> counts = counts_of(set);
  const Protocol& protocol = *set.front().protocol;
  RunStatistics statistics;
  for (std::size_t s = 0; s < counts.size(); ++s) {
    statistics.sequences.push_back(
        estimate(protocol, {&counts[s], 1}, spacing_of(set.sequences[s])));
  }
  statistics.all = estimate(protocol, counts, spacing_of(set));
  return statistics;
}

ordered_json to_json(const Estimates& estimates) {
  ordered_json json;
  for (std::size_t m = 0; m < kMetricNames.size(); ++m) {
    json[std::string(kMetricNames[m])] = spread_json(estimates.metrics[m]);
  }
  return json;
}

ordered_json to_json(const Difference& difference) {
  ordered_json json = spread_json(difference);
  json["p_value"] = json_or_null(difference.p_value);
  json["smallest_detectable"] = json_or_null(difference.smallest_detectable);
  return json;
}

ordered_json to_json(const Differences& differences) {
  ordered_json json;
  for (std::size_t m = 0; m < kMetricNames.size(); ++m) {
    json[std::string(kMetricNames[m])] = to_json(differences.metrics[m]);
  }
  return json;
}

ordered_json provenance_json(const ResultSet& set) {
  const SequenceResult& first = set.front();
  ordered_json json = {{"path", set.path.string()},
                       {"method", first.method},
                       {"setting", first.setting},
                       {"dataset", first.dataset},
                       {"protocol", std::string(first.protocol->name)},
                       {"min_range_m", first.range.min_m},
                       {"max_range_m", first.range.max_m}};
  for (const char* key : {"preset", "config", "code", "predictions", "simulated"}) {
    if (first.header.contains(key)) json[key] = first.header[key];
  }
  json["missing_predictions"] = missing_predictions(set);
  if (first.only_split) json["only_split"] = *first.only_split;
  return json;
}

ordered_json statistics_json(const ResultSet& set, bool per_scan) {
  const RunStatistics statistics = run_statistics(set);
  ordered_json json = provenance_json(set);
  json["confidence"] = kConfidence;
  json["sequences"] = ordered_json::array();
  for (std::size_t s = 0; s < set.sequences.size(); ++s) {
    const SequenceResult& sequence = set.sequences[s];
    json["sequences"].push_back({{"name", sequence.sequence.text()},
                                 {"scans", counted_scans(sequence).size()},
                                 {"fingerprint", sequence.fingerprint.value_or("")},
                                 {"metrics", to_json(statistics.sequences[s])}});
  }
  json["all"] = to_json(statistics.all);
  if (!per_scan) return json;
  json["scans"] = ordered_json::array();
  for (const SequenceResult& sequence : set.sequences) {
    for (const ScanRow* row : counted_scans(sequence)) {
      json["scans"].push_back(scan_json(sequence, *row));
    }
  }
  return json;
}

std::string scan_table_csv(const ResultSet& set) {
  std::string csv = "sequence,scan,points,tp,fp,fn,tn,ignored,iou,precision,recall,f1\n";
  for (const SequenceResult& sequence : set.sequences) {
    for (const ScanRow* row : counted_scans(sequence)) {
      const Confusion& counts = *row->counts;
      std::vector<std::string> cells = {sequence.sequence, row->stem};
      for (const std::uint64_t count : {std::uint64_t{row->points}, counts.tp, counts.fp, counts.fn,
                                        counts.tn, counts.ignored}) {
        cells.push_back(fmt::format("{}", count));
      }
      for (const double value : metrics_of(counts)) {
        cells.push_back(std::isnan(value) ? "" : fmt::format("{:.17g}", value));
      }
      csv += csv_row(cells);
    }
  }
  return csv;
}

std::string statistics_text(const ResultSet& set) {
  const RunStatistics statistics = run_statistics(set);
  TextTable table({{"sequence", TextTable::Align::kLeft},
                   {"scans"},
                   {"IoU %"},
                   {"95 %"},
                   {"precision %"},
                   {"95 %"},
                   {"recall %"},
                   {"95 %"},
                   {"F1 %"},
                   {"95 %"}});
  std::vector<std::pair<std::string, const Estimate*>> ious;
  std::size_t scans = 0;
  for (std::size_t s = 0; s < set.sequences.size(); ++s) {
    const std::size_t counted = counted_scans(set.sequences[s]).size();
    scans += counted;
    table.add_row(estimate_cells(set.sequences[s].sequence, counted, statistics.sequences[s]));
    ious.emplace_back(set.sequences[s].sequence, &statistics.sequences[s][Metric::kIou]);
  }
  ious.emplace_back("all", &statistics.all[Metric::kIou]);
  table.add_rule();
  table.add_row(estimate_cells("all", scans, statistics.all));
  return fmt::format("{}\n\n{}\n95 %: where the value of many more scans like these would be\n{}",
                     headline(set), table.str(), no_intervals(ious));
}

ordered_json difference_json(const ResultSet& first, const ResultSet& second,
                             const PairedRuns& paired) {
  return {{"first", provenance_json(first)},
          {"second", provenance_json(second)},
          {"confidence", kConfidence},
          {"paired_scans", paired.scans.size()},
          {"unlike", unlike_text(paired.unlike)},
          {"difference", to_json(paired_difference(*first.front().protocol, paired.first,
                                                   paired.second, paired.spacing))}};
}

std::string difference_text(const ResultSet& first, const ResultSet& second,
                            const PairedRuns& paired) {
  const Differences differences =
      paired_difference(*first.front().protocol, paired.first, paired.second, paired.spacing);
  TextTable table({{"second - first", TextTable::Align::kLeft},
                   {"difference"},
                   {"95 %"},
                   {"p"},
                   {"detectable"}});
  for (std::size_t m = 0; m < kMetricNames.size(); ++m) {
    const Difference& metric = differences.metrics[m];
    table.add_row({std::string(kMetricNames[m]), percent_text(metric.value, "{:+.2f}"),
                   interval_text(metric.interval, "{:+.2f}"),
                   metric.p_value ? fmt::format("{:.4f}", *metric.p_value) : "none",
                   percent_text(metric.smallest_detectable, "{:.2f}")});
  }
  std::string text = fmt::format("first:  {}\nsecond: {}\n{} paired scans", headline(first),
                                 headline(second), paired.scans.size());
  if (!paired.unlike.empty()) text += "; " + unlike_text(paired.unlike);
  return text + "\n\n" + table.str() +
         "\nin percentage points; detectable: the true difference that as many scans like these "
         "show\n"
         "at 5 % significance with 80 % probability; n times as many scans divide it by sqrt(n)\n" +
         no_intervals({{"the difference", &differences[Metric::kIou]}});
}

}  // namespace mosbench
