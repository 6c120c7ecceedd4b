#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include "datasets/disk/partial_file.hpp"

namespace mosbench {

/// Part of a bag that holds records, packed or not.
struct BagChunk {
  std::uint64_t offset_bytes = 0;  ///< of its content in the file
  std::uint64_t stored_bytes = 0;
  std::uint64_t size_bytes = 0;  ///< unpacked
  std::string compression = {};  ///< "" or "none", "bz2", "lz4", "zstd"
  std::uint32_t crc = 0;         ///< CRC-32 of the unpacked content; 0: not known
  bool is_packed() const { return !compression.empty() && compression != "none"; }
};

/// The longest chunk that is read: what one claims to hold is allocated.
inline constexpr std::uint64_t kMostChunkBytes = 1ULL << 29U;

/// Throws DataError for a chunk that claims more than `room_bytes` in the file or more than
/// kMostChunkBytes inside, and for a plain chunk whose two sizes differ.
void check_chunk_size(const BagChunk& chunk, std::uint64_t room_bytes,
                      const std::filesystem::path& file);

/// Bytes of a chunk.
struct ChunkPart {
  std::shared_ptr<const std::string> held;
  std::string_view bytes;
};

/// Reads the bytes of a bag and keeps one unpacked chunk. Safe to call from several threads.
class ChunkReader {
 public:
  /// Throws DataError when the file cannot be opened.
  explicit ChunkReader(const std::filesystem::path& file);

  std::uint64_t size_bytes() const { return size_bytes_; }
  /// Throws DataError when the file does not hold so many bytes there.
  std::string bytes_at(std::uint64_t offset_bytes, std::uint64_t count) const;
  /// Returns the content of a chunk, which is within the file and at most kMostChunkBytes long.
  /// Throws DataError for one that is damaged.
  std::shared_ptr<const std::string> content_of(const BagChunk& chunk) const;
  /// Returns what a chunk holds from `offset_bytes` on, within it: all where it is packed, else the
  /// first `most_bytes`.
  ChunkPart part_of(const BagChunk& chunk, std::uint64_t offset_bytes,
                    std::uint64_t most_bytes) const;

 private:
  std::filesystem::path file_;
  std::uint64_t size_bytes_;
  FileDescriptor descriptor_;
  mutable std::mutex mutex_;                                                   ///< of kept_
  mutable std::pair<std::uint64_t, std::shared_ptr<const std::string>> kept_;  ///< by its offset
};

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
/// Returns a message whose first bytes `stored` gives, no more than `most_bytes`, unpacked where it
/// is packed on its own, as rosbag2 does with `--compression-mode message`. Throws DataError.
template <typename Stored>
std::string unpacked_message(const Stored& stored, std::size_t most_bytes,
                             const std::filesystem::path& file) {
  std::string bytes = stored(most_bytes);
  if (!is_zstd(bytes)) return bytes;
  if (bytes.size() == most_bytes) bytes = stored(SIZE_MAX);
  return decompress_zstd(bytes, most_bytes, file);
}
/// Decompresses a file of any size. Throws DataError.
void decompress_zstd_file(const std::filesystem::path& packed, const std::filesystem::path& file);

/// Compresses into one LZ4 frame, or by Zstandard's fastest level.
std::string compress_lz4(std::string_view bytes);
std::string compress_zstd(std::string_view bytes);

}  // namespace mosbench
