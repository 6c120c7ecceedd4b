#include "datasets/rosbag/chunk_reader.hpp"

#include <bzlib.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <lz4frame.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <fstream>
#include <new>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kStepBytes = 1U << 20U;

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

/// Returns whether `packed` is Zstandard that gives exactly `content.size()` bytes.
bool decode_zstd(std::string_view packed, std::string& content) {
  const std::size_t size_bytes =
      ZSTD_decompress(content.data(), content.size(), packed.data(), packed.size());
  return !ZSTD_isError(size_bytes) && size_bytes == content.size();
}

/// Returns whether `packed` may give so many bytes: asked before memory is taken for them.
bool may_give(std::string_view compression, std::string_view packed, std::uint64_t size_bytes) {
  constexpr std::uint64_t kMostPerLz4Byte = 255, kLz4HeadBytes = 64;
  if (compression == "lz4") return size_bytes <= kMostPerLz4Byte * (packed.size() + kLz4HeadBytes);
  if (compression != "zstd") return true;
  const unsigned long long said = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (said == ZSTD_CONTENTSIZE_ERROR || said == ZSTD_CONTENTSIZE_UNKNOWN) {
    return said == ZSTD_CONTENTSIZE_UNKNOWN;
  }
  const bool is_one_frame =
      ZSTD_findFrameCompressedSize(packed.data(), packed.size()) == packed.size();
  return is_one_frame ? said == size_bytes : said <= size_bytes;
}

bool decode(std::string_view compression, std::string_view packed, std::string& content) {
  if (compression == "bz2") return decode_bz2(packed, content);
  return compression == "lz4" ? decode_lz4(packed, content) : decode_zstd(packed, content);
}

[[noreturn]] void refuse_zstd(const std::filesystem::path& file) {
  throw DataError(file, "is damaged or cut off", "zstd data");
}

/// Unpacks a stream of Zstandard piece by piece.
class ZstdStream {
 public:
  ZstdStream() : context_(ZSTD_createDCtx()) {
    if (!context_) throw std::bad_alloc();
  }

  /// Appends at most `most_bytes` of what `in` gives. Returns whether there may be more of it;
  /// throws DataError for bytes that are not Zstandard.
  bool unpack(ZSTD_inBuffer& in, std::size_t most_bytes, std::string& content,
              const std::filesystem::path& file) {
    const std::size_t before_bytes = content.size();
    content.resize(before_bytes + std::min(most_bytes, kStepBytes));
    ZSTD_outBuffer out{content.data(), content.size(), before_bytes};
    left_ = ZSTD_decompressStream(context_.get(), &out, &in);
    content.resize(out.pos);
    if (ZSTD_isError(left_)) refuse_zstd(file);
    return in.pos < in.size || out.pos == out.size;
  }
  /// Whether the last frame has come to its end.
  bool is_whole() const { return left_ == 0; }

 private:
  struct Free {
    void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
  };
  std::unique_ptr<ZSTD_DCtx, Free> context_;
  std::size_t left_ = 1;
};

}  // namespace

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

ChunkPart ChunkReader::part_of(const BagChunk& chunk, std::uint64_t offset_bytes,
                               std::uint64_t most_bytes) const {
  if (chunk.is_packed()) {
    auto content = content_of(chunk);
    const std::string_view bytes = std::string_view(*content).substr(offset_bytes);
    return {std::move(content), bytes};
  }
  auto start = std::make_shared<const std::string>(bytes_at(
      chunk.offset_bytes + offset_bytes, std::min(chunk.size_bytes - offset_bytes, most_bytes)));
  return {start, *start};
}

std::string decompress_chunk(std::string_view compression, std::string_view bytes,
                             std::uint64_t size_bytes, const std::filesystem::path& file) {
  if (may_give(compression, bytes, size_bytes)) {
    std::string content(size_bytes, '\0');
    if (decode(compression, bytes, content)) return content;
  }
  throw DataError(file, "a chunk is damaged",
                  fmt::format("{} data of {} bytes", compression, size_bytes));
}

bool is_zstd(std::string_view bytes) { return bytes.starts_with("\x28\xB5\x2F\xFD"); }

std::string decompress_zstd(std::string_view bytes, std::size_t most_bytes,
                            const std::filesystem::path& file) {
  std::string content;
  ZstdStream stream;
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  while (content.size() < most_bytes &&
         stream.unpack(in, most_bytes - content.size(), content, file)) {
    if (content.size() > kMostChunkBytes) refuse_zstd(file);
  }
  if (content.size() < most_bytes && !stream.is_whole()) refuse_zstd(file);
  return content;
}

void decompress_zstd_file(const std::filesystem::path& packed, const std::filesystem::path& file) {
  std::ifstream source(packed, std::ios::binary);
  std::ofstream out(file, std::ios::binary);
  ZstdStream stream;
  std::string bytes(kStepBytes, '\0'), content;
  while (source) {
    source.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    ZSTD_inBuffer in{bytes.data(), static_cast<std::size_t>(source.gcount()), 0};
    for (bool more = in.size > 0; more; content.clear()) {
      more = stream.unpack(in, kStepBytes, content, packed);
      out.write(content.data(), static_cast<std::streamsize>(content.size()));
    }
  }
  if (!stream.is_whole()) refuse_zstd(packed);
  if (!out.flush()) {
    throw DataError(packed, "cannot be unpacked to " + file.string(), "free space there");
  }
}

std::string compress_lz4(std::string_view bytes) {
  std::string packed(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
  packed.resize(
      LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr));
  return packed;
}

std::string compress_zstd(std::string_view bytes) {
  constexpr int kFastest = 1;
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), kFastest));
  return packed;
}

}  // namespace mosbench
