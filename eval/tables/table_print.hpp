#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "eval/tables/table_cells.hpp"

namespace mosbench {

/// Formats a row per method; a measured cell reads "published / measured (difference) [95 %
/// interval] verdict". Reasons follow as notes.
std::string table_markdown(const FilledTable& table);
/// Formats a tabular of the same cells without reasons.
std::string table_latex(const FilledTable& table);
/// Formats a line per cell with all of its members.
std::string table_csv(const FilledTable& table);
/// {"table", "title", "averaging", "columns": [...], "rows": [{..., "cells": [...]}]}; fractions.
nlohmann::ordered_json to_json(const FilledTable& table);

}  // namespace mosbench
