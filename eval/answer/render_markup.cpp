#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <set>
#include <sstream>
#include <utility>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/render.hpp"

namespace mosbench {
namespace {

using Lines = std::vector<std::string>;

std::string joined(const Lines& cells, std::string (*escape)(std::string_view),
                   const char* between) {
  std::string line;
  for (const std::string& cell : cells) {
    if (&cell != cells.data()) line += between;
    line += escape(cell);
  }
  return line;
}

Lines titles_of(const ShownTable& table) {
  Lines titles;
  for (const ShownTable::Head& head : table.heads) titles.push_back(head.title);
  return titles;
}

std::string latex_comments(const Lines& lines) {
  std::string text;
  for (const std::string& line : lines) {
    if (!line.empty()) text += "% " + latex_text(line) + '\n';
  }
  return text;
}

using Replacements = std::initializer_list<std::pair<char, std::string_view>>;

/// The text as one line, with what stands for some characters.
std::string replaced(std::string_view text, Replacements by) {
  std::string line;
  for (const char c : shown_in_line(text)) {
    const auto found = std::ranges::find(by, c, &Replacements::value_type::first);
    if (found == by.end()) {
      line += c;
    } else {
      line += found->second;
    }
  }
  return line;
}

/// What is told of a whole table; doubts about single rows stand with those.
Lines table_marks(const Answer& answer, const Sheet& sheet) {
  if (sheet.row_standing.empty() || !answer.standing) return marks_of(answer);
  const Standing& all = *answer.standing;
  return sentences({all.simulated, all.origin, doubts_beside_rows(answer)});
}

/// What is doubtful about rows, one foot line per kind with the letter that its rows bear.
class Footnotes {
 public:
  explicit Footnotes(const Sheet& sheet) {
    std::vector<Standing> rows = sheet.row_standing;
    std::vector<std::string*> doubts;
    for (Standing& row : rows) {
      for (std::string& doubt : row.doubts) doubts.push_back(&doubt);
    }
    say_by_kind(doubts);
    for (const Standing& row : rows) {
      std::set<std::ptrdiff_t> places;
      for (const std::string& doubt : row.doubts) places.insert(place_of(doubt));
      Lines letters;
      std::ranges::transform(places, std::back_inserter(letters), letter_of);
      marks_.push_back(letters.empty() ? "" : fmt::format("$^{{{}}}$", fmt::join(letters, ",")));
    }
  }
  std::string mark(std::size_t row) const { return marks_.empty() ? "" : marks_.at(row); }
  Lines lines() const {
    Lines lines;
    for (const std::string& text : texts_) {
      const auto place = &text - texts_.data();
      lines.push_back(fmt::format("$^{{{}}}$ {}", letter_of(place), latex_text(text)));
    }
    return lines;
  }

 private:
  /// "a" to "z", then "aa".
  static std::string letter_of(std::ptrdiff_t place) {
    const std::string before = place < 26 ? "" : letter_of(place / 26 - 1);
    return before + static_cast<char>('a' + place % 26);
  }
  std::ptrdiff_t place_of(const std::string& doubt) {
    const auto place = std::ranges::find(texts_, doubt) - texts_.begin();
    if (place == std::ssize(texts_)) texts_.push_back(doubt);
    return place;
  }

