#pragma once

#include <nlohmann/json.hpp>

#include "eval/answer/answer.hpp"
#include "eval/tables/leaderboard.hpp"

namespace mosbench {

/// Says a row per run: what differs in its settings, IoU of all sequences with its interval and of
/// each, precision, recall, cost, whether it is on the Pareto front, difference to the first. CSV
/// has a line per run and sequence, and one for all sequences.
Answer leaderboard_answer(const Leaderboard& board);
nlohmann::ordered_json to_json(const Leaderboard& board);

}  // namespace mosbench
