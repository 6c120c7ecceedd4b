#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "datasets/formats/byte_cursor.hpp"
#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/rosbag/chunk_reader.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr std::string_view kVersionLine = "#ROSBAG V2.0\n";
constexpr std::uint32_t kMostHeaderBytes = 1U << 20U;
constexpr std::uint32_t kIndexEntryBytes = 12;
constexpr const char* kBag = "a closed ROS bag of version 2.0";

/// The kinds of records of a ROS 1 bag (version 2.0): values of the header's field "op".
enum class BagOp : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkSummary = 6,
  kConnection = 7
};

/// The fields "name=value" of a record's header, or of a connection's description. Views into the
/// bytes they were parsed from.
class BagFields {
 public:
  /// Throws DataError for a field that is cut off or has no "=".
  BagFields(std::string_view header, const std::filesystem::path& file) : file_(file) {
    ByteCursor cursor(header, file, "the header of a bag record");
    while (!cursor.rest().empty()) {
      const std::string_view field = cursor.take_counted();
      const auto equals = field.find('=');
      if (equals == std::string_view::npos) {
        throw DataError(file, "a header field of a bag record has no name", "name=value");
      }
      fields_.emplace_back(field.substr(0, equals), field.substr(equals + 1));
    }
  }

  /// Each throws DataError when the field is not there or has another size.
  std::string_view text(std::string_view name) const {
    for (const auto& [key, value] : fields_) {
      if (key == name) return value;
    }
    throw DataError(file_, "a bag record has no field \"" + std::string(name) + "\"",
                    "a ROS bag of version 2.0");
  }

  std::uint8_t u8(std::string_view name) const { return number<std::uint8_t>(name); }
  std::uint32_t u32(std::string_view name) const { return number<std::uint32_t>(name); }
  std::uint64_t u64(std::string_view name) const { return number<std::uint64_t>(name); }
  bool has(std::string_view name) const {
    return std::ranges::any_of(fields_, [&](const auto& field) { return field.first == name; });
  }

  BagOp op() const { return static_cast<BagOp>(u8("op")); }

 private:
  template <typename Value>
  Value number(std::string_view name) const {
    const std::string_view bytes = text(name);
    if (bytes.size() != sizeof(Value)) {
      throw DataError(file_,
                      "field \"" + std::string(name) + "\" of a bag record has " +
                          std::to_string(bytes.size()) + " bytes",
                      std::to_string(sizeof(Value)));
    }
    Value value;
    std::memcpy(&value, bytes.data(), sizeof(Value));
    return value;
  }

  const std::filesystem::path& file_;
  std::vector<std::pair<std::string_view, std::string_view>> fields_;
};

/// A ROS 1 bag of version 2.0, read without ROS. Opening reads the headers of the records only, so
/// its cost depends on the number of chunks, not on their size; every header is checked against the
/// file before it is used. One chunk at a time is in memory.
class BagFile : public BagReader {
 public:
  /// Throws DataError for a file that is no such bag, is cut off, encrypted or was never closed.
  explicit BagFile(const std::filesystem::path& file) : BagReader(file), in_(file) {
    const std::uint64_t file_bytes = in_.size_bytes();
    if (in_.bytes_at(0, std::min<std::uint64_t>(file_bytes, kVersionLine.size())) != kVersionLine) {
      throw DataError(file, "does not start like a ROS bag",
                      "\"#ROSBAG V2.0\" (rosbag migrate "
                      "turns older ones into it)");
    }
    const std::string head =
        in_.bytes_at(kVersionLine.size(),
                     std::min<std::uint64_t>(file_bytes - kVersionLine.size(), kMostHeaderBytes));
    ByteCursor cursor(head, path_, "the bag");
    const BagFields fields(cursor.take_counted(), path_);
    cursor.take_counted();  // its content, blanks
    if (fields.op() != BagOp::kBagHeader) {
      throw DataError(file, "its first record is no bag header", kBag);
    }
    if (fields.has("encryptor") && !fields.text("encryptor").empty()) {
      throw DataError(file, "is encrypted", "a bag that is not");
    }
    const std::uint64_t index_at_bytes = fields.u64("index_pos");
    if (index_at_bytes == 0) {
      throw DataError(file, "has no index, its recording was never closed",
                      "a closed bag (rosbag reindex makes one of it)");
    }
    walk(index_at_bytes);
    check_counts(fields.u32("conn_count"), fields.u32("chunk_count"));
  }

  std::string read(const BagMessage& message, std::size_t most_bytes = SIZE_MAX) const override {
    constexpr std::size_t kRecordStartBytes = 256;
    const BagChunk& chunk = chunks_.at(message.chunk);
    const std::size_t left_bytes = chunk.size_bytes - message.offset_bytes;
    const ChunkPart part = in_.part_of(chunk, message.offset_bytes, kRecordStartBytes);
    ByteCursor cursor(part.bytes, path_, "a message");
    const std::string_view header = cursor.take_counted();
    const BagFields fields(header, path_);
    if (fields.op() != BagOp::kMessage || fields.u32("conn") != message.connection) {
      throw DataError(path_, "an index entry leads to no message of its connection", kBag);
    }
    const auto count = cursor.take<std::uint32_t>();
    const std::size_t wanted_bytes = std::min<std::size_t>(count, most_bytes);
    if (chunk.is_packed()) return std::string(cursor.take_bytes(wanted_bytes));
    const std::size_t before_bytes = header.size() + 2 * sizeof(std::uint32_t);
    if (wanted_bytes > left_bytes - before_bytes) {
      throw DataError(path_, "a message does not end within its chunk", kBag);
    }
    return in_.bytes_at(chunk.offset_bytes + message.offset_bytes + before_bytes, wanted_bytes);
  }

