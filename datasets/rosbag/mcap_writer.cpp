#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "datasets/disk/partial_file.hpp"
#include "datasets/formats/byte_cursor.hpp"
#include "datasets/rosbag/chunk_reader.hpp"
#include "datasets/rosbag/mcap_record.hpp"
#include "datasets/rosbag/ros2_bag.hpp"
#include "datasets/rosbag/ros_messages.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kChunkBytes = 1U << 20U;

std::string record(McapOp op, std::string_view content) {
  ByteSink sink;
  sink.put(static_cast<std::uint8_t>(op));
  sink.put(std::uint64_t{content.size()});
  sink.put_bytes(content);
  return std::move(sink).bytes();
}

std::uint32_t crc_of(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string packed(const std::string& compression, const std::string& bytes) {
  if (compression == "lz4") return compress_lz4(bytes);
  return compression == "zstd" ? compress_zstd(bytes) : bytes;
}

std::uint16_t channel_of(std::size_t topic) { return static_cast<std::uint16_t>(topic); }

/// Writes an MCAP file in chunks, each with an index of its messages, and a summary.
class McapWriter : public Ros2BagWriter {
 public:
  /// `compression` is "", "lz4" or "zstd".
  McapWriter(const std::filesystem::path& folder, const std::string& compression)
      : Ros2BagWriter(folder, {"mcap", message_file_of(Ros2Storage::kMcap), "", 0, 0, {}}),
        compression_(compression) {
    write_by(file(), [&] { out_ = std::make_unique<PartialFile>(file()); });
    ByteSink header;
    header.put_counted("ros2");
    header.put_counted("mosbench");
    put(kMcapMagic);
    put(record(McapOp::kHeader, std::move(header).bytes()));
  }

 private:
  void append(std::size_t topic, bool is_new, std::int64_t stamp_ns,
              std::string_view message) override {
    if (chunk_.empty()) chunk_first_ns_ = chunk_last_ns_ = stamp_ns;
    chunk_first_ns_ = std::min(chunk_first_ns_, stamp_ns);
    chunk_last_ns_ = std::max(chunk_last_ns_, stamp_ns);
    if (is_new) chunk_ += channel_records(topic);
    index_[channel_of(topic)].emplace_back(stamp_ns, chunk_.size());
    ByteSink content;
    content.put(channel_of(topic));
    content.put(static_cast<std::uint32_t>(summary().topics[topic].messages - 1));
    content.put(stamp_ns);
    content.put(stamp_ns);
    content.put_bytes(message);
    chunk_ += record(McapOp::kMessage, std::move(content).bytes());
    if (chunk_.size() >= kChunkBytes) put_chunk();
  }

  void end() override {
    put_chunk();
    put(record(McapOp::kDataEnd, std::string(sizeof(std::uint32_t), '\0')));
    std::string records;
    for (std::size_t topic = 0; topic < summary().topics.size(); ++topic) {
      records += channel_records(topic);
    }
    records += statistics() + chunk_indexes_;
    ByteSink footer;
    footer.put(written_bytes_);    // where the summary begins
    footer.put(std::uint64_t{0});  // no offsets of its groups
    const std::string start = std::move(footer).bytes();
    ByteSink head;
    head.put(static_cast<std::uint8_t>(McapOp::kFooter));
    head.put(std::uint64_t{start.size() + sizeof(std::uint32_t)});
    head.put_bytes(start);
    records += std::move(head).bytes();
    ByteSink crc;
    crc.put(crc_of(records));  // of the summary and the footer up to here
    put(records + std::move(crc).bytes() + std::string(kMcapMagic));
  }

  void put_in_place() override {
    write_by(file(), [&] {
      out_->sync();
      out_->put_in_place_of(file());
    });
  }

  void put(std::string_view bytes) {
    write_by(file(), [&] { out_->write(bytes); });
    written_bytes_ += bytes.size();
  }

  void put_chunk() {
    if (chunk_.empty()) return;
    const std::string stored = packed(compression_, chunk_);
    ByteSink content;
    content.put(chunk_first_ns_);
    content.put(chunk_last_ns_);
    content.put(std::uint64_t{chunk_.size()});
    content.put(crc_of(chunk_));
    content.put_counted(compression_);
    content.put(std::uint64_t{stored.size()});
    content.put_bytes(stored);
    const std::uint64_t at_bytes = written_bytes_;
    put(record(McapOp::kChunk, std::move(content).bytes()));
    const std::uint64_t chunk_bytes = written_bytes_ - at_bytes;
    std::map<std::uint16_t, std::uint64_t> index_at_bytes;
    for (const auto& [channel, entries] : index_) {
      index_at_bytes[channel] = written_bytes_;
      ByteSink index;
      index.put(channel);
      index.put(static_cast<std::uint32_t>(entries.size() * 2 * sizeof(std::uint64_t)));
      for (const auto& [time, offset_bytes] : entries) {
        index.put(time);
        index.put(offset_bytes);
      }
      put(record(McapOp::kMessageIndex, std::move(index).bytes()));
    }
    chunk_indexes_ += chunk_index(at_bytes, chunk_bytes, stored.size(), index_at_bytes);
    ++chunks_;
    chunk_.clear();
    index_.clear();
  }

  std::string channel_records(std::size_t topic) const {
    const TopicCount& of = summary().topics.at(topic);
    ByteSink schema;
    schema.put(static_cast<std::uint16_t>(topic + 1));  // 0 stands for none
    schema.put_counted(of.type);
    schema.put_counted("ros2msg");
    schema.put_counted(message_definition(ros1_type(of.type), MessageEncoding::kCdr));
    ByteSink channel;
    channel.put(channel_of(topic));
    channel.put(static_cast<std::uint16_t>(topic + 1));
    channel.put_counted(of.name);
    channel.put_counted("cdr");
    channel.put_counted("");
    return record(McapOp::kSchema, std::move(schema).bytes()) +
           record(McapOp::kChannel, std::move(channel).bytes());
  }

  std::string chunk_index(std::uint64_t at_bytes, std::uint64_t chunk_bytes,
                          std::uint64_t stored_bytes,
                          const std::map<std::uint16_t, std::uint64_t>& index_at_bytes) const {
    ByteSink content;
    content.put(chunk_first_ns_);
    content.put(chunk_last_ns_);
    content.put(at_bytes);
    content.put(chunk_bytes);
    content.put(static_cast<std::uint32_t>(index_at_bytes.size() *
                                           (sizeof(std::uint16_t) + sizeof(std::uint64_t))));
    for (const auto& [channel, at] : index_at_bytes) {
      content.put(channel);
      content.put(at);
    }
    content.put(written_bytes_ - at_bytes - chunk_bytes);
    content.put_counted(compression_);
    content.put(stored_bytes);
    content.put(std::uint64_t{chunk_.size()});
    return record(McapOp::kChunkIndex, std::move(content).bytes());
  }

  std::string statistics() const {
    std::uint64_t messages = 0;
    for (const TopicCount& topic : summary().topics) messages += topic.messages;
    const auto topics = summary().topics.size();
    ByteSink content;
    content.put(messages);
    content.put(static_cast<std::uint16_t>(topics));  // schemas
    content.put(static_cast<std::uint32_t>(topics));  // channels
    content.put(std::uint32_t{0});                    // attachments
    content.put(std::uint32_t{0});                    // metadata
    content.put(chunks_);
    content.put(summary().first_ns);
    content.put(summary().last_ns);
    content.put(
        static_cast<std::uint32_t>(topics * (sizeof(std::uint16_t) + sizeof(std::uint64_t))));
    for (std::size_t topic = 0; topic < topics; ++topic) {
      content.put(channel_of(topic));
      content.put(std::uint64_t{summary().topics[topic].messages});
    }
    return record(McapOp::kStatistics, std::move(content).bytes());
  }

  std::string compression_;
  std::unique_ptr<PartialFile> out_;
  std::uint64_t written_bytes_ = 0;
  std::string chunk_;  ///< records that are not yet in the file
  std::int64_t chunk_first_ns_ = 0, chunk_last_ns_ = 0;
  /// Time and place in the chunk of its messages, by channel.
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> index_;
  std::uint32_t chunks_ = 0;
  std::string chunk_indexes_;
};

}  // namespace

std::unique_ptr<Ros2BagWriter> open_mcap_writer(const std::filesystem::path& folder,
                                                const std::string& compression) {
  return std::make_unique<McapWriter>(folder, compression);
}

}  // namespace mosbench
