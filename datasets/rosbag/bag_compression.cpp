#include "datasets/rosbag/bag_compression.hpp"

#include <bzlib.h>
#include <lz4frame.h>

#include "datasets/files/errors.hpp"

namespace mosbench {
namespace {

/// Returns whether `packed` is a bzip2 stream that gives exactly `content.size()` bytes.
bool decode_bz2(std::string_view packed, std::string& content) {
  auto size_bytes = static_cast<unsigned int>(content.size());
  // The library takes its input as char* but does not write to it.
  const int result =
      BZ2_bzBuffToBuffDecompress(content.data(), &size_bytes, const_cast<char*>(packed.data()),
                                 static_cast<unsigned int>(packed.size()), 0, 0);
  return result == BZ_OK && size_bytes == content.size();
}

/// Returns whether `packed` is an LZ4 frame that gives exactly `content.size()` bytes.
bool decode_lz4(std::string_view packed, std::string& content) {
  LZ4F_dctx* decoder = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&decoder, LZ4F_VERSION))) return false;
  std::size_t read_bytes = 0, written_bytes = 0, wanted_bytes = 1;
  while (wanted_bytes != 0) {
    std::size_t out_bytes = content.size() - written_bytes;
    std::size_t in_bytes = packed.size() - read_bytes;
    wanted_bytes = LZ4F_decompress(decoder, content.data() + written_bytes, &out_bytes,
                                   packed.data() + read_bytes, &in_bytes, nullptr);
    // Without progress the frame is cut off or gives more bytes than there is room for.
    if (LZ4F_isError(wanted_bytes) || (out_bytes == 0 && in_bytes == 0)) break;
    written_bytes += out_bytes;
    read_bytes += in_bytes;
  }
  LZ4F_freeDecompressionContext(decoder);
  return wanted_bytes == 0 && written_bytes == content.size();
}

}  // namespace

std::string decompress_chunk(std::string_view compression, std::string_view bytes,
                             std::uint32_t size_bytes, const std::filesystem::path& file) {
  std::string content(size_bytes, '\0');
  if (compression == "bz2" ? decode_bz2(bytes, content) : decode_lz4(bytes, content)) {
    return content;
  }
  throw DataError(file, "a chunk is damaged",
                  std::string(compression) + " data of " + std::to_string(size_bytes) + " bytes");
}

}  // namespace mosbench
