#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// A line of a text file without its end (LF or CR LF).
struct TextLine {
  std::size_t number;  ///< from 1
  std::string_view text;
};

/// Returns the lines up to the last that is not blank, as views into `text`, without a byte order
/// mark. Throws DataError naming the line when one before it is blank, and for UTF-16.
std::vector<TextLine> split_lines(std::string_view text, const std::filesystem::path& file);

/// Splits a line at blanks and tabs; no part is empty.
std::vector<std::string_view> split_at_blanks(std::string_view line);

/// Splits a line at commas and trims the parts: one more than there are commas.
std::vector<std::string_view> split_at_commas(std::string_view line);

/// Takes the first line off `text`, and returns it trimmed.
std::string_view take_line(std::string_view& text);

/// Returns `text` without blanks, tabs and carriage returns at both ends.
std::string_view trim(std::string_view text);

/// Returns the whole of `text` as a finite double, or nothing.
std::optional<double> parse_double(std::string_view text);

/// Returns the words as finite doubles. The first that is none goes to `refuse`, which throws.
std::vector<double> parse_numbers(std::span<const std::string_view> words,
                                  const std::function<void(std::string_view)>& refuse);

/// Whether this is a decimal digit, in any locale.
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Returns the whole of `text` as a decimal number without sign, or nothing.
std::optional<std::uint64_t> parse_unsigned(std::string_view text);

/// Returns `text` with ASCII letters in lower case and other bytes unchanged.
std::string lower_case(std::string text);

/// Returns `text` in quotes for an error message: cut when long, unprintable bytes as '?'.
std::string quoted(std::string_view text);

/// Returns "1 scan has" or "12 scans have" of the words for one and for many.
template <std::integral Count>
std::string counted(Count count, std::string_view one, std::string_view many) {
  std::string text = std::to_string(count) + ' ';
  text += count == 1 ? one : many;
  return text;
}

/// Returns "1 scan" or "12 scans" of a noun that takes an s.
template <std::integral Count>
std::string counted(Count count, std::string_view one) {
  return counted(count, one, std::string(one) + 's');
}

/// Returns the candidate with the fewest inserted, deleted or replaced characters, the first of
/// equals; empty when there is no candidate. For "did you mean" in errors.
std::string_view nearest_name(std::string_view name, std::span<const std::string_view> candidates);

/// Returns whether `text` is UTF-8 without control characters (C0, DEL, C1).
bool is_printable(std::string_view text);

/// Returns `text` as a terminal may show it: control characters other than line feeds and tabs,
/// which a terminal would obey, and bytes that are no UTF-8 as \xNN.
std::string shown(std::string_view text);

/// The same for one line, such as a name: line feeds and tabs become \x0a and \x09, too.
std::string shown_in_line(std::string_view text);

/// Returns `text` as one word of a POSIX shell: unchanged where it is one, otherwise in quotes.
std::string shell_word(std::string_view text);

}  // namespace mosbench
