#include <fmt/format.h>

#include <algorithm>

#include "eval/protocols/benchmark_split.hpp"
#include "eval/protocols/protocol.hpp"
#include "eval/tables/score_report.hpp"

namespace mosbench {
namespace {

using Stems = std::optional<std::set<std::string>>;

/// A row over the scans of a sequence that `stems` names, or all; gathers the counts of those with
/// truth.
SummaryRow row_over(const Protocol& protocol, const ScoredSequence& sequence, const Stems& stems,
                    SequenceCounts& counts) {
  SummaryRow row;
  row.name = sequence.name;
  for (const ScanRow& scan : sequence.scans) {
    if (stems && !stems->contains(scan.stem)) continue;
    ++row.scans;
    if (scan.counts) counts.push_back(*scan.counts);
  }
  row.summary = summarize(protocol, counts);
  return row;
}

std::optional<double> mean_ms(const Split& split, const std::vector<ScoredSequence>& sequences) {
  double sum_ms = 0.0;
  std::size_t scans = 0;
  for (const SplitPart& part : split.parts) {
    const ScoredSequence& sequence = sequences[part.sequence];
    if (!sequence.method_ms_per_scan) return std::nullopt;
    sum_ms += *sequence.method_ms_per_scan * static_cast<double>(sequence.scans.size());
    scans += sequence.scans.size();
  }
  if (scans == 0) return std::nullopt;
  return sum_ms / static_cast<double>(scans);
}

void add_split(const Protocol& protocol, const Split& split,
               const std::vector<ScoredSequence>& sequences, std::vector<SummaryRow>& rows) {
  SummaryRow whole;
  whole.kind = SummaryRow::Kind::kSplit;
  whole.name = split.name;
  whole.method_ms_per_scan = mean_ms(split, sequences);
  std::vector<SequenceCounts> all;
  for (const SplitPart& part : split.parts) {
    SummaryRow row = row_over(protocol, sequences[part.sequence], part.stems, all.emplace_back());
    row.kind = SummaryRow::Kind::kPart;
    row.name += " " + split.name;
    whole.scans += row.scans;
    if (part.stems) rows.push_back(std::move(row));
  }
  whole.summary = summary_of(protocol, all);
  rows.push_back(std::move(whole));
}

std::string row_title(const SummaryRow& row) {
  if (row.kind == SummaryRow::Kind::kSplit) return "split " + row.name;
  return row.split.empty() ? row.name : fmt::format("{} ({} scans)", row.name, row.split);
}

std::vector<Cell> cells_of(const SummaryRow& row, bool with_ms) {
  const Summary& summary = row.summary;
  std::vector<Cell> cells = {row_title(row), std::uint64_t{row.scans},
                             std::uint64_t{summary.scans}};
  if (summary.scans == 0) {
    cells.emplace_back("no truth");
    cells.resize(cells.size() + kMetrics.size() + 4, "");
  } else {
    for (const double metric : summary.metrics) cells.emplace_back(metric);
    cells.insert(cells.end(), {summary.pooled.tp, summary.pooled.fp, summary.pooled.fn,
                               false_positives_per_scan(summary).value(), summary.published_text});
  }
  if (with_ms) cells.push_back(or_missing(row.method_ms_per_scan));
  return cells;
}

}  // namespace

Summary summary_of(const Protocol& protocol, const std::vector<SequenceCounts>& sequences) {
  SequenceCounts all;
  std::vector<Summary> summaries;
  for (const SequenceCounts& counts : sequences) {
    summaries.push_back(summarize(protocol, counts));
    all.insert(all.end(), counts.begin(), counts.end());
  }
  return protocol.aggregation == Aggregation::kMeanOfSequences
             ? mean_of_sequences(protocol, summaries)
             : summarize(protocol, all);
}

std::vector<SummaryRow> summary_rows(const Protocol& protocol, const std::vector<Split>& splits,
                                     const std::vector<ScoredSequence>& sequences) {
  std::vector<SummaryRow> rows;
  const Split* benchmark = benchmark_scans(protocol, splits);
  for (std::size_t i = 0; i < sequences.size(); ++i) {
    SequenceCounts counts;
    const Stems stems = benchmark == nullptr ? std::nullopt : stems_in_split(*benchmark, i);
    SummaryRow& row = rows.emplace_back(row_over(protocol, sequences[i], stems, counts));
    row.method_ms_per_scan = sequences[i].method_ms_per_scan;
    if (benchmark != nullptr) row.split = benchmark->name;
  }
  for (const Split& split : splits) add_split(protocol, split, sequences, rows);
  return rows;
}

Sheet score_sheet(const ScoreRule& rule, const std::vector<Split>& splits,
                  const std::vector<SummaryRow>& rows) {
  Sheet sheet{.lead = {rule_line(rule)}};
  if (rows.empty()) return sheet;
  if (const std::string remark = benchmark_remark(*rule.protocol, splits); !remark.empty()) {
    sheet.lead.push_back(remark);
  }
  sheet.columns = {{"sequence", Unit::kText}, {"scans"}, {"labelled"}};
  for (const MetricRow& metric : kMetrics) {
    sheet.columns.push_back({std::string(metric.title), Unit::kPercent});
  }
  sheet.columns.insert(
      sheet.columns.end(),
      {{"TP"}, {"FP"}, {"FN"}, {"FP/scan", Unit::kNumber, 1}, {"benchmark's rounding"}});
  const bool with_ms = std::ranges::any_of(
      rows, [](const SummaryRow& row) { return row.method_ms_per_scan.has_value(); });
  if (with_ms) sheet.columns.push_back({"ms/scan", Unit::kNumber, 1});
  bool ruled = false;
  for (const SummaryRow& row : rows) {
    if (row.kind != SummaryRow::Kind::kSequence && !ruled) sheet.rows.emplace_back();
    ruled = ruled || row.kind != SummaryRow::Kind::kSequence;
    sheet.rows.push_back(cells_of(row, with_ms));
  }
  return sheet;
}

std::string benchmark_remark(const Protocol& protocol, const std::vector<Split>& splits) {
  if (protocol.default_split.empty() || splits.empty()) return "";
  if (benchmark_split(protocol, splits) != nullptr) {
    return fmt::format("the benchmark's number is that of split {}", protocol.default_split);
  }
  return fmt::format("no row is the benchmark's number: it is over split {}, which was not scored",
                     protocol.default_split);
}

}  // namespace mosbench
