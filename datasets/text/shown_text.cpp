#include "datasets/text/shown_text.hpp"

#include <fmt/format.h>
#include <utf8.h>

#include <cstdint>
#include <iterator>

namespace mosbench {
namespace {

/// C0, DEL and C1: a terminal that reads UTF-8 obeys the last like ESC.
bool is_control(std::uint32_t character) {
  return character < 0x20 || (character >= 0x7F && character < 0xA0);
}

void append_escaped(std::string_view bytes, std::string& text) {
  for (const char byte : bytes) {
    fmt::format_to(std::back_inserter(text), "\\x{:02x}", static_cast<unsigned char>(byte));
  }
}

std::string escaped_but(std::string_view text, std::string_view kept) {
  std::string safe;
  safe.reserve(text.size());
  while (!text.empty()) {
    const auto valid =
        static_cast<std::size_t>(utf8::find_invalid(text.begin(), text.end()) - text.begin());
    for (auto at = text.begin(), end = at + static_cast<std::ptrdiff_t>(valid); at != end;) {
      const auto from = at;
      const std::uint32_t character = utf8::unchecked::next(at);
      const std::string_view bytes(from, at);
      if (is_control(character) && kept.find(bytes) == std::string_view::npos) {
        append_escaped(bytes, safe);
      } else {
        safe += bytes;
      }
    }
    append_escaped(text.substr(valid, 1), safe);
    text.remove_prefix(std::min(valid + 1, text.size()));
  }
  return safe;
}

}  // namespace

bool is_printable(std::string_view text) { return shown_in_line(text) == text; }

std::string shown(std::string_view text) { return escaped_but(text, "\n\t"); }

std::string shown_in_line(std::string_view text) { return escaped_but(text, ""); }

}  // namespace mosbench
