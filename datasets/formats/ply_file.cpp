#include "datasets/formats/ply_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <string>

#include "datasets/formats/label_file.hpp"
#include "datasets/formats/point_records.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr std::uint64_t kMostVertices = 1ULL << 31U;
constexpr std::size_t kMostProperties = 1000;

struct PlyType {
  std::string_view name;
  std::uint8_t datatype;  ///< of CloudField
  std::uint32_t size_bytes;
};

constexpr std::array<PlyType, 16> kTypes = {{{"char", 1, 1},
                                             {"int8", 1, 1},
                                             {"uchar", 2, 1},
                                             {"uint8", 2, 1},
                                             {"short", 3, 2},
                                             {"int16", 3, 2},
                                             {"ushort", 4, 2},
                                             {"uint16", 4, 2},
                                             {"int", 5, 4},
                                             {"int32", 5, 4},
                                             {"uint", 6, 4},
                                             {"uint32", 6, 4},
                                             {"float", 7, 4},
                                             {"float32", 7, 4},
                                             {"double", 8, 8},
                                             {"float64", 8, 8}}};

/// Describes the vertices as records of fields.
struct PlyHead {
  CloudHead vertices;
  bool ascii = false;
};

class PlyHeadParser {
 public:
  PlyHeadParser(std::string_view bytes, std::uintmax_t file_bytes,
                const std::filesystem::path& file)
      : bytes_(bytes), file_bytes_(file_bytes), file_(file) {}

  PlyHead run() {
    if (next_line() != "ply") fail("does not start with \"ply\"", "a PLY file");
    while (true) {
      const std::string_view line = next_line();
      if (line == "end_header") break;
      parse_line(split_at_blanks(line), line);
    }
    if (!has_format_ || !has_vertices_) {
      fail("its header lacks a format or the element vertex", "both");
    }
    CloudHead& head = head_.vertices;
    head.height = 1;
    head.records_at_bytes = at_;
    if (!head_.ascii &&
        (std::max<std::uintmax_t>(file_bytes_, at_) - at_) / std::max(1U, head.point_step_bytes) <
            head.width) {
      fail("ends within its points",
           std::to_string(head.width) + " of " + std::to_string(head.point_step_bytes) + " bytes");
    }
    return head_;
  }

 private:
  [[noreturn]] void fail(const std::string& wrong, const std::string& expected) const {
    throw DataError(file_, wrong, expected);
  }

  std::string_view next_line() {
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos) fail("has no line \"end_header\"", "a PLY file");
    const std::string_view line = trim(bytes_.substr(at_, end - at_));
    at_ = end + 1;
    return line;
  }

  void parse_line(const std::vector<std::string_view>& words, std::string_view line) {
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") return;
    if (words[0] == "format" && words.size() == 3) {
      parse_format(words[1]);
    } else if (words[0] == "element" && words.size() == 3) {
      parse_element(words[1], words[2]);
    } else if (words[0] == "property" && words.size() >= 3) {
      if (in_vertices_) parse_property(words);
    } else {
      fail("header line " + quoted(line), "format, element, property or comment");
    }
  }

  void parse_format(std::string_view format) {
    if (format != "ascii" && format != "binary_little_endian" && format != "binary_big_endian") {
      fail("format " + quoted(format), "ascii, binary_little_endian or binary_big_endian");
    }
    head_.ascii = format == "ascii";
    head_.vertices.big_endian = format == "binary_big_endian";
    has_format_ = true;
  }

  void parse_element(std::string_view name, std::string_view count) {
    const auto number = parse_unsigned(count);
    if (!number || *number >= kMostVertices) fail(quoted(count) + " elements", "a whole number");
    in_vertices_ = name == "vertex";
    if (in_vertices_ && (has_vertices_ || other_elements_)) {
      fail("its element vertex is not the first", "vertices first, once");
    }
    if (in_vertices_) head_.vertices.width = static_cast<std::uint32_t>(*number);
    has_vertices_ = has_vertices_ || in_vertices_;
    other_elements_ = other_elements_ || !in_vertices_;
  }

  void parse_property(const std::vector<std::string_view>& words) {
    CloudHead& head = head_.vertices;
    const auto type = std::ranges::find(kTypes, words[1], &PlyType::name);
    if (type == kTypes.end() || words.size() != 3 || head.fields.size() == kMostProperties) {
      fail("property " + quoted(words.back()) + " of vertex is no single number",
           "a type of PLY other than list");
    }
    head.fields.push_back({std::string(words[2]), head.point_step_bytes, type->datatype, 1});
    head.point_step_bytes += type->size_bytes;
  }

  std::string_view bytes_;
  std::uintmax_t file_bytes_;
  const std::filesystem::path& file_;
  PlyHead head_;
  std::size_t at_ = 0;
  bool has_format_ = false, has_vertices_ = false, in_vertices_ = false, other_elements_ = false;
};

