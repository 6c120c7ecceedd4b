#pragma once

#include <span>
#include <string>
#include <vector>

#include "eval/result/result_set.hpp"
#include "eval/statistics/intervals.hpp"

namespace mosbench {

/// Returns how far the scans are apart.
Spacing spacing_of(const ScanGaps& gaps);
Spacing spacing_of(std::span<const Result> sequences);

/// Estimates the metrics of sequences that were scored by one rule, as its protocol aggregates
/// them.
Estimates estimate(std::span<const Result> sequences);

/// One respect in which two runs differ besides their labels.
struct Unlike {
  enum class Kind { kProtocol, kSetting, kScans, kPoses, kInput };
  Kind kind;
  std::string text;  ///< "sequence 00: scan 000017 is only in the first run"
};

/// Two runs with the scans that both have.
struct PairedRuns {
  struct Scan {
    std::string sequence, stem;
    const ScanRow* first;
    const ScanRow* second;
  };
  std::vector<Scan> scans;                    ///< by sequence, in the order of the first run
  std::vector<SequenceCounts> first, second;  ///< their counts, per sequence
  std::vector<Unlike> unlike;                 ///< why a difference may not be due to the labels
  Spacing spacing = Spacing::kNear;           ///< of the scans
};

/// Pairs by names of sequences and stems of scans. The runs must outlive the result.
PairedRuns pair_runs(const ResultSet& first, const ResultSet& second);

/// Joins the first `at_most` texts by "; " and adds the number of the others; empty for none.
std::string unlike_text(const std::vector<Unlike>& unlike, std::size_t at_most = 5);

}  // namespace mosbench
