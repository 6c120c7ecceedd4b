#include "eval/report/report_asset.hpp"

#include <stdexcept>

namespace mosbench {
namespace {

constexpr std::string_view kContentMarker = "<!-- content of the report -->";

}  // namespace

std::pair<std::string_view, std::string_view> report_asset_parts() {
  const std::string_view asset = report_asset();
  const std::size_t marker = asset.find(kContentMarker);
  if (marker == std::string_view::npos) throw std::logic_error("the page has no content marker");
  return {asset.substr(0, marker), asset.substr(marker + kContentMarker.size())};
}

}  // namespace mosbench
