#pragma once

#include <string>
#include <string_view>

namespace mosbench {

/// Compresses `bytes` in zlib's format (RFC 1950) and encodes them in base64 (RFC 4648), for a
/// browser's atob() and DecompressionStream("deflate").
std::string compressed_text(std::string_view bytes);

}  // namespace mosbench
