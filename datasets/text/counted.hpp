#pragma once

#include <concepts>
#include <string>
#include <string_view>

namespace mosbench {

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

}  // namespace mosbench
