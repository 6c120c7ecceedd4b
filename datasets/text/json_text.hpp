#pragma once

#include <exception>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace mosbench {

/// Parses JSON. Throws DataError that begins with `origin` if it is no JSON, has a key twice in one
/// object, nests more than 64 levels deep, which would exhaust the stack later, or has more than
/// 20,000 keys in one object, whose time grows with their square.
nlohmann::ordered_json parse_json(std::string_view text, const std::filesystem::path& origin);

/// Returns what the library says of JSON, without its own numbers: "lacks \"scans\"".
std::string sentence_of(const std::exception& error);

}  // namespace mosbench
