#include "datasets/formats/bin_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <set>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/numbers.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kFewestPoints = 64;
constexpr std::size_t kPairs = 4096;

struct Mean {
  double value = 0.0;
  double error = 0.0;  ///< its standard error
};

/// Roots of the differences within columns.
struct Spread {
  Mean of_neighbours;  ///< of points that follow each other
  Mean of_any;         ///< of points anywhere in the scan
};

float number_at(std::string_view bytes, std::size_t index) {
  float number = 0;
  std::memcpy(&number, bytes.data() + index * sizeof(number), sizeof(number));
  return number;
}

/// The mean over pairs of points; numbers that are not finite say nothing.
class RootDifferences {
 public:
  RootDifferences(std::string_view bytes, std::size_t columns) : bytes_(bytes), columns_(columns) {}

  void add(std::size_t one, std::size_t other) {
    for (std::size_t column = 0; column < columns_; ++column) {
      const double difference = std::abs(double{number_at(bytes_, one * columns_ + column)} -
                                         double{number_at(bytes_, other * columns_ + column)});
      if (!std::isfinite(difference)) continue;
      sum_ += std::sqrt(difference);
      sum_of_squares_ += difference;
      ++count_;
    }
  }
  Mean mean() const {
    if (count_ == 0) return {};
    const auto count = static_cast<double>(count_);
    const double value = sum_ / count;
    return {value, std::sqrt(std::max(sum_of_squares_ / count - value * value, 0.0) / count)};
  }

 private:
  std::string_view bytes_;
  std::size_t columns_;
  double sum_ = 0.0, sum_of_squares_ = 0.0;
  std::size_t count_ = 0;
};

Spread spread_of(std::string_view bytes, std::size_t columns) {
  const std::size_t points = bytes.size() / (columns * sizeof(float));
  RootDifferences of_neighbours(bytes, columns);
  RootDifferences of_any(bytes, columns);
  for (std::size_t pair = 0; pair < kPairs; ++pair) {
    const std::size_t one = scatter_bits(2 * pair) % points;
    of_neighbours.add(one, one + 1 < points ? one + 1 : 0);
    of_any.add(one, scatter_bits(2 * pair + 1) % points);
  }
  return {of_neighbours.mean(), of_any.mean()};
}

bool is_return(std::string_view bytes, std::size_t columns, std::size_t point) {
  bool any = false;
  for (std::size_t column = 0; column < columns; ++column) {
    const float number = number_at(bytes, point * columns + column);
    if (!std::isfinite(number)) return false;
    any = any || number != 0.0F;
  }
  return any;
}

/// Where most points are missing returns, the few others decide the means.
bool holds_mostly_returns(std::string_view bytes, std::size_t columns) {
  const std::size_t points = bytes.size() / (columns * sizeof(float));
  std::size_t returns = 0;
  for (std::size_t pair = 0; pair < kPairs; ++pair) {
    returns += is_return(bytes, columns, scatter_bits(2 * pair) % points);
  }
  return 2 * returns > kPairs;
}

/// Whether `mean` is below that share of `other`, and not by chance: a few numbers that are far off
/// the rest may make up most of a mean.
bool is_clearly_below(double share, const Mean& mean, const Mean& other) {
  constexpr double kSure = 5.0;
  return mean.value < share * other.value &&
         other.value - mean.value > kSure * std::hypot(mean.error, other.error);
}

/// Either differences are clearly smaller between any points, or a little and between neighbours,
/// which scans measure side by side, by far.
bool fits_clearly_better(const Spread& other, const Spread& told) {
  return is_clearly_below(0.9, other.of_any, told.of_any) ||
         (is_clearly_below(0.97, other.of_any, told.of_any) &&
          is_clearly_below(0.5, other.of_neighbours, told.of_neighbours));
}

