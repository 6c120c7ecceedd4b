#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string_view>

namespace mosbench {

/// Parses JSON. Throws DataError that begins with `origin` if it is no JSON, has a key twice in one
/// object, or nests more than 64 levels deep, which would exhaust the stack later.
nlohmann::ordered_json parse_json(std::string_view text, const std::filesystem::path& origin);

}  // namespace mosbench
