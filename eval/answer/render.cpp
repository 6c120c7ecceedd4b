#include "eval/answer/render.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>
#include <sstream>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kChartPixels = 800;

/// How the numbers of a unit are shown.
struct UnitStyle {
  const char *title, *key;  ///< behind the name
  double factor;
  int digits;  ///< -1: six that count
  bool is_signed;
};

const UnitStyle& style_of(Unit unit) {
  static constexpr std::array<UnitStyle, 5> kStyles = {{{"", "", 1, -1, false},
                                                        {"", "", 1, -1, false},
                                                        {" %", "_percent", 100, 1, false},
                                                        {"", "_points", 100, 2, true},
                                                        {"", "", 1, -1, true}}};
  return kStyles[static_cast<std::size_t>(unit)];
}

std::string number_text(double value, const Column& column) {
  if (std::isnan(value)) return "undefined";
  const UnitStyle& style = style_of(column.unit);
  const int digits = column.digits.value_or(style.digits);
  const double shown = style.factor * value;
  const std::string text =
      digits < 0 ? fmt::format("{:.6g}", shown) : fmt::format("{:.{}f}", shown, digits);
  return style.is_signed && !std::signbit(shown) ? '+' + text : text;
}

/// The number of a cell; NaN where it is undefined.
double number_of(const Cell& cell) {
  constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();
  if (const auto* spread = std::get_if<Spread>(&cell)) return spread->value.value_or(kUndefined);
  const auto* number = std::get_if<double>(&cell);
  return number == nullptr ? kUndefined : *number;
}

/// The words or the count of a cell, `nothing` of an empty one; no value for a number.
std::optional<std::string> words_of(const Cell& cell, const char* nothing) {
  if (const auto* words = std::get_if<std::string>(&cell)) return *words;
  if (const auto* count = std::get_if<std::uint64_t>(&cell)) return fmt::format("{}", *count);
  return std::holds_alternative<std::monostate>(cell) ? std::optional(nothing) : std::nullopt;
}

std::string value_text(const Cell& cell, const Column& column) {
  const std::optional<std::string> words = words_of(cell, "-");
  return words ? shown_in_line(*words) : number_text(number_of(cell), column);
}

std::string interval_text(const Cell& cell, const Column& column) {
  const auto* spread = std::get_if<Spread>(&cell);
  if (spread == nullptr) return value_text(cell, column) == "-" ? "-" : "";
  if (!spread->low) return "none";
  return fmt::format("[{}, {}]", number_text(*spread->low, column),
                     number_text(*spread->high, column));
}

bool has_intervals(const Sheet& sheet, std::size_t column) {
  return std::ranges::any_of(sheet.rows, [&](const std::vector<Cell>& row) {
    return column < row.size() && std::holds_alternative<Spread>(row[column]);
  });
}

std::string key_of(const Column& column) {
  if (!column.key.empty()) return column.key + style_of(column.unit).key;
  std::string key;
  for (const char c : column.name) {
    const bool is_word = std::isalnum(static_cast<unsigned char>(c)) != 0;
    if (is_word) {
      key += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!key.empty() && key.back() != '_') {
      key += '_';
    }
  }
  while (key.ends_with('_')) key.pop_back();
  return (key.empty() ? "row" : key) + style_of(column.unit).key;
}

bool is_formula(const std::string& cell) {
  constexpr std::string_view kStarts = "=+-@\t\r";
  return !cell.empty() && kStarts.find(cell.front()) != std::string_view::npos &&
         !parse_double(cell);
}

