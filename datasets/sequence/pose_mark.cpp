#include "datasets/sequence/pose_mark.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <regex>

#include "datasets/disk/files.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kDoubt = "doubt: ";

fs::path frame_file(fs::path file) { return file += ".frame"; }

/// With the hash, so that the mark of an overwritten file says nothing about the new one.
std::string lidars(std::string_view text) {
  return fmt::format("lidar {:016x}\n", XXH3_64bits(text.data(), text.size()));
}

bool are_of_one_simulation(const SimulatedOrigin& one, const DataMark& other) {
  return other.simulated && other.simulated->scene_fingerprint == one.scene_fingerprint &&
         other.simulated->seed == one.seed;
}

}  // namespace

PoseMark pose_mark_of(const DataMark& data) {
  PoseMark mark{data.simulated, {}};
  if (std::string doubt = disturbed_doubt(data); !doubt.empty()) mark.doubts = {std::move(doubt)};
  return mark;
}

void mark_poses(const fs::path& file, std::string_view text, const PoseMark& mark) {
  std::string lines = lidars(text);
  for (const std::string& doubt : mark.doubts) {
    lines += fmt::format("{}{}\n", kDoubt, shown_in_line(doubt));
  }
  if (mark.simulated) lines += format_simulated_origin(*mark.simulated);
  write_file_atomic(frame_file(file), lines);
}

bool has_foreign_mark(const fs::path& file) {
  static const std::regex kOurs("lidar [0-9a-f]{16}");
  const fs::path frame = frame_file(file);
  if (!is_there(frame)) return false;
  const std::string text = read_file(frame);
  return !text.empty() && !std::regex_match(text.substr(0, text.find('\n')), kOurs);
}

std::optional<PoseMark> pose_mark(const fs::path& file) {
  const fs::path frame = frame_file(file);
  if (!is_there(frame)) return std::nullopt;
  const std::string text = read_file(frame), head = lidars(read_file(file));
  if (!text.starts_with(head)) return std::nullopt;
  std::string_view rest = std::string_view(text).substr(head.size());
  PoseMark mark;
  while (rest.starts_with(kDoubt)) {
    mark.doubts.push_back(shown_in_line(take_line(rest).substr(kDoubt.size())));
  }
  if (!rest.empty()) mark.simulated = parse_simulated_origin(rest, frame);
  return mark;
}

PoseMark mark_of_poses(const fs::path& file) {
  const auto own = pose_mark(file);
  if (own && own->is_set()) return *own;
  PoseMark mark = pose_mark_of(mark_of_file(file, 0));
  const fs::path frame = frame_file(file);
  if (!own && is_there(frame) && !has_foreign_mark(file)) {
    mark.doubts.push_back(frame.filename().string() + " is of other poses");
  }
  return mark;
}

std::vector<std::string> doubts_of_poses(const fs::path& file, const DataMark& scans) {
  PoseMark mark = mark_of_poses(file);
  std::vector<std::string>& doubts = mark.doubts;
  if (mark.simulated && !are_of_one_simulation(*mark.simulated, scans)) {
    doubts.push_back(fmt::format("poses of simulated scans (scene {}, seed {})",
                                 mark.simulated->scene, mark.simulated->seed));
  }
  for (std::string& doubt : doubts) doubt = file.filename().string() + ": " + doubt;
  return doubts;
}

}  // namespace mosbench
