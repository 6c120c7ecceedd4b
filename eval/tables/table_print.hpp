#pragma once

#include <nlohmann/json.hpp>

#include "eval/answer/answer.hpp"
#include "eval/tables/leaderboard.hpp"
#include "eval/tables/table_cells.hpp"

namespace mosbench {

/// Says a row per run: what differs in its settings, IoU of all sequences with its interval and of
/// each, precision, recall, cost, whether it is on the Pareto front, difference to the first. CSV
/// has a line per run and sequence, and one for all sequences.
Answer leaderboard_answer(const Leaderboard& board);
nlohmann::ordered_json to_json(const Leaderboard& board);

/// Says a row per method; a measured cell reads "published / measured (difference) [95 % interval]
/// verdict". Reasons follow as notes. CSV has a line per cell with all of its members.
Answer table_answer(const FilledTable& table);
/// {"table", "title", "averaging", "columns": [...], "rows": [{..., "cells": [...]}]}; fractions.
nlohmann::ordered_json to_json(const FilledTable& table);

}  // namespace mosbench
