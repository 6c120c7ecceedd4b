#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "eval/protocols/confusion.hpp"
#include "eval/protocols/metrics.hpp"

namespace mosbench {

/// Counts of one sequence, wherever its labels came from.
struct ScoredSequence {
  struct Scan {
    std::string stem;
    std::optional<Confusion> counts;  ///< nothing without truth
  };
  std::string name;
  std::vector<Scan> scans;
  std::optional<double> method_ms_per_scan;
};

/// A sequence, the part of a sequence that belongs to a split, or a whole split.
struct ScoreRow {
  enum class Kind { kSequence, kPart, kSplit };
  Kind kind = Kind::kSequence;
  std::string name;
  std::string split;      ///< of a sequence's row: its scans of this split only; empty: all scans
  std::size_t scans = 0;  ///< with and without truth
  Summary summary;        ///< over the scans with truth
  std::optional<double> method_ms_per_scan;
};

/// A row per sequence, then per split a row for each part that does not cover its sequence and one
/// that aggregates the parts as the protocol says. `sequences` as in the data set, one each. Where
/// the protocol's split picks scans, the sequences' rows are over those scans and say so.
std::vector<ScoreRow> score_rows(const Protocol& protocol, const std::vector<Split>& splits,
                                 const std::vector<ScoredSequence>& sequences);

/// The table that `run` and `score` print; the column of milliseconds only when a row has some.
std::string format_rows(const Protocol& protocol, const std::vector<ScoreRow>& rows);

/// The line that says which row holds the number of the benchmark, or that none does; empty when
/// the protocol knows no split.
std::string benchmark_notice(const Protocol& protocol, const std::vector<Split>& splits);

/// {"sequences": [...], "parts": [...], "splits": [...]}, undefined metrics as null.
nlohmann::ordered_json rows_json(const std::vector<ScoreRow>& rows);

}  // namespace mosbench
