#include "datasets/formats/times_file.hpp"

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <limits>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr std::uint64_t kLargest =
    static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());

/// digits * 10^(-decimals), without sign.
struct Decimal {
  std::string digits;
  std::int64_t decimals = 0;
};

/// Reads "12.5e-3" into a Decimal, or nothing.
std::optional<Decimal> parse_decimal(std::string_view text) {
  Decimal decimal;
  std::size_t at = 0;
  bool behind_point = false;
  for (; at < text.size() && (is_digit(text[at]) || (text[at] == '.' && !behind_point)); ++at) {
    if (text[at] == '.') {
      behind_point = true;
      continue;
    }
    decimal.digits += text[at];
    if (behind_point) ++decimal.decimals;
  }
  if (decimal.digits.empty()) return std::nullopt;
  if (at == text.size()) return decimal;
  if (text[at] != 'e' && text[at] != 'E') return std::nullopt;
  std::string_view exponent_text = text.substr(at + 1);
  if (exponent_text.size() > 1 && exponent_text[0] == '+' && is_digit(exponent_text[1])) {
    exponent_text.remove_prefix(1);
  }
  std::int32_t exponent = 0;
  const char* const end = exponent_text.data() + exponent_text.size();
  const auto parsed = std::from_chars(exponent_text.data(), end, exponent);
  if (parsed.ec != std::errc{} || parsed.ptr != end) return std::nullopt;
  decimal.decimals -= exponent;
  return decimal;
}

/// Returns the first `count` digits as a number (zeros after the last), or nothing beyond 63 bits.
std::optional<std::uint64_t> leading_number(const std::string& digits, std::int64_t count) {
  std::uint64_t value = 0;
  for (std::int64_t i = 0; i < count; ++i) {
    const auto position = static_cast<std::size_t>(i);
    // Only zeros follow, and zero stays zero: no need to go through a long exponent.
    if (position >= digits.size() && value == 0) return 0;
    const auto digit =
        position < digits.size() ? static_cast<std::uint64_t>(digits[position] - '0') : 0U;
    if (value > (kLargest - digit) / 10) return std::nullopt;
    value = value * 10 + digit;
  }
  return value;
}

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::size_t kMostDecimals = 9;

/// Reads "" or ".594360375" as nanoseconds.
std::optional<std::int64_t> fraction_ns(std::string_view text) {
  if (text.empty()) return 0;
  const std::string_view decimals = text.substr(1);
  if (text.front() != '.' || decimals.empty() || decimals.size() > kMostDecimals) {
    return std::nullopt;
  }
  const auto value =
      parse_unsigned(std::string(decimals) + std::string(kMostDecimals - decimals.size(), '0'));
  return value ? std::optional(static_cast<std::int64_t>(*value)) : std::nullopt;
}

std::optional<std::int64_t> parse_stamp(std::string_view text) {
  constexpr std::string_view kForm = "0000-00-00 00:00:00";
  if (text.size() < kForm.size()) return std::nullopt;
  for (std::size_t i = 0; i < kForm.size(); ++i) {
    if (kForm[i] == '0' ? !is_digit(text[i]) : text[i] != kForm[i]) return std::nullopt;
  }
  const auto at = [&](std::size_t from, std::size_t count) {
    return static_cast<int>(parse_unsigned(text.substr(from, count)).value());
  };
  const int year = at(0, 4), hour = at(11, 2), minute = at(14, 2), second = at(17, 2);
  const std::chrono::year_month_day date{std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(at(5, 2))),
                                         std::chrono::day(static_cast<unsigned>(at(8, 2)))};
  const auto ns = fraction_ns(text.substr(kForm.size()));
  // Nanoseconds of 64 bits end in 2262.
  const bool is_time = ns && date.ok() && hour < 24 && minute < 60 && second < 60;
  if (!is_time || year < 1970 || year >= 2262) return std::nullopt;
  const std::int64_t days = std::chrono::sys_days(date).time_since_epoch().count();
  return (((days * 24 + hour) * 60 + minute) * 60 + second) * kNsPerSecond + *ns;
}

