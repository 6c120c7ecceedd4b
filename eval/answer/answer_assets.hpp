#pragma once

#include <string_view>

namespace mosbench {

// Embedded by CMakeLists.txt: a PGM picture of the letters that pictures hold, and the colours of
// pictures and of the report's page as JSON.
std::string_view glyphs_asset();
std::string_view palette_asset();

}  // namespace mosbench
