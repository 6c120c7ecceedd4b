#include "datasets/formats/pose_list.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "datasets/disk/files.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/formats/quaternion.hpp"
#include "datasets/formats/times_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr std::array<const char*, 3> kRowNames = {"12 numbers (row-major 3x4 matrix)",
                                                  "stamp tx ty tz qx qy qz qw, blanks between",
                                                  "tx,ty,tz,qx,qy,qz,qw"};
constexpr std::size_t kPoseNumbers = 7;

const char* row_of(PoseFormat format) { return kRowNames[static_cast<std::size_t>(format)]; }

PoseFormat format_of(std::string_view row) {
  if (row.find(',') != std::string_view::npos) return PoseFormat::kRollout;
  return split_at_blanks(row).size() == kPoseNumbers + 1 ? PoseFormat::kTum : PoseFormat::kKitti;
}

/// Position and quaternion in x y z w order.
Pose parse_seven(const std::vector<std::string_view>& words, std::size_t from, PoseFormat format,
                 const TextLine& line, const std::filesystem::path& file) {
  std::array<double, kPoseNumbers> numbers{};
  if (words.size() != from + kPoseNumbers) {
    throw DataError(file, line.number, std::to_string(words.size()) + " numbers in the row",
                    row_of(format));
  }
  for (std::size_t i = 0; i < kPoseNumbers; ++i) {
    const auto value = parse_double(words[from + i]);
    if (!value) {
      throw DataError(file, line.number, quoted(words[from + i]) + " is no finite number",
                      row_of(format));
    }
    numbers[i] = *value;
  }
  const auto pose = pose_of({numbers[0], numbers[1], numbers[2]},
                            {numbers[3], numbers[4], numbers[5], numbers[6]});
  if (!pose) {
    throw DataError(file, line.number, "the quaternion is not of length 1", row_of(format));
  }
  return *pose;
}

std::int64_t parse_stamp(const std::vector<std::string_view>& words, const PoseList& list,
                         const TextLine& line, const std::filesystem::path& file) {
  const auto stamp_ns = parse_seconds_as_ns(words.front());
  if (!stamp_ns) {
    throw DataError(file, line.number, quoted(words.front()) + " is no time in seconds",
                    row_of(list.format));
  }
  if (!list.stamps_ns.empty() && *stamp_ns <= list.stamps_ns.back()) {
    throw DataError(file, line.number, "its stamp is not behind the one before",
                    "stamps in order, each once");
  }
  return *stamp_ns;
}

}  // namespace

std::string_view to_string(PoseFormat format) {
  return kPoseFormatNames[static_cast<std::size_t>(format)];
}

std::optional<PoseFormat> pose_format_from_string(std::string_view name) {
  const auto found = std::ranges::find(kPoseFormatNames, name);
  if (found == kPoseFormatNames.end()) return std::nullopt;
  return static_cast<PoseFormat>(found - kPoseFormatNames.begin());
}

PoseList parse_pose_list(std::string_view text, std::optional<PoseFormat> format,
                         const std::filesystem::path& file) {
  PoseList list;
  bool first = true;
  for (const TextLine& line : split_lines(text, file)) {
    if (line.text.starts_with('#')) continue;
    if (first) list.format = format.value_or(format_of(line.text));
    first = false;
    if (list.format == PoseFormat::kKitti) {
      list.poses.push_back(parse_pose_row(line.text, file, line.number));
    } else if (list.format == PoseFormat::kRollout) {
      list.poses.push_back(parse_seven(split_at_commas(line.text), 0, list.format, line, file));
    } else {
      const auto words = split_at_blanks(line.text);
      list.poses.push_back(parse_seven(words, 1, list.format, line, file));
      list.stamps_ns.push_back(parse_stamp(words, list, line, file));
    }
  }
  return list;
}

PoseList read_pose_list(const std::filesystem::path& file, std::optional<PoseFormat> format) {
  return parse_pose_list(read_file(file), format, file);
}

}  // namespace mosbench