std::string csv_cell(const std::string& cell) {
  const bool formula = is_formula(cell);
  if (!formula && cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string quoted = formula ? "\"'" : "\"";
  for (const char c : cell) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

/// All digits of a number; of percents and points, which a product has rounded, six.
std::string csv_number(double value, const Column& column) {
  if (std::isnan(value)) return "";
  const double factor = style_of(column.unit).factor;
  return factor == 1 ? fmt::format("{}", value) : fmt::format("{:.6g}", factor * value);
}

/// The key of an end of the interval around a value: "iou_low_percent" of "iou_percent".
std::string key_of_end(const Column& column, const char* end) {
  const std::string key = key_of(column), unit = style_of(column.unit).key;
  return key.substr(0, key.size() - unit.size()) + end + unit;
}

std::string csv_of(const Sheet& sheet, const Answer& answer) {
  const std::optional<Standing>& standing = answer.standing;
  const std::vector<std::string> beside = doubts_beside_rows(answer);
  std::vector<std::string> cells;
  std::vector<bool> wide;
  for (std::size_t c = 0; c < sheet.columns.size(); ++c) {
    const Column& column = sheet.columns[c];
    wide.push_back(has_intervals(sheet, c));
    cells.push_back(key_of(column));
    if (!wide.back()) continue;
    for (const char* end : {"_low", "_high"}) cells.push_back(key_of_end(column, end));
  }
  if (standing) cells.emplace_back("standing");
  std::string text = csv_row(cells);
  for (std::size_t r = 0; r < sheet.rows.size(); ++r) {
    const std::vector<Cell>& row = sheet.rows[r];
    if (row.empty()) continue;
    cells.clear();
    for (std::size_t c = 0; c < sheet.columns.size(); ++c) {
      const Cell cell = c < row.size() ? row[c] : Cell();
      const std::optional<std::string> words = words_of(cell, "");
      cells.push_back(words ? *words : csv_number(number_of(cell), sheet.columns[c]));
      if (!wide[c]) continue;
      const auto* spread = std::get_if<Spread>(&cell);
      for (const auto end : {&Spread::low, &Spread::high}) {
        const bool is_known = spread != nullptr && spread->*end;
        cells.push_back(is_known ? csv_number(*(spread->*end), sheet.columns[c]) : "");
      }
    }
    if (standing) {
      Standing own = sheet.row_standing.empty() ? *standing : sheet.row_standing.at(r);
      if (!sheet.row_standing.empty()) std::ranges::copy(beside, std::back_inserter(own.doubts));
      cells.push_back(fmt::format("{}", fmt::join(sentences(own), "; ")));
    }
    text += csv_row(cells);
  }
  return text;
}

/// The lines of an answer without a table, as one.
Sheet sheet_of_lines(const Answer& answer) {
  Sheet sheet{.columns = {{"text", Unit::kText}}};
  const auto add = [&](const std::string& line) { sheet.rows.push_back({line}); };
  for (const Sheet& each : answer.sheets) {
    if (!each.title.empty()) add(each.title);
    std::ranges::for_each(each.lead, add);
    std::ranges::for_each(each.notes, add);
  }
  std::istringstream lines(answer.text);
  for (std::string line; std::getline(lines, line);) add(line);
  return sheet;
}

std::string csv_of(const Answer& answer) {
  if (answer.records) return csv_of(*answer.records, answer);
  std::string text;
  for (const Sheet& sheet : answer.sheets) {
    if (sheet.columns.empty()) continue;
    text += (text.empty() ? "" : "\n") + csv_of(sheet, answer);
  }
  return text.empty() ? csv_of(sheet_of_lines(answer), answer) : text;
}

ordered_json cell_json(const Cell& cell) {
  if (const auto* count = std::get_if<std::uint64_t>(&cell)) return *count;
  if (std::holds_alternative<std::monostate>(cell)) return nullptr;
  if (const auto* words = std::get_if<std::string>(&cell)) return *words;
  const double value = number_of(cell);
  const ordered_json number = std::isnan(value) ? ordered_json() : ordered_json(value);
  const auto* spread = std::get_if<Spread>(&cell);
  if (spread == nullptr) return number;
  ordered_json json = {{"value", number}};
  json.update(interval_json(*spread));
  return json;
}

/// As `key_of`, but fractions stay fractions.
std::string json_key(const Column& column) {
  const std::string key = key_of(column);
  return key.substr(0, key.size() - std::string_view(style_of(column.unit).key).size());
}

/// An answer's own JSON, and what makes its numbers doubtful.
std::string own_json(const Answer& answer) {
  const std::vector<std::string> marks = marks_of(answer);
  if (marks.empty()) return answer.json;
  ordered_json json = ordered_json::parse(answer.json);
  if (json.is_object()) json["standing"] = marks;
  return json_text(json);
}

std::string json_of(const Answer& answer) {
  if (!answer.json.empty()) return own_json(answer);
  ordered_json json = ordered_json::object();
  if (answer.standing) json["standing"] = sentences(*answer.standing);
  if (!answer.sheets.empty()) json["sheets"] = ordered_json::array();
  for (const Sheet& sheet : answer.sheets) {
    json["sheets"].push_back({{"title", sheet.title},
                              {"lead", sheet.lead},
                              {"rows", records_json(sheet)},
                              {"notes", sheet.notes}});
  }
  if (!answer.text.empty()) json["text"] = answer.text;
  return json_text(json);
}

std::string text_of(const Answer& answer, std::size_t columns) {
  std::vector<Sheet> sheets = shown_sheets(answer);
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    const std::vector<std::string> marks = marks_at(answer, i);
    sheets[i].lead.insert(sheets[i].lead.end(), marks.begin(), marks.end());
  }
  std::string text;
  const auto add = [&](const std::string& part) {
    if (!part.empty()) text += (text.empty() ? "" : "\n") + part;
  };
  for (const Sheet& sheet : sheets) add(text_of(sheet, columns));
  add(answer.text);
  return text;
}

/// Escapes the message of a workflow command, and what else would end a property of one.
std::string workflow_text(std::string_view text, std::string_view also = "") {
  std::string escaped;
  for (const char c : text) {
    const bool escape = c == '%' || c == '\r' || c == '\n' || also.find(c) != also.npos;
    escaped += escape ? fmt::format("%{:02X}", c) : std::string(1, c);
  }
  return escaped;
}

std::string github_of(const Answer& answer) {
  std::string text = text_of(answer, 0);
  for (const CheckResult& each : answer.checks) {
    if (each.passed()) continue;
    const bool warns = each.severity == CheckResult::Severity::kWarning;
    text += fmt::format("::{} title={}::{}\n", warns ? "warning" : "error",
                        workflow_text(each.title, ":,"),
                        workflow_text(message_of(each, marks_of(answer))));
  }
  return text;
}

std::string png_of(const Answer& answer) {
  if (answer.charts.empty()) {
    throw UsageError("--as png: the answer has no chart, expected another format");
  }
  return line_charts(answer.charts, kChartPixels, marks_of(answer)).png();
}

}  // namespace