  Lines marks_, texts_;
};

/// A tabular. What must stay with the numbers is printed below them, and a dagger leads there.
std::string latex_table(const Sheet& sheet, const Lines& marks) {
  const ShownTable table = shown_table(sheet);
  const Footnotes footnotes(sheet);
  std::string text = "\\begin{tabular}{";
  for (const ShownTable::Head& head : table.heads) text += head.is_left ? 'l' : 'r';
  text += "}\n\\hline\n" + joined(titles_of(table), latex_text, " & ");
  text += fmt::format("{} \\\\\n\\hline\n", marks.empty() ? "" : "$^\\dagger$");
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const Lines& row = table.rows[r];
    text +=
        row.empty() ? "\\hline\n" : joined(row, latex_text, " & ") + footnotes.mark(r) + " \\\\\n";
  }
  text += "\\hline\n";
  const auto add_foot = [&](const std::string& line) {
    text += fmt::format("\\multicolumn{{{}}}{{l}}{{{}}} \\\\\n",
                        std::max<std::size_t>(table.heads.size(), 1), line);
  };
  const bool leads = sheet.caption.empty() && !sheet.lead.empty();
  const std::string& caption = leads ? sheet.lead.front() : sheet.caption;
  if (!caption.empty()) add_foot(latex_text(caption));
  for (const std::string& mark : marks) add_foot("$^\\dagger$ " + latex_text(mark));
  std::ranges::for_each(footnotes.lines(), add_foot);
  return text + "\\end{tabular}\n";
}

std::string markdown_table(const ShownTable& table) {
  std::string text = "| " + joined(titles_of(table), markdown_text, " | ") + " |\n|";
  for (const ShownTable::Head& head : table.heads) text += head.is_left ? "---|" : "--:|";
  text += '\n';
  for (const Lines& row : table.rows) {
    if (!row.empty()) text += "| " + joined(row, markdown_text, " | ") + " |\n";
  }
  return text;
}

std::string markdown_of(const Sheet& sheet, const Lines& marks) {
  std::string text;
  if (!sheet.title.empty()) text += "### " + markdown_text(sheet.title) + "\n\n";
  for (const std::string& line : sheet.lead) {
    if (!line.empty()) text += markdown_text(line) + "\n\n";
  }
  for (const std::string& mark : marks) text += "**" + markdown_text(mark) + "**\n\n";
  if (!sheet.columns.empty()) text += markdown_table(shown_table(sheet)) + '\n';
  for (const std::string& note : sheet.notes) {
    if (!note.empty()) text += "- " + markdown_text(note) + '\n';
  }
  return text.ends_with("\n\n") ? text.substr(0, text.size() - 1) : text;
}

std::string html_cells(const Lines& cells, const ShownTable& table, const char* tag) {
  std::string text = "<tr>";
  for (std::size_t c = 0; c < cells.size(); ++c) {
    text += fmt::format("<{0}{1}>{2}</{0}>", tag, table.heads[c].is_left ? " class=\"l\"" : "",
                        html_text(cells[c]));
  }
  return text + "</tr>\n";
}

std::string html_of(const Sheet& sheet, const Lines& marks) {
  std::string text;
  const auto add = [&](const char* tag, const std::string& line) {
    if (!line.empty()) text += fmt::format("<{0}>{1}</{0}>\n", tag, html_text(line));
  };
  add("h2", sheet.title);
  for (const std::string& line : sheet.lead) add("p", line);
  for (const std::string& mark : marks) add("strong", mark);
  if (!sheet.columns.empty()) {
    const ShownTable table = shown_table(sheet);
    text += "<table>\n";
    add("caption", sheet.caption);
    text += html_cells(titles_of(table), table, "th");
    for (const Lines& row : table.rows) {
      if (!row.empty()) text += html_cells(row, table, "td");
    }
    text += "</table>\n";
  }
  for (const std::string& note : sheet.notes) add("p", note);
  return text;
}

/// All sheets with their marks.
std::string joined_sheets(const Answer& answer, std::string (*shown)(const Sheet&, const Lines&),
                          const char* between) {
  std::string text;
  const std::vector<Sheet> sheets = shown_sheets(answer);
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    text += (text.empty() ? "" : between) + shown(sheets[i], marks_at(answer, i));
  }
  return text;
}

/// As HTML, except for the two characters that XML cannot hold.
std::string xml_text(std::string_view text) {
  std::string line = html_text(text);
  for (const auto& [character, shown] :
       {std::pair{"\xEF\xBF\xBE", "\\ufffe"}, std::pair{"\xEF\xBF\xBF", "\\uffff"}}) {
    for (std::size_t at = line.find(character); at != std::string::npos;
         at = line.find(character)) {
      line.replace(at, 3, shown);
    }
  }
  return line;
}