/// The share of numbers that no scan holds: neither 0 nor from 1e-9 to 1e7. One number again and
/// again is no scan either.
template <typename Number>
double odd_share(std::string_view bytes, bool is_big_endian) {
  constexpr std::size_t kFewestNumbers = 16;
  std::size_t odd = 0;
  std::set<std::array<char, sizeof(Number)>> seen;
  for (std::size_t draw = 0; draw < kPairs; ++draw) {
    std::array<char, sizeof(Number)> raw{};
    const std::size_t at = scatter_bits(draw) % (bytes.size() / raw.size());
    std::memcpy(raw.data(), bytes.data() + at * raw.size(), raw.size());
    if (is_big_endian) std::ranges::reverse(raw);
    const double size = std::abs(static_cast<double>(std::bit_cast<Number>(raw)));
    seen.insert(raw);
    odd += size != 0.0 && !(size > 1e-9 && size < 1e7);
  }
  if (seen.size() < kFewestNumbers) return 1.0;
  return static_cast<double>(odd) / static_cast<double>(kPairs);
}

}  // namespace

std::string_view other_bin_numbers(std::string_view bytes) {
  constexpr double kMany = 0.1, kFew = 0.01;
  if (bytes.size() < kFewestPoints * sizeof(Point)) return "";
  if (odd_share<float>(bytes, false) < kMany) return "";
  if (odd_share<float>(bytes, true) < kFew) return "big-endian float32";
  return odd_share<double>(bytes, false) < kFew ? "float64" : "";
}

std::optional<std::size_t> other_bin_columns(std::string_view bytes, std::size_t columns) {
  if (bytes.size() < kFewestPoints * columns * sizeof(float)) return std::nullopt;
  if (!holds_mostly_returns(bytes, columns)) return std::nullopt;
  const Spread told = spread_of(bytes, columns);
  std::optional<std::size_t> best;
  Spread spread_of_best = told;
  for (std::size_t other = kFewestBinColumns; other <= kMostBinColumns; ++other) {
    if (other == columns || bytes.size() % (other * sizeof(float)) != 0) continue;
    const Spread spread = spread_of(bytes, other);
    if (!fits_clearly_better(spread, told)) continue;
    // Multiples of the right number fit as well.
    if (best && spread.of_any.value >= 0.97 * spread_of_best.of_any.value) continue;
    best = other;
    spread_of_best = spread;
  }
  return best;
}

static_assert(std::endian::native == std::endian::little, "scans are copied as they are stored");

void check_bin_size(std::uintmax_t size_bytes, std::size_t columns,
                    const std::filesystem::path& file) {
  if (size_bytes % (columns * sizeof(float)) == 0) return;
  throw DataError(
      file,
      fmt::format("{} bytes are no multiple of {}: cut off, or raw data of another layout",
                  size_bytes, columns * sizeof(float)),
      fmt::format("{} float32 per point (x y z{}{})", columns, columns > 3 ? " intensity" : "",
                  columns > 4 ? " ..." : ""));
}

std::vector<Point> parse_bin(std::string_view bytes, std::size_t columns,
                             const std::filesystem::path& file) {
  check_bin_size(bytes.size(), columns, file);
  const std::size_t record_bytes = columns * sizeof(float);
  const std::size_t taken_bytes = std::min(record_bytes, sizeof(Point));
  std::vector<Point> points(bytes.size() / record_bytes);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::memcpy(&points[i], bytes.data() + i * record_bytes, taken_bytes);
  }
  return points;
}

std::vector<double> parse_bin_times(std::string_view bytes, std::size_t columns,
                                    const std::filesystem::path& file) {
  check_bin_size(bytes.size(), columns, file);
  std::vector<double> times(bytes.size() / (columns * sizeof(float)));
  for (std::size_t i = 0; i < times.size(); ++i) times[i] = number_at(bytes, i * columns + 4);
  return times;
}

std::string_view format_bin(std::span<const Point> points) {
  return {reinterpret_cast<const char*>(points.data()), points.size_bytes()};
}

std::vector<Point> read_bin(const std::filesystem::path& file, std::size_t columns,
                            std::vector<Point> reused) {
  if (columns * sizeof(float) != sizeof(Point)) return parse_bin(read_file(file), columns, file);
  const std::uintmax_t size_bytes = size_of(file);
  check_bin_size(size_bytes, columns, file);
  const auto count = static_cast<std::size_t>(size_bytes) / sizeof(Point);
  if (reused.capacity() < count) reused = {};  // growing would copy old points
  reused.resize(count);
  read_file(file, std::as_writable_bytes(std::span(reused)));
  return reused;
}

void write_bin(const std::filesystem::path& file, std::span<const Point> points) {
  write_file_atomic(file, format_bin(points));
}

}  // namespace mosbench
