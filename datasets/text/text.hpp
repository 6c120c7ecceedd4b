#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// A line of a text file without its end (LF or CR LF).
struct TextLine {
  std::size_t number;  ///< from 1
  std::string_view text;
};

/// Returns the lines up to the last that is not blank, as views into `text`. Throws DataError
/// naming the line when one before it is blank.
std::vector<TextLine> split_lines(std::string_view text, const std::filesystem::path& file);

/// Splits a line at blanks and tabs; no part is empty.
std::vector<std::string_view> split_at_blanks(std::string_view line);

/// Splits a line at commas and trims the parts: one more than there are commas.
std::vector<std::string_view> split_at_commas(std::string_view line);

/// Returns `text` without blanks, tabs and carriage returns at both ends.
std::string_view trim(std::string_view text);

/// Returns the whole of `text` as a finite double, or nothing.
std::optional<double> parse_double(std::string_view text);

/// Whether this is a decimal digit, in any locale.
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Returns the whole of `text` as a decimal number without sign, or nothing.
std::optional<std::uint64_t> parse_unsigned(std::string_view text);

/// Returns `text` with ASCII letters in lower case and other bytes unchanged.
std::string lower_case(std::string text);

/// Returns `text` in quotes for an error message: cut when long, unprintable bytes as '?'.
std::string quoted(std::string_view text);

}  // namespace mosbench
