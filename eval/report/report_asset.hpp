#pragma once

#include <string_view>
#include <utility>

namespace mosbench {

/// The page without its content, as scripts/build_report.sh made it.
std::string_view report_asset();

/// What of it stands before and behind the content.
std::pair<std::string_view, std::string_view> report_asset_parts();

/// A PGM picture of the letters that `mosbench render` writes with.
std::string_view glyphs_asset();

/// Colours of the page and of `mosbench render`, JSON.
std::string_view palette_asset();

}  // namespace mosbench
