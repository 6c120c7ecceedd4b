#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "eval/answer/answer.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/result/result.hpp"

namespace mosbench {

/// Counts of one sequence, of a run or of scored predictions.
struct ScoredSequence {
  std::string name;
  std::span<const ScanRow> scans;
  std::optional<double> method_ms_per_scan;
};

/// Row for a sequence, for the part of a sequence that belongs to a split, or for a whole split.
struct SummaryRow {
  enum class Kind { kSequence, kPart, kSplit };
  Kind kind = Kind::kSequence;
  std::string name;
  std::string split;      ///< of a sequence's row: its scans of this split only; empty: all scans
  std::size_t scans = 0;  ///< with and without truth
  Summary summary;        ///< over the scans with truth
  std::optional<double> method_ms_per_scan;
};

/// Returns a row per sequence, then per split a row for each part that does not cover its sequence
/// and one that aggregates the parts as the protocol says. `sequences` are in the data set's order.
/// Where the protocol's split picks scans, the rows of sequences are over those scans and say so.
std::vector<SummaryRow> summary_rows(const Protocol& protocol, const std::vector<Split>& splits,
                                     const std::vector<ScoredSequence>& sequences);

/// Says them below the rule and which row has the benchmark's number, with a column of milliseconds
/// if a row has some. Without rows there are the lines alone.
Sheet score_sheet(const ScoreRule& rule, const std::vector<Split>& splits,
                  const std::vector<SummaryRow>& rows);

/// Returns a line that names the row with the benchmark's number, or says that none has it; empty
/// when the protocol has no split.
std::string benchmark_remark(const Protocol& protocol, const std::vector<Split>& splits);

}  // namespace mosbench
