#include "eval/cli/commands.hpp"

#include <array>

namespace mosbench {

std::vector<std::string_view> Command::names() const {
  if (alias.empty()) return {name};
  return {name, alias};
}

std::span<const Command> commands() {
  static constexpr std::array kCommands = {
      Command{"simulate", "Write a simulated data set with exact truth", add_simulate},
      Command{"run", "Segment sequences and score the result", add_run},
      Command{"profile", "Show where the time of a run goes", add_profile},
      Command{"score", "Score the predictions of any method", add_score},
      Command{"report", "Write an HTML page that shows results", add_report},
      Command{"render", "Draw scans of a result as pictures or a video", add_render},
      Command{"curve", "Draw precision over recall for all thresholds of the scores", add_curve, "",
              true},
      Command{"table", "Print a published table with measured values next to it", add_table},
      Command{"reproduce", "Run all that a table of the paper needs", add_reproduce},
      Command{"rank", "Rank runs on the same scans, with what differs in them", add_rank,
              "leaderboard"},
      Command{"stats", "Print the intervals of a run, or the difference of two", add_stats},
      Command{"breakdown", "Show where predictions are right and wrong", add_breakdown},
      Command{"diff", "List the scans and objects on which two runs disagree", add_diff},
      Command{"study", "Run methods, data and disturbances of a study and gather them", add_study},
      Command{"map-score", "Score a map that was cleaned of what moved", add_map_score},
      Command{"compare", "Fail when IoU dropped against a baseline", add_compare},
      Command{"bless", "Accept results as the new baseline", add_bless},
      Command{"doctor", "Find what is wrong with a data set", add_doctor},
      Command{"odometry", "Find the poses of scans", add_odometry},
      Command{"trajectory", "Score poses against true ones", add_trajectory, "", true},
      Command{"convert", "Write a data set in another layout", add_convert},
      Command{"list", "List data sets, methods, presets, protocols and more", add_list},
      Command{"help", "Show the help of a command", add_help},
      Command{"completion", "Print what completes commands and flags in a shell", add_completion},
  };
  return kCommands;
}

}  // namespace mosbench