std::string format_stamp(std::int64_t stamp_ns) {
  const std::chrono::sys_time<std::chrono::nanoseconds> time{std::chrono::nanoseconds(stamp_ns)};
  const auto days = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date(days);
  const std::int64_t ns = (time - days).count(), s = ns / kNsPerSecond;
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}:{:02}.{:09}", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                     s / 3600, s / 60 % 60, s % 60, ns % kNsPerSecond);
}

}  // namespace

std::optional<std::int64_t> parse_seconds_as_ns(std::string_view text, int decimals_of_unit) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  const auto decimal = parse_decimal(text);
  if (!decimal) return std::nullopt;
  const auto digit_count = static_cast<std::int64_t>(decimal->digits.size());
  const std::int64_t kept = digit_count - decimal->decimals + 9 - decimals_of_unit;
  auto magnitude = leading_number(decimal->digits, kept);
  if (!magnitude) return std::nullopt;
  const bool rounds_up =
      kept >= 0 && kept < digit_count && decimal->digits[static_cast<std::size_t>(kept)] >= '5';
  if (rounds_up && ++*magnitude > kLargest) return std::nullopt;
  const auto ns = static_cast<std::int64_t>(*magnitude);
  return negative ? -ns : ns;
}

std::vector<std::int64_t> parse_times(std::string_view text, const std::filesystem::path& file,
                                      TimeUnit unit) {
  std::vector<std::int64_t> stamps_ns;
  for (const TextLine& line : split_lines(text, file)) {
    const auto stamp_ns = parse_seconds_as_ns(line.text, 3 * static_cast<int>(unit));
    if (!stamp_ns) {
      throw DataError(file, line.number,
                      quoted(line.text) + " is no time in seconds that fits 64-bit nanoseconds",
                      "one decimal number of seconds per line");
    }
    stamps_ns.push_back(*stamp_ns);
  }
  return stamps_ns;
}

std::vector<double> parse_time_numbers(std::string_view text, const std::filesystem::path& file) {
  std::vector<double> numbers;
  for (const TextLine& line : split_lines(text, file)) {
    numbers.push_back(parse_double(line.text).value_or(0.0));
  }
  return numbers;
}

TimeUnit unit_of_rows(std::string_view text, const std::filesystem::path& file) {
  std::vector<double> stamps;
  for (const TextLine& line : split_lines(text, file)) {
    const auto words = split_at_blanks(line.text);
    if (words.empty() || words.front().starts_with('#')) continue;
    stamps.push_back(parse_double(words.front()).value_or(0.0));
  }
  return unit_of_stamps(stamps);
}

std::string seconds_text(std::int64_t stamp_ns) {
  constexpr std::uint64_t kNsPerSecond = 1'000'000'000;
  const auto bits = static_cast<std::uint64_t>(stamp_ns);
  const std::uint64_t magnitude = stamp_ns < 0 ? 0 - bits : bits;
  return fmt::format("{}{}.{:09}", stamp_ns < 0 ? "-" : "", magnitude / kNsPerSecond,
                     magnitude % kNsPerSecond);
}

std::string format_times(std::span<const std::int64_t> stamps_ns) {
  std::string text;
  for (const std::int64_t stamp_ns : stamps_ns) text += seconds_text(stamp_ns) + '\n';
  return text;
}

std::vector<std::int64_t> read_times(const std::filesystem::path& file) {
  return parse_times(read_file(file), file);
}

void write_times(const std::filesystem::path& file, std::span<const std::int64_t> stamps_ns) {
  write_file_atomic(file, format_times(stamps_ns));
}

std::vector<std::optional<std::int64_t>> parse_kitti_stamps(std::string_view text,
                                                            const std::filesystem::path& file) {
  std::vector<std::optional<std::int64_t>> stamps_ns;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = take_line(text);
    stamps_ns.push_back(line.empty() ? std::nullopt : parse_stamp(line));
    if (!line.empty() && !stamps_ns.back()) {
      throw DataError(file, number, quoted(line) + " is no time",
                      "one as 2011-09-26 13:02:25.594360375, between 1970 and 2261");
    }
  }
  return stamps_ns;
}

std::string format_kitti_stamps(std::span<const std::optional<std::int64_t>> stamps_ns) {
  std::string text;
  for (const auto& stamp_ns : stamps_ns) text += (stamp_ns ? format_stamp(*stamp_ns) : "") + "\n";
  return text;
}

}  // namespace mosbench
