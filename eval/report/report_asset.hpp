#pragma once

#include <string_view>
#include <utility>

namespace mosbench {

// Embedded by CMakeLists.txt: the page without its content, as scripts/build_report.sh made it; a
// PGM picture of the letters that `mosbench render` writes with; the colours of both as JSON.
std::string_view report_asset();
std::string_view glyphs_asset();
std::string_view palette_asset();

/// Returns the parts of the page before and after the content.
std::pair<std::string_view, std::string_view> report_asset_parts();

}  // namespace mosbench
