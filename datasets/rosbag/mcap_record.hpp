#pragma once

#include <cstdint>
#include <string_view>

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

}  // namespace mosbench
