#include <fmt/format.h>

#include <algorithm>

#include "eval/answer/render.hpp"

namespace mosbench {

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

std::string without_digits(std::string sentence) {
  std::erase_if(sentence, [](char c) { return c >= '0' && c <= '9'; });
  return sentence;
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
