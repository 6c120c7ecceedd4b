#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/formats/byte_cursor.hpp"
#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/rosbag/chunk_reader.hpp"

namespace mosbench {

/// First and last bytes of an MCAP file (mcap.dev, version 0).
inline constexpr std::string_view kMcapMagic{"\x89MCAP0\r\n", 8};

/// The records that are read or written. Each is a byte of these, the uint64 length of its content,
/// and the content.
enum class McapOp : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F
};

inline constexpr std::uint64_t kMcapRecordHeadBytes = 9;

/// A ROS 2 bag in one MCAP file (mcap.dev). Opening walks over the heads of its records, and reads
/// the content of chunks only if no index follows them. A file that its recorder did not close is
/// read up to the last whole record; a remark says so.
class McapFile : public BagReader {
 public:
  /// Throws DataError for a file that is no MCAP, is damaged, or has a chunk that is compressed
  /// otherwise than by lz4 or zstd.
  explicit McapFile(const std::filesystem::path& file);

  std::vector<BagMessage> messages(std::string_view topic) const override;
  std::string read(const BagMessage& message, std::size_t most_bytes = SIZE_MAX) const override;

 private:
  struct IndexedChunk {
    BagChunk chunk;
    bool has_index = false;
  };
  /// `chunk` of a message that is in none.
  static constexpr std::size_t kNoChunk = SIZE_MAX;

  void walk();
  void forget_last_index();
  void take_record(McapOp op, std::uint64_t at_bytes, std::uint64_t count);
  void add_chunk(std::uint64_t at_bytes, std::uint64_t count);
  void add_index(std::string_view content);
  void add_schema(std::string_view content);
  void add_channel(std::string_view content);
  void add_message(std::string_view head, std::size_t chunk, std::uint64_t offset_bytes);
  void add_statistics(std::string_view content);
  void scan_chunks();
  void scan_chunk(std::size_t chunk, bool takes_messages);
  void check_channels() const;

  ChunkReader in_;
  std::map<std::uint16_t, std::string> type_of_schema_;
  std::vector<IndexedChunk> chunks_;
  std::vector<BagMessage> messages_;
  std::uint64_t counted_messages_ = 0;  ///< by the statistics
  bool has_statistics_ = false;
};

}  // namespace mosbench
