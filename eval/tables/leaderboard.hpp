#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/result/result.hpp"
#include "eval/statistics/intervals.hpp"

namespace mosbench {

/// One setting in which runs differ.
struct DifferingSetting {
  std::string name;                                 ///< "voxel_size_m"
  std::vector<std::optional<SettingValue>> values;  ///< one per run; none where it has no such one
};

/// Returns the settings of which two runs by one method have different values, or all runs have one
/// and they differ, as recorded in result.json: those of the method (what `score --method` said
/// for other programs), where the poses are from, and the settings of odometry.
std::vector<DifferingSetting> differing_settings(const std::vector<const ResultSet*>& runs);

/// One run among others on the same scans.
struct LeaderboardRow {
  const ResultSet* run = nullptr;
  std::vector<std::optional<Estimates>> sequences;  ///< one per sequence of the leaderboard
  std::optional<Estimates> all;  ///< as the protocol aggregates; only where no scan is missing
  std::vector<Standing> sequence_standing;  ///< as many as sequences
  Standing standing;                        ///< of all
  std::optional<double> ms_per_scan;        ///< of the method, mean of all scans
  std::optional<double> memory_mb;          ///< most that the process held, 1e6 bytes
  bool is_on_front = false;            ///< no other run is as good and as fast, and better in one
  std::optional<Difference> to_first;  ///< of IoU, to that of the first row, on the same scans
};

/// Runs on the same scans. The runs must outlive it.
struct Leaderboard {
  std::vector<std::string> sequences;  ///< every sequence that a run has
  std::vector<LeaderboardRow> rows;
  std::vector<DifferingSetting> differing;  ///< values in the order of the rows
  std::vector<std::string> doubts;          ///< of missing predictions and other splits, by run
  std::vector<std::string> remarks;         ///< what a reader should know, plain sentences
};

/// Groups runs that can stand in one leaderboard and have scans in common, in the order in which
/// they come; runs without truth are left out.
std::vector<std::vector<ResultSet>> comparable_runs(const std::vector<ResultSet>& runs);

/// Adds the folders of the runs to what differs, where nothing else tells two rows of a method
/// apart.
void add_folders_of_twins(Leaderboard& board);

/// Which row comes first, to which the others are compared.
enum class RowOrder {
  kIou,   ///< the best, those without IoU last
  kGiven  ///< the first run
};

/// Throws DataError naming the run that is of another protocol, range or input than the first.
Leaderboard leaderboard_of(const std::vector<ResultSet>& runs, RowOrder order = RowOrder::kIou);

}  // namespace mosbench
