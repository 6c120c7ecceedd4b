#include "eval/answer/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>

namespace mosbench {
namespace {

constexpr std::string_view kRed = "\x1b[31m", kYellow = "\x1b[33m", kGreen = "\x1b[32m",
                           kBold = "\x1b[1m", kPlain = "\x1b[0m";

bool is_heading(std::string_view line) {
  constexpr std::array<std::string_view, 5> kWords = {
      "Arguments:", "Options:", "Examples:", "Commands:", "Reading:"};
  return line.starts_with("Usage: ") || std::ranges::find(kWords, line) != kWords.end();
}

std::string_view style_of(std::string_view line) {
  if (line.starts_with("error:") || line == "regression") return kRed;
  if (line.starts_with("warning:")) return kYellow;
  if (line == "pass") return kGreen;
  return is_heading(line) ? kBold : std::string_view();
}

}  // namespace

std::size_t terminal_columns() {
  winsize size{};
  if (isatty(STDOUT_FILENO) != 1 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) return 0;
  return size.ws_col;
}

bool shows_colours(int stream) {
  const char* terminal = std::getenv("TERM");
  const char* refused = std::getenv("NO_COLOR");
  if (refused != nullptr && *refused != '\0') return false;
  return isatty(stream) == 1 && terminal != nullptr && std::string_view(terminal) != "dumb";
}

std::string in_colours(const std::string& answer) {
  std::string text;
  for (std::size_t start = 0; start < answer.size();) {
    const std::size_t end = std::min(answer.find('\n', start), answer.size());
    const std::string_view line = std::string_view(answer).substr(start, end - start);
    const std::string_view style = style_of(line);
    text += style;
    text += line;
    if (!style.empty()) text += kPlain;
    if (end < answer.size()) text += '\n';
    start = end + 1;
  }
  return text;
}

}  // namespace mosbench
