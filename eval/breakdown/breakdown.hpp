#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "datasets/sequence/sequence.hpp"
#include "eval/answer/answer.hpp"
#include "eval/breakdown/object_tracks.hpp"
#include "eval/breakdown/reasons.hpp"
#include "eval/breakdown/scan_breakdown.hpp"
#include "eval/predictions/predictions.hpp"

namespace mosbench {

/// A cluster of false positives and its scan.
struct FalseCluster {
  std::size_t scan_index;
  ScanCluster cluster;
};

/// Counts of one sequence by range, height and object.
struct SequenceBreakdown {
  std::string sequence;
  std::vector<std::string> stems;  ///< of all scans, by scan index
  std::vector<std::size_t> scans;  ///< indices of the scored scans
  bool stamped = false;            ///< speeds use the scans' stamps; otherwise 10 Hz is assumed
  BinCounts by_range, by_height;
  std::vector<ObjectTrack> objects;
  std::vector<FalseCluster> false_positives;  ///< worst first
  std::optional<ReasonTable> reasons;         ///< where they were asked for
};

/// Rules and threads of a breakdown.
struct BreakdownTask {
  const Protocol* protocol;
  RangeGate range;
  unsigned threads = 1;
};

/// Breaks down the scans at `scans`, which have truth and a prediction. Returns the same for any
/// number of threads. Throws DataError.
SequenceBreakdown break_down(const Sequence& sequence, const std::vector<std::size_t>& scans,
                             const Predictions& predictions, const BreakdownTask& task);

/// Recall in one bin of objects or of sightings.
struct RecallBin {
  std::string name;       ///< "1 to 2 m"
  std::size_t count = 0;  ///< of objects or of sightings
  std::uint64_t tp = 0, fn = 0;
};

/// Return the recall of moving points by a property of their object.
std::vector<RecallBin> recall_by_size(const std::vector<ObjectTrack>& objects);
std::vector<RecallBin> recall_by_speed(const std::vector<ObjectTrack>& objects);
/// Bins sightings by the number of scans since the object was first seen.
std::vector<RecallBin> recall_by_age(const std::vector<ObjectTrack>& objects);

/// List the worst `at_most` objects and false positives; all are counted.
nlohmann::ordered_json to_json(const SequenceBreakdown& breakdown, std::size_t at_most);
/// What of a breakdown is shown.
struct BreakdownParts {
  bool range = true, height = true, object = true, reason = false;
};
std::vector<Sheet> breakdown_sheets(const SequenceBreakdown& breakdown, const BreakdownParts& parts,
                                    std::size_t at_most);

}  // namespace mosbench
