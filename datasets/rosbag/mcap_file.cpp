#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/formats/byte_cursor.hpp"
#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/rosbag/chunk_reader.hpp"
#include "datasets/rosbag/mcap_record.hpp"
#include "datasets/rosbag/message_format.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr const char* kMcap = "an MCAP file as its recorder left it";
/// A message begins with its channel, a sequence number and two times.
constexpr std::uint64_t kMessageHeadBytes = 22;
constexpr std::uint64_t kMostTextBytes = 1U << 24U;

std::int64_t time_ns(std::uint64_t stored) {
  return static_cast<std::int64_t>(std::min<std::uint64_t>(stored, INT64_MAX));
}

/// A ROS 2 bag in one MCAP file (mcap.dev). Opening walks over the heads of its records, and reads
/// the content of chunks only if no index follows them. A file that its recorder did not close is
/// read up to the last whole record; a remark says so.
class McapFile : public BagReader {
 public:
  /// Throws DataError for a file that is no MCAP, is damaged, or has a chunk that is compressed
  /// otherwise than by lz4 or zstd.
  explicit McapFile(const std::filesystem::path& file) : BagReader(file), in_(file) {
    walk();
    scan_chunks();
    check_channels();
    if (has_statistics_ && messages_.size() != counted_messages_) {
      throw DataError(file, fmt::format("holds {} messages", messages_.size()),
                      fmt::format("{} by its statistics", counted_messages_));
    }
  }

  std::string read(const BagMessage& message, std::size_t most_bytes = SIZE_MAX) const override {
    if (format_of(message).encoding != MessageEncoding::kCdr) return stored(message, most_bytes);
    return unpacked_message([&](std::size_t most) { return stored(message, most); }, most_bytes,
                            path_);
  }

 private:
  std::string stored(const BagMessage& message, std::size_t most_bytes) const {
    constexpr std::uint64_t kStartBytes = kMcapRecordHeadBytes + kMessageHeadBytes;
    const BagChunk whole{0, in_.size_bytes(), in_.size_bytes()};
    const BagChunk& chunk = message.chunk == kNoChunk ? whole : chunks_.at(message.chunk).chunk;
    const ChunkPart part = in_.part_of(chunk, message.offset_bytes, kStartBytes);
    ByteCursor cursor(part.bytes, path_, "a message");
    const auto op = static_cast<McapOp>(cursor.take<std::uint8_t>());
    const auto count = cursor.take<std::uint64_t>();
    const auto channel = cursor.take<std::uint16_t>();
    if (op != McapOp::kMessage || channel != message.connection || count < kMessageHeadBytes) {
      throw DataError(path_, "an index entry leads to no message of its channel", kMcap);
    }
    if (count > chunk.size_bytes - message.offset_bytes - kMcapRecordHeadBytes) {
      throw DataError(path_, "a message does not end within its chunk", kMcap);
    }
    const std::size_t wanted_bytes = std::min<std::uint64_t>(count - kMessageHeadBytes, most_bytes);
    if (!chunk.is_packed()) {
      return in_.bytes_at(chunk.offset_bytes + message.offset_bytes + kStartBytes, wanted_bytes);
    }
    cursor.take_bytes(kMessageHeadBytes - sizeof(std::uint16_t));
    return std::string(cursor.take_bytes(wanted_bytes));
  }

  struct IndexedChunk {
    BagChunk chunk;
    bool has_index = false;
  };
  /// `chunk` of a message that is in none.
  static constexpr std::size_t kNoChunk = SIZE_MAX;

