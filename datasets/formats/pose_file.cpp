#include "datasets/formats/pose_file.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>

#include "datasets/disk/files.hpp"
#include "datasets/formats/times_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr int kRows = 3;
constexpr int kColumns = 4;
constexpr std::size_t kNumbers = 12;

Eigen::Array33d deviation_of(const Eigen::Matrix3d& matrix) {
  return (matrix.transpose() * matrix - Eigen::Matrix3d::Identity()).cwiseAbs();
}

/// Element by element, so that an overflow to NaN is refused as well.
bool is_orthonormal(const Eigen::Matrix3d& matrix) {
  return (deviation_of(matrix) <= kRotationTolerance).all();
}

void check_rotation(const Eigen::Matrix3d& rotation, const std::filesystem::path& file,
                    std::size_t line) {
  if (!is_orthonormal(rotation)) {
    throw DataError(file, line,
                    fmt::format("rotation is not orthonormal, R^T R differs from the identity by "
                                "{:.3g}",
                                deviation_of(rotation).maxCoeff()),
                    fmt::format("at most {} (12 numbers, row-major 3x4)", kRotationTolerance));
  }
  if (rotation.determinant() < 0.0) {
    throw DataError(file, line, "rotation mirrors, its determinant is -1", "determinant +1");
  }
}

/// Returns whether these are 0 0 0 1: a 4x4 matrix was written.
bool is_last_row(std::span<const std::string_view, kColumns> words) {
  for (int column = 0; column < kColumns; ++column) {
    const auto number = parse_double(words[static_cast<std::size_t>(column)]);
    if (number != (column + 1 == kColumns ? 1.0 : 0.0)) return false;
  }
  return true;
}

constexpr std::string_view kKey = "Tr:";

constexpr std::array<const char*, 3> kRowNames = {"12 numbers (row-major 3x4 matrix)",
                                                  "stamp tx ty tz qx qy qz qw, blanks between",
                                                  "tx,ty,tz,qx,qy,qz,qw"};
constexpr std::size_t kPoseNumbers = 7;

const char* row_of(PoseFormat format) { return kRowNames[static_cast<std::size_t>(format)]; }

/// Of a row with blanks between its numbers; `stored` is the row of the file.
PoseFormat format_of(std::string_view row, std::string_view stored) {
  const std::size_t numbers = split_at_blanks(row).size();
  if (numbers == kPoseNumbers + 1) return PoseFormat::kTum;
  const bool by_commas = stored.find(',') != stored.npos;
  return by_commas && numbers <= kPoseNumbers ? PoseFormat::kRollout : PoseFormat::kKitti;
}

/// What separates the numbers of a row; a comma within words is a decimal comma.
char separator_of(std::string_view row) {
  if (row.find(';') != row.npos) return ';';
  const auto words = split_at_blanks(row);
  return words.size() >= kPoseNumbers && !words.front().ends_with(',') ? ' ' : ',';
}

/// Refuses names of columns in another order: numbers would be read for others without an error.
void check_names(const TextLine& line, const std::filesystem::path& file) {
  const std::string names = lower_case(std::string(line.text));
  const std::size_t x = names.find("qx"), w = names.find("qw");
  if (x == names.npos || w == names.npos || x < w) return;
  throw DataError(file, line.number, "its columns have quaternions as w x y z", "x y z w");
}

/// Returns the text with blanks between numbers, and a row of names as a comment. Places stay.
std::string with_blanks(std::string_view text, const std::filesystem::path& file) {
  std::string plain(text);
  for (const TextLine& line : split_lines(plain, file)) {
    check_names(line, file);
    if (line.text.starts_with('#')) continue;
    std::ranges::replace(plain, separator_of(line.text), ' ');
    const auto words = split_at_blanks(line.text);
    constexpr std::string_view kStartOfNumbers = "+-.0123456789";
    const auto may_be_number = [&](std::string_view word) {
      return kStartOfNumbers.find(word.front()) != kStartOfNumbers.npos;
    };
    if (words.size() < kPoseNumbers || std::ranges::any_of(words, may_be_number)) break;
    plain[static_cast<std::size_t>(line.text.data() - plain.data())] = '#';
    break;
  }
  return plain;
}

std::string no_number(std::string_view word) {
  const bool has_comma = word.find(',') != word.npos;
  return quoted(word) + " is no finite number" + (has_comma ? " (is that a decimal comma?)" : "");
}

/// Returns whether a row says that its pose is not known.
bool is_unknown(const std::vector<std::string_view>& words) {
  return std::ranges::any_of(
      words, [](std::string_view word) { return lower_case(std::string(word)) == "nan"; });
}

