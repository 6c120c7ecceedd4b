#include "datasets/rosbag/bag_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/disk/files.hpp"
#include "datasets/rosbag/bag_record.hpp"
#include "datasets/rosbag/chunk_reader.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr std::string_view kVersionLine = "#ROSBAG V2.0\n";
constexpr std::uint32_t kMostHeaderBytes = 1U << 20U;
constexpr std::uint32_t kIndexEntryBytes = 12;
constexpr const char* kBag = "a closed ROS bag of version 2.0";

}  // namespace

BagFile::BagFile(const std::filesystem::path& file) : BagReader(file), in_(file) {
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
  const BagRecord record = read_bag_record(cursor, path_);
  if (record.fields.op() != BagOp::kBagHeader) {
    throw DataError(file, "its first record is no bag header", kBag);
  }
  if (record.fields.has("encryptor") && !record.fields.text("encryptor").empty()) {
    throw DataError(file, "is encrypted", "a bag that is not");
  }
  const std::uint64_t index_at_bytes = record.fields.u64("index_pos");
  if (index_at_bytes == 0) {
    throw DataError(file, "has no index, its recording was never closed",
                    "a closed bag (rosbag reindex makes one of it)");
  }
  walk(index_at_bytes);
  check_counts(record.fields.u32("conn_count"), record.fields.u32("chunk_count"));
}

void BagFile::walk(std::uint64_t index_at_bytes) {
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

void BagFile::add_chunk(std::string_view header, std::uint64_t content_at_bytes,
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

void BagFile::add_index(std::string_view header, std::string_view content) {
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

void BagFile::add_chunk_summary(std::string_view content) {
  constexpr std::size_t kEntryBytes = 8;
  ByteCursor cursor(content, path_, "a chunk summary");
  while (cursor.rest().size() >= kEntryBytes) {
    cursor.take<std::uint32_t>();  // connection
    summarised_messages_ += cursor.take<std::uint32_t>();
  }
}

void BagFile::add_connection(std::string_view header, std::string_view content) {
  const BagFields fields(header, path_);
  const BagFields description(content, path_);
  connections_.push_back({fields.u32("conn"), std::string(fields.text("topic")),
                          std::string(description.text("type"))});
}

void BagFile::check_counts(std::uint32_t connections, std::uint32_t chunks) const {
  if (chunks_.size() != chunks) {
    throw DataError(path_, fmt::format("has {} chunks", chunks_.size()),
                    fmt::format("{} by its header", chunks));
  }
  if (connections_.size() != connections) {
    throw DataError(path_, fmt::format("has {} connections", connections_.size()),
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

std::vector<BagMessage> BagFile::messages(std::string_view topic) const {
  return of_topic(messages_, topic);
}

std::string BagFile::read(const BagMessage& message, std::size_t most_bytes) const {
  constexpr std::size_t kRecordStartBytes = 256;
  const BagChunk& chunk = chunks_.at(message.chunk);
  const std::size_t left_bytes = chunk.size_bytes - message.offset_bytes;
  const std::uint64_t at_bytes = chunk.offset_bytes + message.offset_bytes;
  const bool packed = chunk.is_packed();
  std::shared_ptr<const std::string> content;
  std::string start;
  if (packed) {
    content = in_.content_of(chunk);
  } else {
    start = in_.bytes_at(at_bytes, std::min<std::uint64_t>(left_bytes, kRecordStartBytes));
  }
  ByteCursor cursor(packed ? std::string_view(*content).substr(message.offset_bytes) : start, path_,
                    "a message");
  const std::string_view header = cursor.take_counted();
  const BagFields fields(header, path_);
  if (fields.op() != BagOp::kMessage || fields.u32("conn") != message.connection) {
    throw DataError(path_, "an index entry leads to no message of its connection", kBag);
  }
  const auto count = cursor.take<std::uint32_t>();
  const std::size_t wanted_bytes = std::min<std::size_t>(count, most_bytes);
  if (packed) return std::string(cursor.take_bytes(wanted_bytes));
  const std::size_t before_bytes = header.size() + 2 * sizeof(std::uint32_t);
  if (wanted_bytes > left_bytes - before_bytes) {
    throw DataError(path_, "a message does not end within its chunk", kBag);
  }
  return in_.bytes_at(at_bytes + before_bytes, wanted_bytes);
}

}  // namespace mosbench
