#include "eval/result/reason_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/text/errors.hpp"

namespace mosbench {

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