 private:
  void walk(std::uint64_t index_at_bytes) {
    const std::uint64_t file_bytes = in_.size_bytes();
    if (index_at_bytes > file_bytes) {
      throw DataError(
          path_,
          fmt::format("is cut off: its index begins at byte {} of {}", index_at_bytes, file_bytes),
          kBag);
    }
    std::uint64_t at = kVersionLine.size();
    while (at < file_bytes) {
      const auto counted = [&](std::uint64_t from, const char* what) {
        if (from + sizeof(std::uint32_t) <= file_bytes) {
          const std::string size = in_.bytes_at(from, sizeof(std::uint32_t));
          const auto count = ByteCursor(size, path_, what).take<std::uint32_t>();
          if (from + sizeof(std::uint32_t) + count <= file_bytes) return count;
        }
        throw DataError(
            path_,
            fmt::format("is cut off: {} at byte {} of {} is incomplete", what, from, file_bytes),
            kBag);
      };
      const std::uint32_t header_bytes = counted(at, "the record header");
      if (header_bytes > kMostHeaderBytes) {
        throw DataError(path_, fmt::format("has a record header of {} bytes", header_bytes), kBag);
      }
      const std::string header = in_.bytes_at(at + sizeof(std::uint32_t), header_bytes);
      at += sizeof(std::uint32_t) + header_bytes;
      const std::uint32_t content_bytes = counted(at, "the record");
      at += sizeof(std::uint32_t);
      switch (BagFields(header, path_).op()) {
        case BagOp::kChunk:
          add_chunk(header, at, content_bytes);
          break;
        case BagOp::kIndex:
          add_index(header, in_.bytes_at(at, content_bytes));
          break;
        case BagOp::kConnection:
          add_connection(header, in_.bytes_at(at, content_bytes));
          break;
        case BagOp::kChunkSummary:
          add_chunk_summary(in_.bytes_at(at, content_bytes));
          break;
        case BagOp::kBagHeader:
          break;
        case BagOp::kMessage:
        default:
          throw DataError(path_, fmt::format("has an unknown record before byte {}", at), kBag);
      }
      at += content_bytes;
    }
  }

  void add_chunk(std::string_view header, std::uint64_t content_at_bytes,
                 std::uint32_t content_bytes) {
    const BagFields fields(header, path_);
    BagChunk chunk{content_at_bytes, content_bytes, fields.u32("size"),
                   std::string(fields.text("compression"))};
    if (chunk.compression != "none" && chunk.compression != "bz2" && chunk.compression != "lz4") {
      throw DataError(path_, "a chunk is compressed by \"" + chunk.compression + "\"",
                      "none, bz2 or lz4");
    }
    check_chunk_size(chunk, content_bytes, path_);
    chunks_.push_back(std::move(chunk));
  }

  void add_index(std::string_view header, std::string_view content) {
    const BagFields fields(header, path_);
    const std::uint32_t count = fields.u32("count");
    if (chunks_.empty() || fields.u32("ver") != 1 ||
        content.size() != std::uint64_t{count} * kIndexEntryBytes) {
      throw DataError(path_, "an index record does not fit its chunk", kBag);
    }
    ByteCursor cursor(content, path_, "an index record");
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint64_t seconds = cursor.take<std::uint32_t>();
      const std::uint64_t nanoseconds = cursor.take<std::uint32_t>();
      const auto offset_bytes = cursor.take<std::uint32_t>();
      if (offset_bytes >= chunks_.back().size_bytes) {
        throw DataError(path_, "an index entry points beyond its chunk", kBag);
      }
      messages_.push_back({fields.u32("conn"),
                           static_cast<std::int64_t>(seconds * 1'000'000'000U + nanoseconds),
                           chunks_.size() - 1, offset_bytes});
    }
  }

  void add_chunk_summary(std::string_view content) {
    constexpr std::size_t kEntryBytes = 8;
    ByteCursor cursor(content, path_, "a chunk summary");
    while (cursor.rest().size() >= kEntryBytes) {
      cursor.take<std::uint32_t>();  // connection
      summarised_messages_ += cursor.take<std::uint32_t>();
    }
  }

  void add_connection(std::string_view header, std::string_view content) {
    const BagFields fields(header, path_);
    const BagFields description(content, path_);
    add({fields.u32("conn"), std::string(fields.text("topic")),
         std::string(description.text("type"))});
  }

  void check_counts(std::uint32_t connections, std::uint32_t chunks) const {
    if (chunks_.size() != chunks) {
      throw DataError(path_, fmt::format("has {} chunks", chunks_.size()),
                      fmt::format("{} by its header", chunks));
    }
    if (this->connections().size() != connections) {
      throw DataError(path_, fmt::format("has {} connections", this->connections().size()),
                      fmt::format("{} by its header", connections));
    }
    if (messages_.size() != summarised_messages_) {
      throw DataError(path_, fmt::format("its index lists {} messages", messages_.size()),
                      fmt::format("{} by its summary", summarised_messages_));
    }
    for (const BagMessage& message : messages_) {
      if (find_connection(message.connection) == nullptr) {
        throw DataError(
            path_, fmt::format("connection {} of a message is missing", message.connection), kBag);
      }
    }
  }

  ChunkReader in_;
  std::vector<BagChunk> chunks_;
  std::uint64_t summarised_messages_ = 0;
};

}  // namespace

std::unique_ptr<const BagReader> open_ros1_bag(const std::filesystem::path& file) {
  return std::make_unique<BagFile>(file);
}

}  // namespace mosbench
