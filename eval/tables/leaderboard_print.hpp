#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "eval/tables/leaderboard.hpp"

namespace mosbench {

/// Formats a row per run: what differs in its settings, IoU of all sequences with its interval and
/// of each, precision, recall, cost, whether it is on the Pareto front, difference to the first.
std::string leaderboard_text(const Leaderboard& board);
/// Formats a markdown table of the same cells, with the remarks.
std::string leaderboard_markdown(const Leaderboard& board);
/// Formats a tabular of the same cells.
std::string leaderboard_latex(const Leaderboard& board);
/// Formats a line per run and sequence, and one for all sequences.
std::string leaderboard_csv(const Leaderboard& board);
nlohmann::ordered_json to_json(const Leaderboard& board);

}  // namespace mosbench
