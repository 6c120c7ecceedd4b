#pragma once

#include <string>
#include <string_view>

namespace mosbench {

/// Returns whether `text` is UTF-8 without control characters (C0, DEL, C1).
bool is_printable(std::string_view text);

/// Returns `text` as a terminal may show it: control characters other than line feeds and tabs,
/// which a terminal would obey, and bytes that are no UTF-8 as \xNN.
std::string shown(std::string_view text);

/// The same for one line, such as a name: line feeds and tabs become \x0a and \x09, too.
std::string shown_in_line(std::string_view text);

}  // namespace mosbench
