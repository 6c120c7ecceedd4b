#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace mosbench {

/// Whether this build reads compressed bags and writes bags (MOSBENCH_WITH_ROSBAG).
bool has_rosbag();

/// The content of a chunk of `size_bytes` by librosbag_storage; `compression` is "bz2" or "lz4".
/// Throws DataError for bytes that are not so compressed or give another size, and always in a
/// build without the library.
std::string decompress_chunk(std::string_view compression, std::string_view bytes,
                             std::uint32_t size_bytes, const std::filesystem::path& file);

}  // namespace mosbench
