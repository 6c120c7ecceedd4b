#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "datasets/files/errors.hpp"

namespace mosbench {

/// Takes little-endian values off the front of a buffer. Throws DataError with `what` the buffer
/// is, in `file`, instead of reading past its end.
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

  /// Bytes behind a uint32 that counts them.
  std::string_view take_counted() { return take_bytes(take<std::uint32_t>()); }

  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  const std::filesystem::path& file_;
  std::string what_;
};

/// Puts little-endian values at the end of a buffer: the inverse of ByteCursor.
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
