#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

#include "datasets/formats/byte_cursor.hpp"

namespace mosbench {

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
  BagFields(std::string_view header, const std::filesystem::path& file);

  /// Each throws DataError when the field is not there or has another size.
  std::string_view text(std::string_view name) const;
  std::uint8_t u8(std::string_view name) const;
  std::uint32_t u32(std::string_view name) const;
  std::uint64_t u64(std::string_view name) const;
  /// Seconds and nanoseconds, two uint32, as nanoseconds.
  std::int64_t stamp_ns(std::string_view name) const;

  bool has(std::string_view name) const;
  BagOp op() const { return static_cast<BagOp>(u8("op")); }

 private:
  template <typename Value>
  Value number(std::string_view name) const;

  const std::filesystem::path& file_;
  std::vector<std::pair<std::string_view, std::string_view>> fields_;
};

struct BagRecord {
  BagFields fields;
  std::string_view content;
};

/// Reads a whole record; throws DataError.
BagRecord read_bag_record(ByteCursor& cursor, const std::filesystem::path& file);

}  // namespace mosbench