std::string csv_row(std::span<const std::string> cells) {
  std::string line;
  for (const std::string& cell : cells) {
    if (&cell != cells.data()) line += ',';
    line += csv_cell(cell);
  }
  return line + '\n';
}

Cell or_undefined(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
}

Cell or_missing(const std::optional<double>& value) { return value ? Cell(*value) : Cell(); }

std::vector<Sheet> shown_sheets(const Answer& answer) {
  std::vector<Sheet> sheets = answer.sheets;
  if (sheets.empty() && !marks_of(answer).empty()) sheets.emplace_back();
  return sheets;
}

ShownTable shown_table(const Sheet& sheet) {
  ShownTable table;
  std::vector<bool> wide;
  for (std::size_t c = 0; c < sheet.columns.size(); ++c) {
    const Column& column = sheet.columns[c];
    wide.push_back(has_intervals(sheet, c));
    table.heads.push_back(
        {shown_in_line(column.name) + style_of(column.unit).title, column.unit == Unit::kText});
    if (wide.back()) table.heads.push_back({"95 %", false});
  }
  for (const std::vector<Cell>& row : sheet.rows) {
    std::vector<std::string>& cells = table.rows.emplace_back();
    if (row.empty()) continue;
    for (std::size_t c = 0; c < sheet.columns.size(); ++c) {
      const Cell cell = c < row.size() ? row[c] : Cell(std::string());
      cells.push_back(value_text(cell, sheet.columns[c]));
      if (wide[c]) cells.push_back(interval_text(cell, sheet.columns[c]));
    }
  }
  return table;
}

ordered_json records_json(const Sheet& sheet) {
  ordered_json json = ordered_json::array();
  for (const std::vector<Cell>& row : sheet.rows) {
    if (row.empty()) continue;
    ordered_json& members = json.emplace_back(ordered_json::object());
    for (std::size_t c = 0; c < sheet.columns.size(); ++c) {
      members[json_key(sheet.columns[c])] = c < row.size() ? cell_json(row[c]) : nullptr;
    }
  }
  return json;
}

ordered_json interval_json(const Spread& spread) {
  return {{"low", json_or_null(spread.low)},
          {"high", json_or_null(spread.high)},
          {"no_interval",
           spread.no_interval.empty() ? ordered_json(nullptr) : ordered_json(spread.no_interval)}};
}

std::string render(const Answer& answer, Format format, std::size_t columns) {
  if (answer.text.empty() && answer.sheets.empty() && answer.json.empty() &&
      answer.charts.empty()) {
    return "";
  }
  switch (format) {
    case Format::kJson:
      return json_of(answer);
    case Format::kCsv:
      return csv_of(answer);
    case Format::kLatex:
      return latex_of(answer);
    case Format::kMarkdown:
      return markdown_of(answer);
    case Format::kHtml:
      return answer.page.empty() ? html_of(answer) : answer.page;
    case Format::kGithub:
      return github_of(answer);
    case Format::kJunit:
      return junit_of(answer);
    case Format::kPng:
      return png_of(answer);
    case Format::kText:
      break;
  }
  return text_of(answer, columns);
}

}  // namespace mosbench
