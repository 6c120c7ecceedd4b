#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eval/answer/answer.hpp"

namespace mosbench {

/// All formats by name, in the order of the enumeration.
std::span<const std::string_view> format_names();
/// Throws UsageError for a name that is none of them.
Format format_named(std::string_view name);

/// Returns the format that the end of a file's name says: .txt, .json, .csv, .tex, .md, .html,
/// .xml, .png.
std::optional<Format> format_of_name(const std::filesystem::path& file);
/// Throws UsageError where the end of a file's name says another kind of file than what is written:
/// also .pdf, .svg, .jpg and others that nothing writes.
void check_name(const std::filesystem::path& file, Format written);

/// Returns what makes the numbers of an answer doubtful, a sentence each.
std::vector<std::string> marks_of(const Answer& answer);
/// Returns those that stand with one of its sheets: all with the first, and with other tables that
/// their data are simulated.
std::vector<std::string> marks_at(const Answer& answer, std::size_t sheet);
/// Returns the doubts that no row of a sheet tells, which are of the whole answer.
std::vector<std::string> doubts_beside_rows(const Answer& answer);
/// Returns the message of a check with the first two of them in brackets, as it is shown alone.
std::string message_of(const CheckResult& check, const std::vector<std::string>& marks);
/// Returns its sheets, or an empty one where there is none and something to say above it.
std::vector<Sheet> shown_sheets(const Answer& answer);

/// Formats an answer; text has its tables folded into so many columns of a terminal (0: any
/// number). Nothing stays nothing. Throws UsageError for a picture of an answer without charts, and
/// for test cases of one without checks.
std::string render(const Answer& answer, Format format, std::size_t columns = 0);

/// Returns the rows of a sheet as objects.
nlohmann::ordered_json records_json(const Sheet& sheet);
/// Returns {"low", "high", "no_interval"}, null where there is none.
nlohmann::ordered_json interval_json(const Spread& spread);

/// Returns `text` as one line of HTML that shows it.
std::string html_text(std::string_view text);
/// Returns `text` as one line of LaTeX that prints it, also within a comment.
std::string latex_text(std::string_view text);
/// Returns `text` as one line of markdown that shows it: what would end a cell, begin a tag, a link
/// or an emphasis is escaped, line breaks become \x0a.
std::string markdown_text(std::string_view text);
/// Returns the cells as one line of CSV (RFC 4180), ended by a line feed: cells with a comma, a
/// quote or a line break are quoted. A cell that is no number and begins with = + - @, a tab or a
/// carriage return would be a formula in a spreadsheet: it is quoted, with an apostrophe in front.
std::string csv_row(std::span<const std::string> cells);

/// The cells of a sheet as people see them.
struct ShownTable {
  struct Head {
    std::string title;
    bool is_left;
  };
  std::vector<Head> heads;
  std::vector<std::vector<std::string>> rows;  ///< an empty one is a line across
};
ShownTable shown_table(const Sheet& sheet);

/// Formats a sheet as text with a table of at most so many columns of a terminal.
std::string text_of(const Sheet& sheet, std::size_t columns = 0);
/// Format all sheets with what standing says of them.
std::string latex_of(const Answer& answer);
std::string markdown_of(const Answer& answer);
std::string html_of(const Answer& answer);
/// Formats the checks as test cases in the XML of JUnit, with all sheets as the output of the
/// tests.
std::string junit_of(const Answer& answer);

/// Returns how many columns the terminal behind stdout has; 0 where stdout is none.
std::size_t terminal_columns();

/// Returns whether a terminal behind `stream` (a file descriptor) is to be shown colours: not where
/// the environment has NO_COLOR (no-color.org) or TERM=dumb.
bool shows_colours(int stream);

/// Returns an answer with its findings in colour: lines that begin with "error:" or are
/// "regression" in red, "warning:" in yellow, "pass" in green, and the headings of help in bold.
std::string in_colours(const std::string& answer);

}  // namespace mosbench
