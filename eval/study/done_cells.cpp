#include "eval/study/done_cells.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "eval/statistics/run_statistics.hpp"

namespace mosbench {
namespace {

/// All sequences with one seed each.
struct SeedRun {
  std::vector<SequenceCounts> sequences;
  ScanGaps gaps;
};

/// Returns a run per seed; a sequence with fewer seeds stands in several runs.
std::vector<SeedRun> runs_of(const CellsOfSeeds& cells) {
  std::size_t most = 0;
  for (const auto& [sequence, seeds] : cells) most = std::max(most, seeds.size());
  std::vector<SeedRun> runs(most);
  for (const auto& [sequence, seeds] : cells) {
    auto seed = seeds.begin();
    for (SeedRun& run : runs) {
      run.sequences.push_back(seed->second->counts);
      run.gaps += seed->second->gaps;
      if (++seed == seeds.end()) seed = seeds.begin();
    }
  }
  return runs;
}

/// The metrics of a run as `mosbench rank` has them; nothing where a sequence has no truth.
Estimates estimate_of(const Protocol& protocol, const SeedRun& run) {
  if (std::ranges::any_of(run.sequences, &SequenceCounts::empty)) return {};
  return estimate(protocol, run.sequences, spacing_of(run.gaps));
}

}  // namespace

DoneCells::DoneCells(const StudyPlan& plan) : protocol(plan.rule ? plan.rule->protocol : nullptr) {
  for (const PlannedCell& planned : plan.cells) {
    std::string label = planned.cell.label();
    if (std::ranges::find(labels, label) == labels.end()) labels.push_back(label);
    if (planned.state != CellState::kDone) continue;
    done.push_back(
        {&planned, planned.cell, planned.numbers, std::move(label), planned.cell.group_label()});
  }
}

CellsOfSeeds DoneCells::by_seed(const WantedCell& wanted) const {
  CellsOfSeeds cells;
  for (const DoneCell& each : done) {
    if (!wanted(each.cell)) continue;
    const std::string seed = fmt::format("{} {}", each.cell.sequence_label(), each.cell.seed);
    cells[each.sequence][seed] = &each.numbers;
  }
  return cells;
}

StudyMetrics DoneCells::metrics(const WantedCell& wanted) const {
  std::array<std::vector<Estimate>, kBriefMetrics.size()> seeds;
  for (const SeedRun& run : runs_of(by_seed(wanted))) {
    const Estimates estimates = estimate_of(*protocol, run);
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      seeds[i].push_back(estimates[kBriefMetrics[i]]);
    }
  }
  StudyMetrics metrics;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    metrics[i] = {mean_of_estimates(seeds[i], {0, 1}), seeds[i].size()};
  }
  return metrics;
}

std::vector<Estimate> differences(const Protocol& protocol, const CellsOfSeeds& first,
                                  const CellsOfSeeds& second) {
  CellsOfSeeds of_first, of_second;
  for (const auto& [sequence, seeds] : first) {
    const auto others = second.find(sequence);
    if (others == second.end()) continue;
    for (const auto& [seed, cell] : seeds) {
      const auto other = others->second.find(seed);
      if (other == others->second.end()) continue;
      if (other->second->counts.size() != cell->counts.size()) continue;
      of_first[sequence][seed] = cell;
      of_second[sequence][seed] = other->second;
    }
  }
  const std::vector<SeedRun> before = runs_of(of_first), after = runs_of(of_second);
  std::vector<Estimate> ious;
  for (std::size_t i = 0; i < before.size(); ++i) {
    ious.push_back(paired_difference(protocol, before[i].sequences, after[i].sequences,
                                     spacing_of(before[i].gaps))[Metric::kIou]);
  }
  return ious;
}

WantedCell is_plain_of(const std::string& label) {
  return [label](const StudyCell& cell) { return cell.axis == nullptr && cell.label() == label; };
}

WantedCell is_at_value(const std::string& label, const StudyAxis& axis, std::size_t value) {
  return [label, &axis, value](const StudyCell& cell) {
    if (cell.axis == nullptr || cell.label() != label) return false;
    if (axis.kind != nullptr) return cell.axis == &axis && cell.value == axis.values[value];
    // One run may be of several values, where a method lacks some of a grid's settings.
    const bool has_same = cell.axis->kind == nullptr &&
                          cell.job.segment.changes == changes_of(cell.method->segment, axis, value);
    return has_same && cell.job.segment.changes != cell.method->segment.changes;
  };
}

}  // namespace mosbench
