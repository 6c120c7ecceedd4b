#pragma once

#include <span>
#include <string_view>

namespace mosbench {

/// Returns the candidate with the fewest inserted, deleted or replaced characters, the first of
/// equals; empty when there is no candidate. For "did you mean" in errors.
std::string_view nearest_name(std::string_view name, std::span<const std::string_view> candidates);

}  // namespace mosbench
