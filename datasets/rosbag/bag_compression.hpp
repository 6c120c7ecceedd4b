#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace mosbench {

/// Decompresses the chunk of a bag into `size_bytes` bytes; `compression` is "bz2" or "lz4" (one
/// LZ4 frame). Throws DataError for bytes that are not so compressed or give another size.
std::string decompress_chunk(std::string_view compression, std::string_view bytes,
                             std::uint32_t size_bytes, const std::filesystem::path& file);

}  // namespace mosbench