std::string test_case(const CheckResult& check, const Lines& marks) {
  const std::string head =
      fmt::format("<testcase classname=\"mosbench\" name=\"{}\"", xml_text(check.name));
  if (check.passed()) return head + "/>\n";
  constexpr std::array kTags = {"failure", "skipped", "error"};
  const std::string message = xml_text(message_of(check, marks));
  const char* tag = kTags.at(static_cast<std::size_t>(check.severity));
  return fmt::format("{}><{} message=\"{}: {}\">{}</{}></testcase>\n", head, tag,
                     xml_text(check.title), message, message, tag);
}

}  // namespace

std::string html_text(std::string_view text) {
  return replaced(text, {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}});
}

std::string latex_text(std::string_view text) {
  return replaced(text, {{'\\', "\\textbackslash{}"},
                         {'~', "\\textasciitilde{}"},
                         {'^', "\\textasciicircum{}"},
                         {'&', "\\&"},
                         {'%', "\\%"},
                         {'$', "\\$"},
                         {'#', "\\#"},
                         {'_', "\\_"},
                         {'{', "\\{"},
                         {'}', "\\}"}});
}

std::string markdown_text(std::string_view text) {
  std::string escaped;
  for (const char c : shown_in_line(text)) {
    // Brackets of intervals stay: only a parenthesis behind makes them a link.
    const bool of_link = c == '(' && escaped.ends_with(']');
    if (of_link || std::string_view("\\|`*<>").find(c) != std::string_view::npos) escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string latex_of(const Answer& answer) {
  std::string text;
  const Lines marks = marks_of(answer);
  for (const Sheet& sheet : shown_sheets(answer)) {
    if (!text.empty()) text += '\n';
    text += latex_comments({sheet.title}) + latex_comments(sheet.lead);
    if (!sheet.columns.empty()) text += latex_table(sheet, table_marks(answer, sheet));
    text += latex_comments(sheet.notes);
  }
  if (std::ranges::all_of(answer.sheets, [](const Sheet& each) { return each.columns.empty(); })) {
    for (const std::string& mark : marks) text += "$^\\dagger$ " + latex_text(mark) + "\n\n";
  }
  if (answer.text.empty()) return text;
  return text + "\\begin{verbatim}\n" + answer.text + "\\end{verbatim}\n";
}

std::string markdown_of(const Answer& answer) {
  std::string text = joined_sheets(answer, markdown_of, "\n");
  if (answer.text.empty()) return text;
  return text + (text.empty() ? "" : "\n") + "```\n" + answer.text + "```\n";
}

std::string html_of(const Answer& answer) {
  std::string text =
      "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>mosbench</title>\n"
      "<style>body{font-family:sans-serif}th,td{text-align:right;padding:0 .5em}"
      ".l{text-align:left}</style>\n" +
      joined_sheets(answer, html_of, "");
  if (!answer.text.empty()) {
    text += "<pre>\n";
    std::istringstream lines(answer.text);
    for (std::string line; std::getline(lines, line);) text += html_text(line) + '\n';
    text += "</pre>\n";
  }
  return text + "</html>\n";
}

std::string junit_of(const Answer& answer) {
  if (answer.checks.empty()) {
    throw UsageError("--as junit: the answer has no checks, expected another format");
  }
  std::array<std::size_t, 3> counts{};  // by severity
  for (const CheckResult& check : answer.checks) {
    if (!check.passed()) ++counts.at(static_cast<std::size_t>(check.severity));
  }
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n"
      "<testsuite name=\"mosbench\" tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{}\">\n",
      answer.checks.size(), counts[0], counts[2], counts[1]);
  const Lines marks = marks_of(answer);
  if (!marks.empty()) {
    text += fmt::format("<properties><property name=\"standing\" value=\"{}\"/></properties>\n",
                        joined(marks, xml_text, "; "));
  }
  for (const CheckResult& check : answer.checks) text += test_case(check, marks);
  text += "<system-out>\n";
  for (const Sheet& sheet : answer.sheets) {
    std::istringstream lines(text_of(sheet));
    for (std::string line; std::getline(lines, line);) text += xml_text(line) + '\n';
  }
  return text + "</system-out>\n</testsuite>\n</testsuites>\n";
}

}  // namespace mosbench
