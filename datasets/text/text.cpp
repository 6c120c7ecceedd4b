#include "datasets/text/text.hpp"

#include <fmt/format.h>
#include <utf8.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr std::string_view kBlanks = " \t\r";

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// C0, DEL and C1: a terminal that reads UTF-8 obeys the last like ESC.
bool is_control(std::uint32_t character) {
  return character < 0x20 || (character >= 0x7F && character < 0xA0);
}

void append_escaped(std::string_view bytes, std::string& text) {
  for (const char byte : bytes) {
    fmt::format_to(std::back_inserter(text), "\\x{:02x}", static_cast<unsigned char>(byte));
  }
}

std::string escaped_but(std::string_view text, std::string_view kept) {
  std::string safe;
  safe.reserve(text.size());
  while (!text.empty()) {
    const auto valid =
        static_cast<std::size_t>(utf8::find_invalid(text.begin(), text.end()) - text.begin());
    for (auto at = text.begin(), end = at + static_cast<std::ptrdiff_t>(valid); at != end;) {
      const auto from = at;
      const std::uint32_t character = utf8::unchecked::next(at);
      const std::string_view bytes(from, at);
      if (is_control(character) && kept.find(bytes) == std::string_view::npos) {
        append_escaped(bytes, safe);
      } else {
        safe += bytes;
      }
    }
    append_escaped(text.substr(valid, 1), safe);
    text.remove_prefix(std::min(valid + 1, text.size()));
  }
  return safe;
}

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("_-./:=,+@%").find(c) != std::string_view::npos;
}

}  // namespace

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string_view take_line(std::string_view& text) {
  const auto end = text.find('\n');
  const std::string_view line = trim(text.substr(0, end));
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

std::vector<TextLine> split_lines(std::string_view text, const std::filesystem::path& file) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    throw DataError(file, "is text in UTF-16", "UTF-8");
  }
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  std::vector<TextLine> lines;
  std::optional<std::size_t> blank_line;
  std::size_t number = 0;
  while (!text.empty()) {
    ++number;
    const std::string_view line = take_line(text);
    if (line.empty()) {
      if (!blank_line) blank_line = number;
      continue;
    }
    if (blank_line) {
      throw DataError(file, *blank_line, "blank line before the end", "one record per line");
    }
    lines.push_back({number, line});
  }
  return lines;
}

std::vector<std::string_view> split_at_blanks(std::string_view line) {
  std::vector<std::string_view> parts;
  while (true) {
    const auto first = line.find_first_not_of(kBlanks);
    if (first == std::string_view::npos) return parts;
    line.remove_prefix(first);
    const auto end = line.find_first_of(kBlanks);
    parts.push_back(line.substr(0, end));
    if (end == std::string_view::npos) return parts;
    line.remove_prefix(end);
  }
}

std::vector<std::string_view> split_at_commas(std::string_view line) {
  std::vector<std::string_view> parts;
  while (true) {
    const auto comma = line.find(',');
    parts.push_back(trim(line.substr(0, comma)));
    if (comma == std::string_view::npos) return parts;
    line.remove_prefix(comma + 1);
  }
}

std::optional<double> parse_double(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  if (!std::isfinite(value)) return std::nullopt;
  return value;
}

std::vector<double> parse_numbers(std::span<const std::string_view> words,
                                  const std::function<void(std::string_view)>& refuse) {
  std::vector<double> numbers;
  numbers.reserve(words.size());
  for (const std::string_view word : words) {
    const auto number = parse_double(word);
    if (!number) refuse(word);
    numbers.push_back(number.value());
  }
  return numbers;
}

std::optional<std::uint64_t> parse_unsigned(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string lower_case(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string shown = "\"";
  for (const char c : text.substr(0, kLongest)) shown += c >= ' ' && c <= '~' ? c : '?';
  return shown + (text.size() > kLongest ? "...\"" : "\"");
}

std::string_view nearest_name(std::string_view name, std::span<const std::string_view> candidates) {
  std::string_view nearest;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const std::string_view candidate : candidates) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < least) {
      least = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

bool is_printable(std::string_view text) { return shown_in_line(text) == text; }

std::string shown(std::string_view text) { return escaped_but(text, "\n\t"); }

std::string shown_in_line(std::string_view text) { return escaped_but(text, ""); }

std::string shell_word(std::string_view text) {
  if (!text.empty() && std::ranges::all_of(text, is_plain)) return std::string(text);
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? "'\\''" : std::string(1, c);
  return word + '\'';
}

}  // namespace mosbench
