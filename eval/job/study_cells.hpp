#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "eval/job/study_file.hpp"

namespace mosbench {

/// One run of a study: a method on a sequence, with at most one thing changed.
struct StudyCell {
  const StudyData* data = nullptr;
  DatasetKind kind = DatasetKind::kRecording;  ///< of the data
  std::string sequence;
  std::string drive = {};              ///< see `drive_of`; empty for recorded data
  std::string reading = {};            ///< how simulated data were disturbed, and are read
  std::set<std::uint64_t> scans = {};  ///< see `scan_hashes`; empty where nobody asks
  const StudyMethod* method = nullptr;
  std::string program = {};         ///< hash of the files that its command names
  std::string odometry;             ///< empty: the poses of the data
  const StudyAxis* axis = nullptr;  ///< null where nothing is changed
  std::string value = {};           ///< of the axis
  std::uint64_t seed = 0;           ///< 0 where nothing is random
  Job job = {};
  std::string key = {};       ///< see `key_of`; cells that ask the same in other words share it
  std::string cost_key = {};  ///< hash of what decides the cost of the method on the sequence

  /// Returns "hmm-mos", or "hmm-mos (kiss)" with poses by odometry: its row in tables.
  std::string label() const;
  /// Returns "street-1 08".
  std::string sequence_label() const;
  /// Returns "street 08", of simulated data their scene, layout, and sequence where there are
  /// several, and how they are disturbed and read: seeds of one scene are no more than one sequence
  /// to a mean.
  std::string group_label() const;
  /// Returns "street 08, hmm-mos, pose_noise_m=0.05, seed 2".
  std::string title() const;
};

/// Returns what a cell changes: what the study says of the method, then those settings of one value
/// of the axis that the method has.
std::vector<SettingChange> changes_of(const Segment& segment, const StudyAxis& axis,
                                      std::size_t value);

/// Returns whether a list of a study's tuning names the sequence of a cell.
bool names_sequence(const std::vector<std::string>& names, const StudyCell& cell);

/// Lists the cells in the order of the study's file. Data on disk are opened, simulated ones are
/// not made. Throws UsageError, also for one run under two names and for a tuning whose names are
/// of no sequence, or that judges where it tunes, and DataError; a sequence that cannot be opened
/// is a cell that will fail.
/// `known` as of `files_of_program`.
std::vector<StudyCell> cells_of(const Study& study,
                                const std::vector<ProgramFile>* known = nullptr);

/// Returns the rule by which all cells are scored; nothing where the settings of all are refused,
/// which fail when they are computed. Throws UsageError where cells differ in it: a mean over them
/// would mean nothing.
std::optional<ScoreRule> shared_rule(const Study& study, const std::vector<StudyCell>& cells);

/// Returns what tells simulated data from others.
std::string simulation_key(const Simulation& simulation);

}  // namespace mosbench
