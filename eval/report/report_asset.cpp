#include "eval/report/report_asset.hpp"

#include <stdexcept>

// The compiler has no #embed yet; its assembler takes files as they are.
#define MOSBENCH_EMBED(symbol, file)      \
  __asm__(                                \
      ".section .rodata\n"                \
      ".global " #symbol "\n" #symbol     \
      ":\n"                               \
      ".incbin \"" file                   \
      "\"\n"                              \
      ".global " #symbol "_end\n" #symbol \
      "_end:\n"                           \
      ".byte 0\n"                         \
      ".text\n");                         \
  extern "C" {                            \
  extern const char symbol[];             \
  extern const char symbol##_end[];       \
  }

MOSBENCH_EMBED(mosbench_report_page, MOSBENCH_REPORT_PAGE)
MOSBENCH_EMBED(mosbench_palette, MOSBENCH_PALETTE)
MOSBENCH_EMBED(mosbench_glyphs, MOSBENCH_GLYPHS)

namespace mosbench {
namespace {

constexpr std::string_view kContentMarker = "<!-- content of the report -->";

}  // namespace

std::string_view report_asset() { return {mosbench_report_page, mosbench_report_page_end}; }

std::pair<std::string_view, std::string_view> report_asset_parts() {
  const std::string_view asset = report_asset();
  const std::size_t marker = asset.find(kContentMarker);
  if (marker == std::string_view::npos) throw std::logic_error("the page has no content marker");
  return {asset.substr(0, marker), asset.substr(marker + kContentMarker.size())};
}

std::string_view glyphs_asset() { return {mosbench_glyphs, mosbench_glyphs_end}; }

std::string_view palette_asset() { return {mosbench_palette, mosbench_palette_end}; }

}  // namespace mosbench
