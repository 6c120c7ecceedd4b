#pragma once

#include <string>
#include <string_view>

namespace mosbench {

/// `bytes` in zlib's format (RFC 1950), then in base64 (RFC 4648): what a browser's
/// DecompressionStream("deflate") takes after atob().
std::string compressed_text(std::string_view bytes);

}  // namespace mosbench
