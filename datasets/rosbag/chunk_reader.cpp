#include "datasets/rosbag/chunk_reader.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include "datasets/disk/files.hpp"
#include "datasets/rosbag/bag_compression.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {

void check_chunk_size(const BagChunk& chunk, std::uint64_t room_bytes,
                      const std::filesystem::path& file) {
  const bool fits = chunk.stored_bytes <= room_bytes && chunk.size_bytes <= kMostChunkBytes &&
                    (chunk.is_packed() || chunk.size_bytes == chunk.stored_bytes);
  if (fits) return;
  throw DataError(
      file,
      fmt::format("a chunk of {} bytes claims to have {}", chunk.stored_bytes, chunk.size_bytes),
      fmt::format("its size, at most {}", kMostChunkBytes));
}

ChunkReader::ChunkReader(const std::filesystem::path& file)
    : file_(file),
      size_bytes_(size_of(file)),
      descriptor_(open(file.c_str(), O_RDONLY | O_NOCTTY | O_CLOEXEC)) {
  if (!descriptor_.is_open()) throw DataError(file, "cannot be opened", "a readable file");
}

std::string ChunkReader::bytes_at(std::uint64_t offset_bytes, std::uint64_t count) const {
  std::string bytes(count, '\0');
  std::size_t done = 0;
  while (done < count) {
    const ssize_t got = pread(descriptor_.number(), bytes.data() + done, count - done,
                              static_cast<off_t>(offset_bytes + done));
    if (got > 0) {
      done += static_cast<std::size_t>(got);
    } else if (got == 0 || errno != EINTR) {
      throw DataError(file_, fmt::format("cannot be read at byte {}", offset_bytes + done),
                      "a readable file that does not change");
    }
  }
  return bytes;
}

std::shared_ptr<const std::string> ChunkReader::content_of(const BagChunk& chunk) const {
  const std::lock_guard lock(mutex_);
  if (kept_.second && kept_.first == chunk.offset_bytes) return kept_.second;
  std::string content = bytes_at(chunk.offset_bytes, chunk.stored_bytes);
  if (chunk.is_packed()) {
    content = decompress_chunk(chunk.compression, content, chunk.size_bytes, file_);
  }
  const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(content.data()), content.size());
  if (chunk.crc != 0 && crc != chunk.crc) {
    throw DataError(file_, fmt::format("the chunk at byte {} is damaged", chunk.offset_bytes),
                    "content of its CRC");
  }
  kept_ = {chunk.offset_bytes, std::make_shared<const std::string>(std::move(content))};
  return kept_.second;
}

}  // namespace mosbench