  void walk() {
    const std::uint64_t file_bytes = in_.size_bytes();
    std::uint64_t at = kMcapMagic.size();
    if (file_bytes < at || in_.bytes_at(0, at) != kMcapMagic) {
      throw DataError(path_, "does not start like an MCAP file", kMcap);
    }
    while (file_bytes - at >= kMcapRecordHeadBytes) {
      const std::string head = in_.bytes_at(at, kMcapRecordHeadBytes);
      ByteCursor cursor(head, path_, "a record");
      const auto op = static_cast<McapOp>(cursor.take<std::uint8_t>());
      const auto count = cursor.take<std::uint64_t>();
      // Disks leave zeros where a recorder was cut off.
      if (op == McapOp{} || count > file_bytes - at - kMcapRecordHeadBytes) break;
      at += kMcapRecordHeadBytes;
      if (op == McapOp::kFooter) return;
      take_record(op, at, count);
      at += count;
    }
    forget_last_index();
    doubts_.push_back(
        fmt::format("{} was not closed by its recorder: the last {} of {} bytes are "
                    "no whole record and left out",
                    path_.filename().string(), file_bytes - at, file_bytes));
  }

  /// The index of the chunk before a cut may lack channels: the chunk itself is read instead.
  void forget_last_index() {
    if (chunks_.empty()) return;
    chunks_.back().has_index = false;
    std::erase_if(messages_, [last = chunks_.size() - 1](const BagMessage& message) {
      return message.chunk == last;
    });
  }

  void take_record(McapOp op, std::uint64_t at_bytes, std::uint64_t count) {
    const auto content = [&] {
      if (count > kMostTextBytes) {
        throw DataError(path_, fmt::format("the record at byte {} has {} bytes", at_bytes, count),
                        kMcap);
      }
      return in_.bytes_at(at_bytes, count);
    };
    switch (op) {
      case McapOp::kSchema:
        return add_schema(content());
      case McapOp::kChannel:
        return add_channel(content());
      case McapOp::kMessage:
        return add_message(in_.bytes_at(at_bytes, std::min(count, kMessageHeadBytes)), kNoChunk,
                           at_bytes - kMcapRecordHeadBytes);
      case McapOp::kChunk:
        return add_chunk(at_bytes, count);
      case McapOp::kMessageIndex:
        return add_index(content());
      case McapOp::kStatistics:
        return add_statistics(content());
      case McapOp::kHeader:
      case McapOp::kFooter:
      case McapOp::kChunkIndex:
      case McapOp::kSummaryOffset:
      case McapOp::kDataEnd:
      default:
        return;  // attachments and others, which later versions may add
    }
  }

  void add_chunk(std::uint64_t at_bytes, std::uint64_t count) {
    constexpr std::uint64_t kMostHeadBytes = 128;
    const std::string head = in_.bytes_at(at_bytes, std::min(count, kMostHeadBytes));
    ByteCursor cursor(head, path_, "a chunk");
    cursor.take<std::uint64_t>();  // time of the first message
    cursor.take<std::uint64_t>();  // of the last
    BagChunk chunk;
    chunk.size_bytes = cursor.take<std::uint64_t>();
    chunk.crc = cursor.take<std::uint32_t>();
    chunk.compression = cursor.take_counted();
    chunk.stored_bytes = cursor.take<std::uint64_t>();
    const std::uint64_t head_bytes = head.size() - cursor.rest().size();
    chunk.offset_bytes = at_bytes + head_bytes;
    if (chunk.is_packed() && chunk.compression != "lz4" && chunk.compression != "zstd") {
      throw DataError(path_, "a chunk is compressed by \"" + chunk.compression + "\"",
                      "none, lz4 or zstd");
    }
    check_chunk_size(chunk, count - head_bytes, path_);
    chunks_.push_back({std::move(chunk), false});
  }

  void add_index(std::string_view content) {
    ByteCursor cursor(content, path_, "a message index");
    const auto channel = cursor.take<std::uint16_t>();
    const std::string_view entries = cursor.take_counted();
    if (chunks_.empty()) throw DataError(path_, "a message index follows no chunk", kMcap);
    IndexedChunk& indexed = chunks_.back();
    indexed.has_index = true;
    ByteCursor entry(entries, path_, "a message index");
    while (!entry.rest().empty()) {
      const auto recorded = entry.take<std::uint64_t>();
      const auto offset_bytes = entry.take<std::uint64_t>();
      if (offset_bytes >= indexed.chunk.size_bytes) {
        throw DataError(path_, "an index entry points beyond its chunk", kMcap);
      }
      messages_.push_back({channel, time_ns(recorded), chunks_.size() - 1, offset_bytes});
    }
  }

