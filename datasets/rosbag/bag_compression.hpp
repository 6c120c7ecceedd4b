#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace mosbench {

/// Decompresses the chunk of a bag into `size_bytes` bytes; `compression` is "bz2", "lz4" (one LZ4
/// frame) or "zstd". Throws DataError for bytes that are not so compressed or give another size.
std::string decompress_chunk(std::string_view compression, std::string_view bytes,
                             std::uint64_t size_bytes, const std::filesystem::path& file);

/// Returns whether bytes begin as Zstandard does.
bool is_zstd(std::string_view bytes);
/// Decompresses Zstandard, but stops after `most_bytes`. Throws DataError for damaged bytes, and
/// for content beyond kMostChunkBytes.
std::string decompress_zstd(std::string_view bytes, std::size_t most_bytes,
                            const std::filesystem::path& file);
/// Decompresses a file of any size. Throws DataError.
void decompress_zstd_file(const std::filesystem::path& packed, const std::filesystem::path& file);

/// Compresses into one LZ4 frame, or by Zstandard's fastest level.
std::string compress_lz4(std::string_view bytes);
std::string compress_zstd(std::string_view bytes);

}  // namespace mosbench
