#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "eval/tables/table_cells.hpp"

namespace mosbench {

enum class TableFormat : std::uint8_t { kMarkdown, kCsv, kLatex, kJson };

/// Throws UsageError for a name that is not markdown, csv, latex or json.
TableFormat table_format_named(std::string_view name);

/// Formats the table; names on stderr the results that are not in it.
std::string table_report(const PaperTable& table, const std::vector<PublishedCell>& published,
                         const std::vector<ResultSet>& runs, TableFormat format);

}  // namespace mosbench
