#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace mosbench {

/// "format" of the result.json files that this program writes. 1 (not written): `variant` beside
/// the config, no `method` in results of `mosbench run`, settings left out where they were the
/// default.
inline constexpr int kResultFormat = 2;

/// Returns the content of a result.json of any format as one of kResultFormat. Throws DataError for
/// a format that is newer than this program.
nlohmann::ordered_json in_present_format(nlohmann::ordered_json content,
                                         const std::filesystem::path& file);

}  // namespace mosbench
