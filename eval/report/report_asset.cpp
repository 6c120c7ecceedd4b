#include "eval/report/report_asset.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

namespace mosbench {
namespace {

using nlohmann::ordered_json;

constexpr std::string_view kContentMarker = "<!-- content of the report -->";

}  // namespace

std::pair<std::string_view, std::string_view> parts_of_page(std::string_view asset) {
  const std::size_t marker = asset.find(kContentMarker);
  if (marker == std::string_view::npos) throw std::logic_error("the page has no content marker");
  return {asset.substr(0, marker), asset.substr(marker + kContentMarker.size())};
}

std::string script_json(const ordered_json& json) {
  const std::string text = json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      escaped += "\\u003c";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string filled_page(std::string_view asset, const ordered_json& content,
                        const std::vector<std::string>& blocks) {
  const auto [before, behind] = parts_of_page(asset);
  std::string html(before);
  html += "<script type=\"application/json\" id=\"report\">" + script_json(content) + "</script>\n";
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    html += fmt::format("<script type=\"text/plain\" id=\"block-{}\">", i);
    html += blocks[i];
    html += "</script>\n";
  }
  html += behind;
  return html;
}

}  // namespace mosbench
