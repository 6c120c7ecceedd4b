#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "datasets/text/errors.hpp"

namespace mosbench {

/// Reads little-endian values one after the other from a buffer. Instead of reading past its end it
/// throws DataError that says `what` in `file` ends early.
class ByteCursor {
 public:
  ByteCursor(std::string_view bytes, const std::filesystem::path& file, std::string what)
      : rest_(bytes), file_(file), what_(std::move(what)) {}

  template <typename Value>
  Value take() {
    static_assert(std::endian::native == std::endian::little, "values are copied as stored");
    Value value;
    std::memcpy(&value, take_bytes(sizeof(Value)).data(), sizeof(Value));
    return value;
  }

  std::string_view take_bytes(std::size_t count) {
    if (count > rest_.size()) {
      throw DataError(file_, what_ + " ends early",
                      std::to_string(count - rest_.size()) + " bytes more");
    }
    const std::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return taken;
  }

  /// Reads a uint32 and as many bytes.
  std::string_view take_counted() { return take_bytes(take<std::uint32_t>()); }

  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  const std::filesystem::path& file_;
  std::string what_;
};

/// Appends little-endian values to a buffer: the inverse of ByteCursor.
class ByteSink {
 public:
  template <typename Value>
  void put(Value value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(Value));
  }
  void put_bytes(std::string_view bytes) { bytes_ += bytes; }
  void put_counted(std::string_view bytes) {
    put(static_cast<std::uint32_t>(bytes.size()));
    bytes_ += bytes;
  }
  std::string bytes() && { return std::move(bytes_); }

 private:
  std::string bytes_;
};

}  // namespace mosbench
