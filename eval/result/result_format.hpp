#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace mosbench {

/// Returns the content of a result.json of any format as one of kResultFormat. Throws DataError for
/// a format that is newer than this program, nlohmann's exceptions for what is no result.
nlohmann::ordered_json in_present_format(nlohmann::ordered_json content,
                                         const std::filesystem::path& file);

}  // namespace mosbench
