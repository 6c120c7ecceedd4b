#include "datasets/rosbag/bag_compression.hpp"

#include <bzlib.h>
#include <roslz4/lz4s.h>

#include "datasets/files/errors.hpp"

namespace mosbench {
namespace {

/// Whether exactly `content.size()` bytes came out. The library's own wrapper of the two checks
/// neither the size nor all return codes, so its decoders are called as it calls them.
bool decode(std::string_view compression, std::string& packed, std::string& content) {
  auto size_bytes = static_cast<unsigned int>(content.size());
  if (compression == "bz2") {
    return BZ2_bzBuffToBuffDecompress(content.data(), &size_bytes, packed.data(),
                                      static_cast<unsigned int>(packed.size()), 0, 0) == BZ_OK &&
           size_bytes == content.size();
  }
  return roslz4_buffToBuffDecompress(packed.data(), static_cast<unsigned int>(packed.size()),
                                     content.data(), &size_bytes) == ROSLZ4_OK &&
         size_bytes == content.size();
}

}  // namespace

bool has_rosbag() { return true; }

std::string decompress_chunk(std::string_view compression, std::string_view bytes,
                             std::uint32_t size_bytes, const std::filesystem::path& file) {
  std::string packed(bytes);
  std::string content(size_bytes, '\0');
  if (decode(compression, packed, content)) return content;
  throw DataError(file, "a chunk is damaged",
                  std::string(compression) + " data of " + std::to_string(size_bytes) + " bytes");
}

}  // namespace mosbench
