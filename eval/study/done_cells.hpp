#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "eval/engine/study_plan.hpp"
#include "eval/statistics/intervals.hpp"

namespace mosbench {

/// A metric over the sequences of a study as the protocol aggregates them, which is what `mosbench
/// rank` says of the same scans. Of several seeds, also those of simulations, it is the mean, and
/// the interval is that of their spread: 95 %, Student's t, of at least three.
struct StudyMean : Estimate {
  std::size_t seeds = 0;  ///< 0 without cells
};

/// By kBriefMetrics.
using StudyMetrics = std::array<StudyMean, kBriefMetrics.size()>;

/// A computed cell, with the names under which a table gathers it.
struct DoneCell {
  const PlannedCell* planned;
  const StudyCell& cell;
  const CellNumbers& numbers;
  std::string label, sequence;
};

/// Cells by sequence, then by what differs in seeds alone.
using CellsOfSeeds = std::map<std::string, std::map<std::string, const CellNumbers*>>;

/// Whether a number is of this cell.
using WantedCell = std::function<bool(const StudyCell&)>;
/// Those of a row without any change.
WantedCell is_plain_of(const std::string& label);
/// Those of a row at one value of an axis, whatever axis asks for the same settings.
WantedCell is_at_value(const std::string& label, const StudyAxis& axis, std::size_t value);

/// The cells that were computed, as a table is made of them.
class DoneCells {
 public:
  explicit DoneCells(const StudyPlan& plan);

  CellsOfSeeds by_seed(const WantedCell& wanted) const;
  StudyMetrics metrics(const WantedCell& wanted) const;

  const Protocol* protocol = nullptr;  ///< of the cells; null where none is done
  std::vector<std::string> labels;
  std::vector<DoneCell> done;
};

/// IoU of the second minus the first, by seed, on what both have.
std::vector<Estimate> differences(const Protocol& protocol, const CellsOfSeeds& first,
                                  const CellsOfSeeds& second);

}  // namespace mosbench
