#pragma once

#include <span>
#include <string>

namespace mosbench {

/// Returns the cells as one line of CSV (RFC 4180), ended by a line feed: cells with a comma, a
/// quote or a line break are quoted. A cell that is no number and begins with = + - @, a tab or a
/// carriage return would be a formula in a spreadsheet: it is quoted, with an apostrophe in front.
std::string csv_row(std::span<const std::string> cells);

}  // namespace mosbench
