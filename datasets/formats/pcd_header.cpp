#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "datasets/formats/pcd_file.hpp"
#include "datasets/formats/point_records.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr std::uint64_t kMostPoints = 1ULL << 31;
constexpr std::uint64_t kMostValues = 1ULL << 16;  // bytes of a point, numbers of a line
constexpr std::size_t kShownBytes = 40;
constexpr std::array<std::string_view, 10> kKnownLines = {
    "VERSION", "FIELDS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};

/// As CloudField numbers types; 9 and 10 are of 64 bits, of which no numbers are taken.
std::uint8_t datatype_of(std::string_view type, std::uint64_t size_bytes) {
  if (type == "F") return size_bytes == 4 ? 7 : 8;
  const std::uint8_t is_unsigned = type == "U" ? 1 : 0;
  return static_cast<std::uint8_t>((size_bytes == 1   ? 1
                                    : size_bytes == 2 ? 3
                                    : size_bytes == 4 ? 5
                                                      : 9) +
                                   is_unsigned);
}

class PcdHeaderParser {
 public:
  PcdHeaderParser(std::string_view bytes, const std::filesystem::path& file)
      : bytes_(bytes), file_(file) {}

  PcdHeader run() {
    read_lines();
    count_values();
    const std::uint64_t width = number_of("WIDTH", kMostPoints);
    const std::uint64_t height = number_of("HEIGHT", kMostPoints);
    const std::uint64_t points = number_of("POINTS", kMostPoints);
    if (width * height != points) fail("POINTS is not WIDTH * HEIGHT", "their product");
    header_.points = static_cast<std::size_t>(points);
    const auto& fields = lines_["FIELDS"];
    header_.has_labels = std::ranges::any_of(fields, is_label_field);
    header_.has_times = std::ranges::any_of(fields, is_time_field);
    if (lines_.contains("VIEWPOINT")) header_.viewpoint = viewpoint();
    header_.storage = storage();
    return header_;
  }

 private:
  [[noreturn]] void fail(const std::string& wrong, const std::string& expected) const {
    throw DataError(file_, wrong, expected);
  }

  /// Reads lines up to and with DATA, which ends the header.
  void read_lines() {
    std::size_t at = 0;
    for (std::size_t number = 1; at < bytes_.size() && !lines_.contains("DATA"); ++number) {
      const std::size_t end = std::min(bytes_.find('\n', at), bytes_.size());
      read_line(bytes_.substr(at, end - at), number);
      at = std::min(end + 1, bytes_.size());
    }
    header_.body_offset_bytes = at;
    if (!lines_.contains("DATA")) {
      fail("has no header that ends with DATA", "a PCD file, version 0.7");
    }
  }

  /// Refuses what PCL's reader takes otherwise: it ends the header at a line that it does not know,
  /// even a blank one, and takes the last of two equal ones.
  void read_line(std::string_view line, std::size_t number) {
    if (line.empty()) return;
    const auto words = split_at_blanks(line);
    if (!words.empty() && words.front().starts_with('#')) return;
    if (words.empty() || std::ranges::find(kKnownLines, words.front()) == kKnownLines.end()) {
      throw DataError(file_, number,
                      quoted(line.substr(0, kShownBytes)) + " is no line of a PCD header",
                      "a PCD file, version 0.7");
    }
    if (lines_.contains(words.front())) {
      throw DataError(file_, number, std::string(words.front()) + " is there twice", "once");
    }
    lines_[words.front()].assign(words.begin() + 1, words.end());
  }

  const std::vector<std::string_view>& words_of(std::string_view key, std::size_t count) const {
    const auto line = lines_.find(key);
    if (line == lines_.end() || line->second.size() != count) {
      fail("has no good line " + std::string(key) + " in its header",
           std::to_string(count) + " values there");
    }
    return line->second;
  }

  std::uint64_t as_number(std::string_view word, std::uint64_t largest) const {
    const auto number = parse_unsigned(word);
    if (!number || *number > largest) fail(quoted(word) + " in its header", "a whole number");
    return *number;
  }

  std::uint64_t number_of(std::string_view key, std::uint64_t largest) const {
    return as_number(words_of(key, 1).front(), largest);
  }

  /// Reads tx ty tz qw qx qy qz.
  Pose viewpoint() const {
    const auto& words = words_of("VIEWPOINT", 7);
    const std::vector<double> numbers = parse_numbers(words, [&](std::string_view word) {
      fail("VIEWPOINT " + quoted(word), "tx ty tz qw qx qy qz");
    });
    const auto pose = pose_of({numbers[0], numbers[1], numbers[2]},
                              {numbers[4], numbers[5], numbers[6], numbers[3]});
    if (!pose) fail("VIEWPOINT is no pose", "tx ty tz qw qx qy qz of length 1");
    return *pose;
  }

  void count_values() {
    const auto fields = lines_.find("FIELDS");
    if (fields == lines_.end() || fields->second.empty()) fail("names no FIELDS", "x y z");
    const std::size_t count = fields->second.size();
    const auto& sizes = words_of("SIZE", count);
    const auto& types = words_of("TYPE", count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint64_t repeats =
          lines_.contains("COUNT") ? as_number(words_of("COUNT", count)[i], kMostValues) : 1;
      const std::uint64_t size_bytes = as_number(sizes[i], 8);
      const bool is_type = types[i] == "F" ? size_bytes == 4 || size_bytes == 8
                                           : (types[i] == "I" || types[i] == "U") &&
                                                 (size_bytes == 1 || size_bytes == 2 ||
                                                  size_bytes == 4 || size_bytes == 8);
      if (!is_type || repeats == 0) {
        fail("field " + quoted(fields->second[i]) + " has no type of PCD",
             "F of 4 or 8, I or U of 1, 2, 4 or 8 bytes, COUNT from 1");
      }
      header_.fields.push_back(
          {std::string(fields->second[i]), static_cast<std::uint32_t>(header_.point_bytes),
           datatype_of(types[i], size_bytes), static_cast<std::uint32_t>(repeats)});
      header_.point_bytes += size_bytes * repeats;
      if (header_.point_bytes > kMostValues) fail("has points of too many bytes", "at most 65536");
      header_.point_values += repeats;
    }
  }

  PcdStorage storage() const {
    const std::string_view kind = words_of("DATA", 1).front();
    if (kind == "ascii") return PcdStorage::kAscii;
    if (kind == "binary") return PcdStorage::kBinary;
    if (kind == "binary_compressed") return PcdStorage::kCompressed;
    fail("DATA " + quoted(kind), "ascii, binary or binary_compressed");
  }

  std::string_view bytes_;
  const std::filesystem::path& file_;
  std::map<std::string_view, std::vector<std::string_view>> lines_;
  PcdHeader header_;
};

}  // namespace

PcdHeader parse_pcd_header(std::string_view bytes, const std::filesystem::path& file) {
  return PcdHeaderParser(bytes, file).run();
}

}  // namespace mosbench