  void add_schema(std::string_view content) {
    ByteCursor cursor(content, path_, "a schema");
    const auto id = cursor.take<std::uint16_t>();
    type_of_schema_[id] = ros1_type(cursor.take_counted());
  }

  void add_channel(std::string_view content) {
    ByteCursor cursor(content, path_, "a channel");
    const std::uint32_t id = cursor.take<std::uint16_t>();
    if (find_connection(id) != nullptr) return;  // the summary repeats them
    const auto schema = cursor.take<std::uint16_t>();
    BagConnection connection;
    connection.id = id;
    connection.topic = cursor.take_counted();
    const std::string_view encoding = cursor.take_counted();
    connection.type = type_of_schema_[schema];
    if (encoding == "cdr") {
      connection.encoding = MessageEncoding::kCdr;
    } else if (encoding != "ros1") {
      // Another name, so that nothing parses it and errors tell it.
      connection.type += fmt::format(" as {}", encoding);
    }
    add(std::move(connection));
  }

  void add_message(std::string_view head, std::size_t chunk, std::uint64_t offset_bytes) {
    ByteCursor cursor(head, path_, "a message");
    const auto channel = cursor.take<std::uint16_t>();
    cursor.take<std::uint32_t>();  // sequence
    const auto recorded = cursor.take<std::uint64_t>();
    cursor.take<std::uint64_t>();  // when it was published
    messages_.push_back({channel, time_ns(recorded), chunk, offset_bytes});
  }

  void add_statistics(std::string_view content) {
    ByteCursor cursor(content, path_, "the statistics");
    counted_messages_ = cursor.take<std::uint64_t>();
    has_statistics_ = true;
  }

  void scan_chunks() {
    std::set<std::size_t> unknown;
    for (std::size_t chunk = 0; chunk < chunks_.size(); ++chunk) {
      if (!chunks_[chunk].has_index) unknown.insert(chunk);
    }
    std::set<std::uint32_t> known;
    for (const BagConnection& connection : connections()) known.insert(connection.id);
    // Without a summary channels are told within chunks only.
    for (const BagMessage& message : messages_) {
      if (message.chunk != kNoChunk && !known.contains(message.connection)) {
        unknown.insert(message.chunk);
      }
    }
    for (const std::size_t chunk : unknown) scan_chunk(chunk, !chunks_[chunk].has_index);
  }

  void scan_chunk(std::size_t chunk, bool takes_messages) {
    const auto content = in_.content_of(chunks_[chunk].chunk);
    ByteCursor cursor(*content, path_, "a chunk");
    while (!cursor.rest().empty()) {
      const std::uint64_t at_bytes = content->size() - cursor.rest().size();
      const auto op = static_cast<McapOp>(cursor.take<std::uint8_t>());
      const std::string_view record = cursor.take_bytes(cursor.take<std::uint64_t>());
      if (op == McapOp::kSchema) add_schema(record);
      if (op == McapOp::kChannel) add_channel(record);
      if (op == McapOp::kMessage && takes_messages) add_message(record, chunk, at_bytes);
    }
  }

  void check_channels() const {
    std::set<std::uint32_t> known;
    for (const BagConnection& connection : connections()) known.insert(connection.id);
    for (const BagMessage& message : messages_) {
      if (known.contains(message.connection)) continue;
      throw DataError(path_, fmt::format("channel {} of a message is missing", message.connection),
                      kMcap);
    }
  }

  ChunkReader in_;
  std::map<std::uint16_t, std::string> type_of_schema_;
  std::vector<IndexedChunk> chunks_;
  std::uint64_t counted_messages_ = 0;  ///< by the statistics
  bool has_statistics_ = false;
};

}  // namespace

std::unique_ptr<const BagReader> open_mcap(const std::filesystem::path& file) {
  return std::make_unique<McapFile>(file);
}

}  // namespace mosbench
