#include "datasets/files/pcd_header.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <system_error>
#include <vector>

#include "datasets/files/errors.hpp"
#include "datasets/files/quaternion.hpp"
#include "datasets/files/text.hpp"

namespace mosbench {
namespace {

constexpr std::uint64_t kMostPoints = 1ULL << 31;
constexpr std::uint64_t kMostValues = 1ULL << 16;  // bytes of a point, numbers of a line

class PcdCheck {
 public:
  PcdCheck(std::string_view bytes, const std::filesystem::path& file)
      : bytes_(bytes), file_(file) {}

  PcdHeader run() {
    read_lines();
    count_values();
    const std::uint64_t width = number_of("WIDTH", kMostPoints);
    const std::uint64_t height = number_of("HEIGHT", kMostPoints);
    const std::uint64_t points = number_of("POINTS", kMostPoints);
    if (width * height != points) fail("POINTS is not WIDTH * HEIGHT", "as many");
    header_.points = static_cast<std::size_t>(points);
    header_.has_labels = std::ranges::find(lines_["FIELDS"], "label") != lines_["FIELDS"].end();
    if (lines_.contains("VIEWPOINT")) header_.viewpoint = viewpoint();
    check_body(words_of("DATA", 1).front());
    return header_;
  }

 private:
  [[noreturn]] void fail(const std::string& wrong, const std::string& expected) const {
    throw DataError(file_, wrong, expected);
  }

  /// Takes lines up to and with DATA, which ends the header.
  void read_lines() {
    std::size_t at = 0;
    while (at < bytes_.size()) {
      const std::size_t end = std::min(bytes_.find('\n', at), bytes_.size());
      const auto words = split_at_blanks(bytes_.substr(at, end - at));
      at = std::min(end + 1, bytes_.size());
      if (words.empty() || words.front().starts_with('#')) continue;
      lines_[words.front()].assign(words.begin() + 1, words.end());
      if (words.front() == "DATA") break;
    }
    header_.body_offset_bytes = at;
    if (!lines_.contains("DATA")) {
      fail("has no header that ends with DATA", "a PCD file, version 0.7");
    }
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

  /// tx ty tz qw qx qy qz.
  Pose viewpoint() const {
    const auto& words = words_of("VIEWPOINT", 7);
    std::array<double, 7> numbers{};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const auto number = parse_double(words[i]);
      if (!number) fail("VIEWPOINT " + quoted(words[i]), "tx ty tz qw qx qy qz");
      numbers[i] = *number;
    }
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
      point_bytes_ += size_bytes * repeats;
      point_values_ += repeats;
    }
    if (point_bytes_ > kMostValues) fail("has points of too many bytes", "at most 65536");
  }

  void check_body(std::string_view kind) const {
    const std::string_view body = bytes_.substr(header_.body_offset_bytes);
    const std::uint64_t wanted_bytes = header_.points * point_bytes_;
    if (kind == "ascii") {
      check_ascii(body);
    } else if (kind == "binary") {
      if (body.size() < wanted_bytes) fail_short(body.size(), wanted_bytes);
    } else if (kind == "binary_compressed") {
      check_compressed(body, wanted_bytes);
    } else {
      fail("DATA " + quoted(kind), "ascii, binary or binary_compressed");
    }
  }

  [[noreturn]] void fail_short(std::size_t bytes, std::uint64_t wanted_bytes) const {
    fail(std::to_string(bytes) + " bytes behind the header",
         std::to_string(wanted_bytes) + " for its " + std::to_string(header_.points) + " points");
  }

  void check_compressed(std::string_view body, std::uint64_t wanted_bytes) const {
    std::uint32_t sizes[2] = {0, 0};  // compressed, uncompressed
    if (body.size() < sizeof(sizes)) fail_short(body.size(), sizeof(sizes));
    std::memcpy(sizes, body.data(), sizeof(sizes));
    if (body.size() - sizeof(sizes) < sizes[0]) fail_short(body.size(), sizeof(sizes) + sizes[0]);
    if (sizes[1] != wanted_bytes) fail_short(sizes[1], wanted_bytes);
  }

  void check_ascii(std::string_view body) const {
    std::size_t rows = 0;
    for (const TextLine& line : split_lines(body, file_)) {
      const auto words = split_at_blanks(line.text);
      if (words.size() != point_values_) {
        fail("point " + std::to_string(rows) + " has " + std::to_string(words.size()) + " values",
             std::to_string(point_values_));
      }
      for (const std::string_view word : words) {
        double ignored = 0.0;  // nan is a number here
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), ignored);
        if (error != std::errc{} || end != word.data() + word.size()) {
          fail("point " + std::to_string(rows) + ": " + quoted(word) + " is no number", "numbers");
        }
      }
      ++rows;
    }
    if (rows != header_.points) {
      fail(std::to_string(rows) + " rows of points", std::to_string(header_.points));
    }
  }

  std::string_view bytes_;
  const std::filesystem::path& file_;
  std::map<std::string_view, std::vector<std::string_view>> lines_;
  PcdHeader header_;
  std::uint64_t point_bytes_ = 0;
  std::uint64_t point_values_ = 0;
};

}  // namespace

PcdHeader check_pcd(std::string_view bytes, const std::filesystem::path& file) {
  return PcdCheck(bytes, file).run();
}

}  // namespace mosbench
