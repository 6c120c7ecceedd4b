#include "datasets/sequence/sequence.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kLongest_bytes = 255;
constexpr std::ptrdiff_t kMostSlashes = 1;

bool is_of_results(std::string_view part) {
  return std::ranges::find(kScanFileFolders, part) != kScanFileFolders.end() ||
         part == "result.json" || part.ends_with(".partial") || part.ends_with(".replaced");
}

void check_part(std::string_view part, const std::string& text, const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& expected) {
    throw DataError(file, fmt::format("names the sequence \"{}\"", shown_in_line(text)), expected);
  };
  if (part.empty() || part == "." || part == "..") refuse("a folder below that of results");
  if (part.size() > kLongest_bytes) refuse("at most 255 bytes");
  if (!is_printable(part)) refuse("UTF-8 without control characters");
  if (is_of_results(part)) {
    refuse(fmt::format(
        "another name: results use {}, result.json, *.partial and *.replaced themselves",
        fmt::join(kScanFileFolders, ", ")));
  }
}

}  // namespace

SequenceName::SequenceName(std::string text, const std::filesystem::path& file)
    : text_(std::move(text)) {
  if (std::ranges::count(text_, '/') > kMostSlashes) {
    throw DataError(file, fmt::format("names the sequence \"{}\"", shown_in_line(text_)),
                    "one folder, or a scene and a folder");
  }
  for (std::string_view rest = text_;;) {
    const std::size_t slash = rest.find('/');
    check_part(rest.substr(0, slash), text_, file);
    if (slash == std::string_view::npos) return;
    rest.remove_prefix(slash + 1);
  }
}

bool is_left_out(const Recording& recording, const std::string& stem) {
  const auto is_of = [&](const ScanEntry& scan) { return scan.stem == stem; };
  return std::ranges::any_of(recording.left_out, is_of) ||
         std::ranges::any_of(recording.not_asked, is_of);
}

std::vector<std::filesystem::path> files_of(const Recording& recording) {
  std::vector<std::filesystem::path> files = recording.files;
  for (const ScanEntry& scan : recording.scans) {
    if (scan.file) files.push_back(*scan.file);
  }
  files.insert(files.end(), recording.truth_files.begin(), recording.truth_files.end());
  return files;
}

void lose_point(Frame& frame, std::size_t point) {
  frame.points[point] = {0, 0, 0, 0};
  if (frame.truth) (*frame.truth)[point] = 0;
  if (!frame.radial_velocity_m_s.empty()) frame.radial_velocity_m_s[point] = 0;
}

void Sequence::describe(std::size_t scan_index, Frame& frame) const {
  const ScanEntry& entry = scan(scan_index);
  frame.stem = entry.stem;
  frame.map_from_sensor = entry.map_from_sensor;
  frame.stamp_ns = entry.stamp_ns;
  frame.point_times_ns.clear();
  frame.origins = {};
  frame.motions.reset();
  frame.radial_velocity_m_s.clear();
}

std::vector<std::uint32_t> Sequence::read_truth(std::size_t scan_index) const {
  if (!has_truth(scan_index)) refuse_truth(scan_index);
  return *read(scan_index).truth;
}

void Sequence::add_truth(std::size_t scan_index, Frame& frame) const {
  frame.truth.reset();
  if (has_truth(scan_index)) frame.truth = read_truth(scan_index);
}

void Sequence::refuse_truth(std::size_t scan_index) const {
  const std::filesystem::path place = std::filesystem::path(name()) / stem(scan_index);
  throw DataError(scan_file(scan_index).value_or(place), "has no truth", "a labelled scan");
}

void Sequence::check_count(std::size_t scan_index, std::size_t points) const {
  const ScanEntry& entry = scan(scan_index);
  if (points == entry.points) return;
  throw DataError(*entry.file, "changed since the sequence was opened",
                  fmt::format("{} points", entry.points));
}

DataMark mark_as_read(const Sequence& sequence) {
  const std::optional<Perturbation>& perturb = sequence.reading().perturb;
  return disturbed_by(sequence.mark(), perturb ? to_string(*perturb) : "");
}

std::vector<Pose> poses_of(const Sequence& sequence) {
  std::vector<Pose> poses;
  for (const ScanEntry& scan : sequence.recording().scans) poses.push_back(scan.map_from_sensor);
  return poses;
}

std::vector<std::size_t> scans_with_truth(const Sequence& sequence) {
  std::vector<std::size_t> scans;
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    if (sequence.has_truth(k)) scans.push_back(k);
  }
  return scans;
}

}  // namespace mosbench