using Row = std::vector<std::string_view>;

/// Calls `visit(point, row)` for the row of each point of an ascii body.
template <typename Visit>
void for_each_row(const CloudHead& head, std::string_view body, const std::filesystem::path& file,
                  Visit&& visit) {
  std::size_t at = 0;
  for (std::size_t point = 0; point < head.width; ++point) {
    if (at >= body.size()) {
      throw DataError(file, std::to_string(point) + " rows of points", std::to_string(head.width));
    }
    const std::size_t end = std::min(body.find('\n', at), body.size());
    visit(point, split_at_blanks(body.substr(at, end - at)));
    at = end + 1;
  }
}

template <typename Number>
Number number_in(const Row& row, std::size_t column, std::size_t point, const CloudHead& head,
                 const std::filesystem::path& file) {
  Number value{};
  const std::string_view word = column < row.size() ? row[column] : "";
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || stop != word.data() + word.size() ||
      row.size() != head.fields.size()) {
    throw DataError(file, "point " + std::to_string(point) + " is no row of numbers",
                    std::to_string(head.fields.size()) + " of them");
  }
  return value;
}

/// Returns the columns of x, y, z and intensity in a row; one past the last when there is none.
std::array<std::size_t, 4> columns_of(const CloudHead& head, const std::filesystem::path& file) {
  std::array<std::size_t, 4> columns{};
  constexpr std::array<std::string_view, 4> kNames = {"x", "y", "z", "intensity"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const auto field = std::ranges::find(head.fields, kNames[i], &CloudField::name);
    columns[i] = static_cast<std::size_t>(field - head.fields.begin());
    if (field == head.fields.end() && kNames[i] != "intensity") {
      throw DataError(file, "the points have no field " + std::string(kNames[i]),
                      "fields x y z [intensity]");
    }
  }
  return columns;
}

std::vector<Point> parse_ascii(const CloudHead& head, std::string_view body,
                               const std::filesystem::path& file) {
  const auto columns = columns_of(head, file);
  std::vector<Point> points;
  for_each_row(head, body, file, [&](std::size_t point, const Row& row) {
    std::array<float, 4> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (columns[i] == head.fields.size()) continue;
      values[i] = number_in<float>(row, columns[i], point, head, file);
    }
    points.push_back({values[0], values[1], values[2], values[3]});
  });
  return points;
}

/// Returns the numbers of the field that `find` finds, one per point.
std::vector<double> numbers_in(std::string_view bytes, const CloudField* (*find)(const CloudHead&),
                               const std::string& what, const char* fields,
                               const std::filesystem::path& file) {
  const PlyHead ply = PlyHeadParser(bytes, bytes.size(), file).run();
  const CloudHead& head = ply.vertices;
  const CloudField* field = find(head);
  if (field == nullptr) throw DataError(file, "the points have no " + what, fields);
  if (head.width == 0) return {};
  if (!ply.ascii) return numbers_of(head, *field, bytes, file);
  const auto column = static_cast<std::size_t>(field - head.fields.data());
  std::vector<double> numbers;
  for_each_row(head, bytes.substr(head.records_at_bytes), file,
               [&](std::size_t point, const Row& row) {
                 numbers.push_back(number_in<double>(row, column, point, head, file));
               });
  return numbers;
}

}  // namespace

std::vector<Point> parse_ply(std::string_view bytes, const std::filesystem::path& file) {
  const PlyHead head = PlyHeadParser(bytes, bytes.size(), file).run();
  if (head.ascii) {
    return parse_ascii(head.vertices, bytes.substr(head.vertices.records_at_bytes), file);
  }
  if (head.vertices.width == 0) return {};
  return points_of(head.vertices, bytes, file);
}

std::vector<double> parse_ply_times(std::string_view bytes, const std::filesystem::path& file) {
  return numbers_in(bytes, find_time_field, "times", kTimeFields, file);
}

std::vector<std::uint32_t> parse_ply_labels(std::string_view bytes,
                                            const std::filesystem::path& file) {
  return label_ids(numbers_in(bytes, find_label_field, "labels", kLabelFields, file), file);
}

PlySummary parse_ply_summary(std::string_view head, std::uintmax_t file_bytes,
                             const std::filesystem::path& file) {
  const CloudHead vertices = PlyHeadParser(head, file_bytes, file).run().vertices;
  return {vertices.points(), find_label_field(vertices) != nullptr,
          find_time_field(vertices) != nullptr};
}

}  // namespace mosbench
