#include "eval/result/point_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "datasets/text/errors.hpp"

namespace mosbench {

static_assert(std::endian::native == std::endian::little, "scores are copied as they are stored");

std::vector<float> parse_dynamic_scores(std::string_view bytes, std::size_t point_count,
                                        ScoreNumbers numbers, const std::filesystem::path& file) {
  static_assert(sizeof(float) == sizeof(std::int32_t));
  const std::size_t expected_bytes = point_count * sizeof(float);
  if (bytes.size() != expected_bytes) {
    throw DataError(file, fmt::format("has {} bytes", bytes.size()),
                    fmt::format("one {} for each of the {} points of its scan ({} bytes)",
                                numbers == ScoreNumbers::kInt32 ? "int32" : "float32", point_count,
                                expected_bytes));
  }
  std::vector<float> scores(point_count);
  if (scores.empty()) return scores;
  if (numbers == ScoreNumbers::kFloat32) {
    std::memcpy(scores.data(), bytes.data(), bytes.size());
  } else {
    std::vector<std::int32_t> whole(point_count);
    std::memcpy(whole.data(), bytes.data(), bytes.size());
    std::ranges::transform(whole, scores.begin(),
                           [](std::int32_t score) { return static_cast<float>(score); });
  }
  const auto wrong =
      std::ranges::find_if_not(scores, [](float score) { return std::isfinite(score); });
  if (wrong == scores.end()) return scores;
  throw DataError(file, fmt::format("score {} is {}", wrong - scores.begin(), *wrong),
                  "a finite number");
}

std::string_view format_dynamic_scores(std::span<const float> scores) {
  return {reinterpret_cast<const char*>(scores.data()), scores.size_bytes()};
}

std::filesystem::path dynamic_score_file(const std::filesystem::path& folder,
                                         std::string_view stem) {
  return folder / "scores" / fmt::format("{}.score", stem);
}

std::vector<Reason> parse_reasons(std::string_view bytes, std::size_t point_count,
                                  const std::filesystem::path& file) {
  if (bytes.size() != point_count) {
    throw DataError(file, fmt::format("has {} bytes", bytes.size()),
                    fmt::format("one for each of the {} points of its scan", point_count));
  }
  const auto number = [](char byte) { return static_cast<unsigned char>(byte); };
  const auto wrong = std::ranges::find_if(bytes, [&](char b) { return number(b) >= kReasonCount; });
  if (wrong != bytes.end()) {
    throw DataError(file, fmt::format("reason {} is {}", wrong - bytes.begin(), number(*wrong)),
                    fmt::format("0 to {}", kReasonCount - 1));
  }
  std::vector<Reason> reasons;
  for (const char byte : bytes) reasons.push_back(static_cast<Reason>(byte));
  return reasons;
}

std::string_view format_reasons(std::span<const Reason> reasons) {
  return {reinterpret_cast<const char*>(reasons.data()), reasons.size_bytes()};
}

std::filesystem::path reason_file(const std::filesystem::path& folder, std::string_view stem) {
  return folder / "reasons" / fmt::format("{}.reason", stem);
}

}  // namespace mosbench