/// Position and quaternion in x y z w order.
Pose parse_seven(const std::vector<std::string_view>& words, std::size_t from, PoseFormat format,
                 const TextLine& line, const std::filesystem::path& file) {
  if (words.size() != from + kPoseNumbers) {
    throw DataError(file, line.number, std::to_string(words.size()) + " numbers in the row",
                    row_of(format));
  }
  const std::vector<double> numbers =
      parse_numbers(std::span(words).subspan(from), [&](std::string_view word) {
        throw DataError(file, line.number, no_number(word), row_of(format));
      });
  const auto pose = pose_of({numbers[0], numbers[1], numbers[2]},
                            {numbers[3], numbers[4], numbers[5], numbers[6]});
  if (!pose) {
    throw DataError(file, line.number, "the quaternion is not of length 1", row_of(format));
  }
  return *pose;
}

/// Decimals of a stamp as it is printed: 4 of "1.2345"; many of one with an exponent.
std::size_t decimals_of(std::string_view stamp) {
  const std::size_t point = stamp.find('.');
  if (stamp.find_first_of("eE") != stamp.npos) return 9;
  return point == stamp.npos ? 0 : stamp.size() - point - 1;
}

/// Half a unit of the last decimal; not of stamps to the hundredth, which say less of a scan.
std::int64_t rounding_of(std::size_t decimals) {
  constexpr std::int64_t kLeast_ns = 1'000, kMost_ns = 500'000;
  std::int64_t half_unit_ns = 500'000'000;
  for (std::size_t i = 0; i < decimals; ++i) half_unit_ns /= 10;
  return half_unit_ns > kMost_ns ? kLeast_ns : std::max(half_unit_ns, kLeast_ns);
}

std::int64_t parse_stamp(const std::vector<std::string_view>& words, TimeUnit unit,
                         const PoseList& list, const TextLine& line,
                         const std::filesystem::path& file) {
  const auto stamp_ns = parse_seconds_as_ns(words.front(), 3 * static_cast<int>(unit));
  if (!stamp_ns) {
    const bool is_number = parse_double(words.front()).has_value();
    throw DataError(file, line.number,
                    quoted(words.front()) + " is no time in seconds" +
                        (is_number ? " (is it in nanoseconds?)" : ""),
                    row_of(list.format));
  }
  if (!list.stamps_ns.empty() && *stamp_ns < list.stamps_ns.back()) {
    throw DataError(file, line.number, "its stamp is before that of the row before",
                    "stamps in order");
  }
  return *stamp_ns;
}

/// Takes a row of kTum with a pose; of those with the same stamp the first.
void add_stamped(const std::vector<std::string_view>& words, TimeUnit unit, const TextLine& line,
                 PoseList& list, const std::filesystem::path& file) {
  if (is_unknown(words)) {
    ++list.unknown;
    return;
  }
  const Pose pose = parse_seven(words, 1, list.format, line, file);
  const std::int64_t stamp_ns = parse_stamp(words, unit, list, line, file);
  if (!list.stamps_ns.empty() && stamp_ns == list.stamps_ns.back()) {
    ++list.repeated;
    return;
  }
  list.poses.push_back(pose);
  list.stamps_ns.push_back(stamp_ns);
}

/// Checks the last pose, which stands in `line`.
void check_near_first(const std::vector<Pose>& poses, const TextLine& line,
                      const std::filesystem::path& file) {
  if (poses.empty()) return;
  const double far_m = distance_m(poses.front(), poses.back());
  if (far_m <= kFarthestPose_m) return;
  throw DataError(file, line.number, fmt::format("is {:g} m from the first pose", far_m),
                  fmt::format("at most {:g} m", kFarthestPose_m));
}

}  // namespace

bool is_rotation(const Eigen::Matrix3d& matrix) {
  return is_orthonormal(matrix) && matrix.determinant() > 0.0;
}

Pose parse_pose_row(std::string_view row, const std::filesystem::path& file, std::size_t line) {
  auto numbers = split_at_blanks(row);
  if (numbers.size() == kNumbers + kColumns && is_last_row(std::span(numbers).last<kColumns>())) {
    numbers.resize(kNumbers);
  }
  if (numbers.size() != kNumbers) {
    throw DataError(file, line, fmt::format("{} numbers in the row", numbers.size()),
                    "12 (row-major 3x4 matrix)");
  }
  const std::vector<double> values = parse_numbers(numbers, [&](std::string_view number) {
    throw DataError(file, line, no_number(number), "12 numbers separated by blanks");
  });
  Pose pose = Pose::Identity();
  pose.matrix().topRows<kRows>() =
      Eigen::Map<const Eigen::Matrix<double, kRows, kColumns, Eigen::RowMajor>>(values.data());
  check_rotation(pose.linear(), file, line);
  return pose;
}

std::string format_pose_row(const Pose& pose) {
  std::string row;
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      if (!row.empty()) row += ' ';
      row += fmt::format("{}", pose.matrix()(r, c));
    }
  }
  return row;
}

