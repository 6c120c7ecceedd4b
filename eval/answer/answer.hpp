#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "eval/answer/picture.hpp"

namespace mosbench {

enum class Format : std::uint8_t {
  kText,
  kJson,
  kCsv,
  kLatex,
  kMarkdown,
  kHtml,
  kGithub,  ///< text and the annotations of a pull request
  kJunit,   ///< the checks, as XML that CI servers read
  kPng,     ///< the charts
};

/// A number with the interval around it, or why it has none.
struct Spread {
  std::optional<double> value, low, high;
  std::string no_interval{};
  bool operator==(const Spread&) const = default;
};

/// One value of a table: nothing, words, a count, a number (NaN: undefined), or one with its
/// interval.
using Cell = std::variant<std::monostate, std::string, std::uint64_t, double, Spread>;

/// Return the number, or what undefined and missing ones are shown as.
Cell or_undefined(const std::optional<double>& value);
Cell or_missing(const std::optional<double>& value);

/// What the numbers of a column are; people see them multiplied with a factor.
enum class Unit : std::uint8_t {
  kText,     ///< to the left, all others to the right
  kNumber,   ///< as it is
  kPercent,  ///< a fraction
  kPoints,   ///< a difference of fractions, with its sign
  kChange,   ///< a difference of numbers, with its sign
};

struct Column {
  std::string name;  ///< "IoU", to which "%" is added
  Unit unit = Unit::kNumber;
  std::optional<int> digits{};  ///< behind the point; by default those that the unit usually has
  std::string key{};            ///< of JSON and CSV; by default made of the name
};

/// What keeps the numbers of an answer from being compared with others. Every format shows it.
struct Standing {
  bool simulated = false;
  std::string origin{};               ///< of simulated data, "scene room, seed 5"; empty: not told
  std::vector<std::string> doubts{};  ///< "INCOMPLETE: 2 scans are not counted"
};

/// A table with the lines above and below it. An empty row is a line across. Without columns there
/// are the lines alone.
struct Sheet {
  std::string title{};
  std::vector<std::string> lead{};
  std::vector<Column> columns{};
  std::vector<std::vector<Cell>> rows{};
  std::vector<std::string> notes{};
  std::string
      caption{};  ///< one line that LaTeX (else the first of lead) and HTML print with the table
  /// Of each row alone, so many as rows; none: that of the answer is of all.
  std::vector<Standing> row_standing{};
};

/// Returns a sentence for each.
std::vector<std::string> sentences(const Standing& standing);
/// Gives sentences that differ in their numbers alone one text, with "..." for each number.
void say_by_kind(const std::vector<std::string*>& sentences);

/// One thing that was checked.
struct CheckResult {
  enum class Severity : std::uint8_t {
    kFailure,
    kWarning,
    kNotMade  ///< the message says why it could not be
  };
  std::string name;            ///< the same in every run: "room"
  std::string title, message;  ///< what a pull request says of it; empty of one that passed
  Severity severity = Severity::kFailure;
  bool passed() const { return message.empty(); }
};

/// What a command answers. Renderers make text, tables and pictures of it.
struct Answer {
  std::string text{};  ///< plain lines; with sheets those below them
  int exit_code = 0;
  std::string failure{};               ///< why nothing was found out, which stderr says
  Format usual = Format::kText;        ///< where none was asked for
  std::optional<Standing> standing{};  ///< of answers about results
  std::vector<Sheet> sheets{};
  std::optional<Sheet> records{};  ///< rows for programs, which CSV has instead of the sheets
  std::string json{};              ///< its own, by `json_text`; empty: the sheets
  std::string page{};              ///< HTML of its own; empty: the sheets
  std::vector<LineChart> charts{};
  std::vector<CheckResult> checks{};
  std::optional<std::filesystem::path> file{};  ///< where to write it instead of on stdout
  bool goes_beside_stdout = false;              ///< stdout holds a file that the user named so
};

}  // namespace mosbench
