#pragma once

#include <nlohmann/json.hpp>

#include "eval/answer/answer.hpp"
#include "eval/tables/table_cells.hpp"

namespace mosbench {

/// Says a row per method; a measured cell reads "published / measured (difference) [95 % interval]
/// verdict". Reasons follow as notes. CSV has a line per cell with all of its members.
Answer table_answer(const FilledTable& table);
/// {"table", "title", "averaging", "columns": [...], "rows": [{..., "cells": [...]}]}; fractions.
nlohmann::ordered_json to_json(const FilledTable& table);

}  // namespace mosbench
