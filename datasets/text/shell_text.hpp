#pragma once

#include <string>
#include <string_view>

namespace mosbench {

/// Returns `text` as one word of a POSIX shell: unchanged where it is one, otherwise in quotes.
std::string shell_word(std::string_view text);

}  // namespace mosbench
