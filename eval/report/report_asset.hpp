#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mosbench {

// Embedded by CMakeLists.txt: the page without its content, as scripts/build_report.sh made it.
std::string_view report_asset();
/// The page of `mosbench rank JOB.yaml --as html`, made likewise.
std::string_view study_asset();

/// Returns the parts of a page before and after the content.
std::pair<std::string_view, std::string_view> parts_of_page(std::string_view asset);

/// Returns JSON for a script element: no string of it can close its element or open another.
std::string script_json(const nlohmann::ordered_json& json);

/// Returns a page with its content, and with blocks of text named block-0, block-1, ...
std::string filled_page(std::string_view asset, const nlohmann::ordered_json& content,
                        const std::vector<std::string>& blocks = {});

}  // namespace mosbench
