#pragma once

#include <optional>
#include <span>
#include <string>

namespace mosbench {

/// Returns the cells as one line of CSV (RFC 4180), ended by a line feed: cells with a comma, a
/// quote or a line break are quoted. A cell that is no number and begins with = + - @, a tab or a
/// carriage return would be a formula in a spreadsheet: it is quoted, with an apostrophe in front.
std::string csv_row(std::span<const std::string> cells);

/// Returns a cell with "62.2912" of 0.622912; an empty one of nothing.
std::string csv_percent(const std::optional<double>& fraction);

}  // namespace mosbench
