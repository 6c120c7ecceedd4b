#include "datasets/rosbag/bag_record.hpp"

#include <string>

namespace mosbench {

BagFields::BagFields(std::string_view header, const std::filesystem::path& file) : file_(file) {
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

bool BagFields::has(std::string_view name) const {
  for (const auto& [key, unused] : fields_) {
    if (key == name) return true;
  }
  return false;
}

std::string_view BagFields::text(std::string_view name) const {
  for (const auto& [key, value] : fields_) {
    if (key == name) return value;
  }
  throw DataError(file_, "a bag record has no field \"" + std::string(name) + "\"",
                  "a ROS bag of version 2.0");
}

template <typename Value>
Value BagFields::number(std::string_view name) const {
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

std::uint8_t BagFields::u8(std::string_view name) const { return number<std::uint8_t>(name); }
std::uint32_t BagFields::u32(std::string_view name) const { return number<std::uint32_t>(name); }
std::uint64_t BagFields::u64(std::string_view name) const { return number<std::uint64_t>(name); }

std::int64_t BagFields::stamp_ns(std::string_view name) const {
  const std::uint64_t halves = u64(name);
  const std::uint64_t seconds = halves & 0xFFFFFFFFU;
  return static_cast<std::int64_t>(seconds * 1'000'000'000U + (halves >> 32U));
}

BagRecord read_bag_record(ByteCursor& cursor, const std::filesystem::path& file) {
  const BagFields fields(cursor.take_counted(), file);
  return {fields, cursor.take_counted()};
}

}  // namespace mosbench