double distance_m(const Pose& from, const Pose& to) {
  return (to.translation() - from.translation()).stableNorm();
}

std::vector<Pose> parse_poses(std::string_view text, const std::filesystem::path& file) {
  std::vector<Pose> poses;
  for (const TextLine& line : split_lines(text, file)) {
    poses.push_back(parse_pose_row(line.text, file, line.number));
    check_near_first(poses, line, file);
  }
  return poses;
}

std::string format_poses(std::span<const Pose> poses) {
  std::string text;
  for (const Pose& pose : poses) text += format_pose_row(pose) + '\n';
  return text;
}

std::vector<Pose> read_poses(const std::filesystem::path& file) {
  return parse_poses(read_file(file), file);
}

void write_poses(const std::filesystem::path& file, std::span<const Pose> poses) {
  write_file_atomic(file, format_poses(poses));
}

Pose parse_calib(std::string_view text, const std::filesystem::path& file) {
  std::optional<Pose> camera_from_lidar;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = take_line(text);
    if (!line.starts_with(kKey)) continue;
    if (camera_from_lidar) throw DataError(file, number, "a second line \"Tr:\"", "one");
    camera_from_lidar = parse_pose_row(line.substr(kKey.size()), file, number);
  }
  if (!camera_from_lidar) {
    throw DataError(file, "has no line \"Tr:\"",
                    "\"Tr:\" and the 12 numbers of camera_from_lidar (identity when the poses are "
                    "those of the lidar)");
  }
  return *camera_from_lidar;
}

std::string format_calib(const Pose& camera_from_lidar) {
  std::string text;
  for (const char* camera : {"P0: ", "P1: ", "P2: ", "P3: "}) {
    text += camera + format_pose_row(Pose::Identity()) + '\n';
  }
  return text + "Tr: " + format_pose_row(camera_from_lidar) + '\n';
}

bool is_identity(const Pose& pose) { return pose.matrix() == Pose::Identity().matrix(); }

Pose lidar_pose(const Pose& pose, const Pose& camera_from_lidar) {
  if (is_identity(camera_from_lidar)) return pose;
  // The general inverse: published Tr have rounded rotations, whose transpose is not their inverse.
  return Pose(camera_from_lidar.inverse(Eigen::Affine) * pose * camera_from_lidar);
}

Pose read_calib(const std::filesystem::path& file) { return parse_calib(read_file(file), file); }

std::string_view to_string(PoseFormat format) {
  return kPoseFormatNames[static_cast<std::size_t>(format)];
}

std::optional<PoseFormat> pose_format_from_string(std::string_view name) {
  const auto found = std::ranges::find(kPoseFormatNames, name);
  if (found == kPoseFormatNames.end()) return std::nullopt;
  return static_cast<PoseFormat>(found - kPoseFormatNames.begin());
}

std::vector<std::string> PoseList::remarks(const std::filesystem::path& file) const {
  std::vector<std::string> said;
  const auto say = [&](std::size_t rows, std::string_view what) {
    if (rows == 0) return;
    said.push_back(fmt::format("{}: {} {} and {} left out", file.filename().string(),
                               rows == 1 ? "1 row has" : fmt::format("{} rows have", rows), what,
                               rows == 1 ? "is" : "are"));
  };
  say(repeated, "the stamp of the row before");
  say(unknown, "numbers that are NaN");
  return said;
}

PoseList parse_pose_list(std::string_view text, std::optional<PoseFormat> format,
                         const std::filesystem::path& file) {
  PoseList list;
  bool first = true;
  std::size_t decimals = 0;
  TimeUnit unit = TimeUnit::kSeconds;
  const std::string plain = with_blanks(text, file);
  for (const TextLine& line : split_lines(plain, file)) {
    if (line.text.starts_with('#')) continue;
    if (first) {
      const auto at = static_cast<std::size_t>(line.text.data() - plain.data());
      list.format = format.value_or(format_of(line.text, text.substr(at, line.text.size())));
      if (list.format == PoseFormat::kTum) unit = unit_of_rows(plain, file);
    }
    first = false;
    if (list.format == PoseFormat::kKitti) {
      list.poses.push_back(parse_pose_row(line.text, file, line.number));
    } else if (list.format == PoseFormat::kRollout) {
      list.poses.push_back(parse_seven(split_at_blanks(line.text), 0, list.format, line, file));
    } else {
      const auto words = split_at_blanks(line.text);
      decimals = std::max(decimals, decimals_of(words.front()));
      add_stamped(words, unit, line, list, file);
    }
    check_near_first(list.poses, line, file);
  }
  list.rounding_ns = rounding_of(decimals + 3 * static_cast<std::size_t>(unit));
  return list;
}

PoseList read_pose_list(const std::filesystem::path& file, std::optional<PoseFormat> format) {
  return parse_pose_list(read_file(file), format, file);
}

}  // namespace mosbench
