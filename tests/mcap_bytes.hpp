#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/formats/byte_cursor.hpp"
#include "datasets/rosbag/chunk_reader.hpp"
#include "datasets/rosbag/mcap_record.hpp"

namespace mosbench {

inline std::string mcap_record(McapOp op, std::string_view content) {
  ByteSink sink;
  sink.put(static_cast<std::uint8_t>(op));
  sink.put(std::uint64_t{content.size()});
  sink.put_bytes(content);
  return std::move(sink).bytes();
}

struct McapChannel {
  std::string topic, type;  ///< "sensor_msgs/msg/PointCloud2"
  std::string encoding = "cdr";
};

struct McapEntry {
  std::uint16_t channel;
  std::int64_t recorded_ns;
  std::string message;
};

/// An MCAP file put together by hand from the specification (mcap.dev), so that tests can leave out
/// or spoil any part of it. The members that start as files have them can be changed before `str`.
struct McapBytes {
  std::vector<McapChannel> channels;
  std::vector<std::vector<McapEntry>> chunks;
  std::string compression;  ///< "", lz4 or zstd
  bool in_chunks = true;    ///< else the messages lie in the file one by one
  bool has_indexes = true;  ///< behind each chunk
  bool has_summary = true;
  bool closed = true;                    ///< with a footer and the magic at the end
  std::uint64_t offset_error_bytes = 0;  ///< added to what the indexes say
  std::uint64_t more_counted = 0;        ///< messages that the statistics claim beside those there
  std::uint32_t crc = 0;                 ///< of each chunk

  std::string str() const {
    std::string file(kMcapMagic);
    file += mcap_record(McapOp::kHeader, text("ros2") + text("by hand"));
    std::uint64_t messages = 0;
    bool is_first = true;
    for (const auto& entries : chunks) {
      messages += entries.size();
      const std::string head = is_first ? channel_records() : "";
      is_first = false;
      file += in_chunks ? chunk(entries, head) : head + loose(entries);
    }
    file += mcap_record(McapOp::kDataEnd, std::string(4, '\0'));
    const std::uint64_t summary_at = file.size();
    if (has_summary) {
      ByteSink statistics;
      statistics.put(messages + more_counted);
      statistics.put_bytes(std::string(2 + 4 * 4 + 8 * 2 + 4, '\0'));
      file += channel_records() + mcap_record(McapOp::kStatistics, std::move(statistics).bytes());
    }
    if (!closed) return file;
    ByteSink footer;
    footer.put(has_summary ? summary_at : std::uint64_t{0});
    footer.put(std::uint64_t{0});
    footer.put(std::uint32_t{0});
    return file + mcap_record(McapOp::kFooter, std::move(footer).bytes()) + std::string(kMcapMagic);
  }

 private:
  static std::string text(std::string_view bytes) {
    ByteSink sink;
    sink.put_counted(bytes);
    return std::move(sink).bytes();
  }

  std::string channel_records() const {
    std::string records;
    for (std::size_t i = 0; i < channels.size(); ++i) {
      ByteSink schema, channel;
      schema.put(static_cast<std::uint16_t>(i + 1));
      schema.put_bytes(text(channels[i].type) + text("ros2msg") + text(""));
      channel.put(static_cast<std::uint16_t>(i));
      channel.put(static_cast<std::uint16_t>(i + 1));
      channel.put_bytes(text(channels[i].topic) + text(channels[i].encoding) + text(""));
      records += mcap_record(McapOp::kSchema, std::move(schema).bytes()) +
                 mcap_record(McapOp::kChannel, std::move(channel).bytes());
    }
    return records;
  }

  static std::string message(const McapEntry& entry) {
    ByteSink sink;
    sink.put(entry.channel);
    sink.put(std::uint32_t{0});
    sink.put(entry.recorded_ns);
    sink.put(entry.recorded_ns);
    sink.put_bytes(entry.message);
    return mcap_record(McapOp::kMessage, std::move(sink).bytes());
  }

  static std::string loose(const std::vector<McapEntry>& entries) {
    std::string records;
    for (const McapEntry& entry : entries) records += message(entry);
    return records;
  }

  std::string chunk(const std::vector<McapEntry>& entries, const std::string& head) const {
    std::string content = head, indexes;
    for (const McapEntry& entry : entries) {
      ByteSink index;
      index.put(entry.channel);
      index.put(std::uint32_t{16});
      index.put(entry.recorded_ns);
      index.put(content.size() + offset_error_bytes);
      indexes += mcap_record(McapOp::kMessageIndex, std::move(index).bytes());
      content += message(entry);
    }
    const std::string stored = compression == "lz4"    ? compress_lz4(content)
                               : compression == "zstd" ? compress_zstd(content)
                                                       : content;
    ByteSink chunk;
    chunk.put_bytes(std::string(16, '\0'));
    chunk.put(std::uint64_t{content.size()});
    chunk.put(crc);
    chunk.put_counted(compression);
    chunk.put(std::uint64_t{stored.size()});
    chunk.put_bytes(stored);
    return mcap_record(McapOp::kChunk, std::move(chunk).bytes()) + (has_indexes ? indexes : "");
  }
};

}  // namespace mosbench
