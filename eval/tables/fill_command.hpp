#pragma once

#include <string>

#include "eval/job/method_choice.hpp"
#include "eval/tables/paper_tables.hpp"
#include "eval/tables/published.hpp"

namespace mosbench {

/// Returns what to download and the command whose results then fill `column` of the row that
/// `published` belongs to: for methods of mosbench `mosbench run` with the preset of the table's
/// data set that comes nearest to the published settings, for other methods `mosbench score`.
std::string how_to_fill(const PaperTable& table, const TableColumn& column,
                        const PublishedCell& published);

/// The same for a preset of a method that was published nowhere.
std::string how_to_fill(const PaperTable& table, const TableColumn& column, const Preset& preset);

}  // namespace mosbench
