#include "eval/results/dynamic_score_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "datasets/files/errors.hpp"

namespace mosbench {

static_assert(std::endian::native == std::endian::little, "scores are copied as they are stored");

std::vector<std::int32_t> parse_dynamic_scores(std::string_view bytes, std::size_t point_count,
                                               const std::filesystem::path& file) {
  std::vector<std::int32_t> scores(point_count);
  const std::size_t expected_bytes = point_count * sizeof(std::int32_t);
  if (bytes.size() != expected_bytes) {
    throw DataError(file, fmt::format("has {} bytes", bytes.size()),
                    fmt::format("one int32 for each of the {} points of its scan ({} bytes)",
                                point_count, expected_bytes));
  }
  if (!scores.empty()) std::memcpy(scores.data(), bytes.data(), bytes.size());
  const auto negative = std::ranges::find_if(scores, [](std::int32_t score) { return score < 0; });
  if (negative == scores.end()) return scores;
  throw DataError(file, fmt::format("score {} is {}", negative - scores.begin(), *negative),
                  "a sum of votes, which is not negative");
}

std::string_view format_dynamic_scores(std::span<const std::int32_t> scores) {
  return {reinterpret_cast<const char*>(scores.data()), scores.size_bytes()};
}

std::filesystem::path dynamic_score_file(const std::filesystem::path& folder,
                                         std::string_view stem) {
  return folder / "scores" / fmt::format("{}.score", stem);
}

}  // namespace mosbench
