#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "eval/answer/render.hpp"

namespace mosbench {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// The same for sentences of one kind: "..." stands for each number.
std::string kind_of(std::string_view sentence) {
  std::string kind;
  bool in_number = false;
  for (std::size_t i = 0; i < sentence.size(); ++i) {
    const bool is_point = in_number && sentence.substr(i, 1) == "." && i + 1 < sentence.size() &&
                          is_digit(sentence[i + 1]);
    const bool is_part = is_point || is_digit(sentence[i]);
    if (is_part && !in_number) kind += "...";
    if (!is_part) kind += sentence[i];
    in_number = is_part;
  }
  return kind;
}

}  // namespace

std::vector<std::string> sentences(const Standing& standing) {
  std::vector<std::string> texts;
  if (standing.simulated) {
    texts.push_back(
        fmt::format("SIMULATED data{}: not comparable with published numbers",
                    standing.origin.empty() ? "" : fmt::format(" ({})", standing.origin)));
  }
  texts.insert(texts.end(), standing.doubts.begin(), standing.doubts.end());
  return texts;
}

void say_by_kind(const std::vector<std::string*>& sentences) {
  std::map<std::string, std::set<std::string>> texts;
  for (const std::string* sentence : sentences) texts[kind_of(*sentence)].insert(*sentence);
  for (std::string* sentence : sentences) {
    const std::string kind = kind_of(*sentence);
    if (texts[kind].size() > 1) *sentence = kind;
  }
}

std::vector<std::string> doubts_beside_rows(const Answer& answer) {
  if (!answer.standing) return {};
  std::set<std::string> told;
  const auto add_rows = [&](const Sheet& sheet) {
    for (const Standing& row : sheet.row_standing) {
      for (const std::string& doubt : row.doubts) told.insert(kind_of(doubt));
    }
  };
  std::ranges::for_each(answer.sheets, add_rows);
  if (answer.records) add_rows(*answer.records);
  std::vector<std::string> others;
  for (const std::string& doubt : answer.standing->doubts) {
    const std::string kind = kind_of(doubt);
    // That of the answer may name first what it is about.
    const bool is_told = std::ranges::any_of(
        told, [&](const std::string& row) { return kind == row || kind.ends_with(": " + row); });
    if (!is_told) others.push_back(doubt);
  }
  return others;
}

std::vector<std::string> marks_of(const Answer& answer) {
  return answer.standing ? sentences(*answer.standing) : std::vector<std::string>();
}

std::vector<std::string> marks_at(const Answer& answer, std::size_t sheet) {
  if (sheet == 0) return marks_of(answer);
  const bool is_marked =
      answer.standing && answer.standing->simulated && !answer.sheets.at(sheet).columns.empty();
  return is_marked ? sentences({.simulated = true}) : std::vector<std::string>();
}

std::string message_of(const CheckResult& check, const std::vector<std::string>& marks) {
  constexpr std::size_t kMost = 2;
  if (marks.empty()) return check.message;
  const auto end = marks.begin() + static_cast<std::ptrdiff_t>(std::min(kMost, marks.size()));
  const std::string more =
      marks.size() > kMost ? fmt::format("; and {} more", marks.size() - kMost) : "";
  return fmt::format("{} [{}{}]", check.message, fmt::join(marks.begin(), end, "; "), more);
}

}  // namespace mosbench
