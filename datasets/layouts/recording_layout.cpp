#include <fmt/format.h>

#include <map>
#include <memory>

#include "datasets/disk/folder_listing.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/kitti_sequence.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/layouts/single_scan.hpp"
#include "datasets/rosbag/bag_sequence.hpp"
#include "datasets/rosbag/open_bag.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

bool is_bag(const std::filesystem::path& path) { return is_bag_file(path) || is_bag_folder(path); }

/// Lists the bags in a folder, files before folders.
std::vector<std::filesystem::path> bags_of(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> bags;
  for (const StemFile& bag : list_by_stem(folder, {".bag", ".mcap", ".db3", ".zstd"})) {
    if (is_bag_file(bag.file)) bags.push_back(bag.file);
  }
  for (const std::filesystem::path& below : list_folders(folder)) {
    if (is_bag_folder(below)) bags.push_back(below);
  }
  return bags;
}

/// Results are called as their sequences: those of two of one name would overwrite each other.
void expect_own_names(const std::filesystem::path& folder,
                      const std::vector<SequenceFolder>& sequences) {
  std::map<std::string, std::filesystem::path> known;
  for (const SequenceFolder& sequence : sequences) {
    const auto [other, is_new] = known.emplace(sequence.name, sequence.folder.filename());
    if (is_new) continue;
    throw DataError(folder,
                    fmt::format("holds the bags {} and {}, both called {}", other->second.string(),
                                sequence.folder.filename().string(), sequence.name),
                    "names of their own, or one of them as DATA");
  }
}

/// A bag or a scan that is given itself, the bags of a folder, or the folder of scans. One bag is
/// called as its folder.
std::vector<SequenceFolder> list_recording(const std::filesystem::path& path) {
  if (is_bag_folder(path)) return {{folder_name(path), path, ""}};
  if (is_bag_file(path) || is_scan(path)) return {{path.stem().string(), path, ""}};
  if (!std::filesystem::is_directory(path)) return {};
  const auto bags = bags_of(path);
  if (bags.size() == 1 && is_bag_file(bags.front())) {
    return {{folder_name(path), bags.front(), ""}};
  }
  std::vector<SequenceFolder> sequences;
  for (const auto& bag : bags) {
    const auto name = is_bag_folder(bag) ? bag.filename() : bag.stem();
    sequences.push_back({name.string(), bag, ""});
  }
  expect_own_names(path, sequences);
  if (sequences.empty() && !scans_in(path).empty()) return {{folder_name(path), path, ""}};
  return sequences;
}

std::unique_ptr<Sequence> open_recording(const SequenceFolder& sequence, const Reading& asked) {
  const auto& path = sequence.folder;
  if (is_bag(path)) return std::make_unique<BagSequence>(sequence.name, path, asked);
  if (is_scan(path)) return std::make_unique<SingleScan>(sequence.name, path, asked);
  return std::make_unique<KittiSequence>(sequence.name, path, asked,
                                         SequenceLayout{.folder = {.scan_folder = "."}});
}

std::filesystem::path recording_folder(const std::string& name, std::size_t) {
  return flat_name(name);
}

std::optional<std::string> recognise_recording(const std::filesystem::path& path) {
  const auto sequences = list_recording(path);
  if (sequences.empty()) return std::nullopt;
  const auto& first = sequences.front().folder;
  if (sequences.size() > 1) return fmt::format("{} bags are there", sequences.size());
  if (is_bag_folder(path)) return "it is the folder of a ROS 2 bag";
  if (is_bag(path)) return "it is a bag";
  if (is_bag(first)) return "a bag is there";
  if (is_scan(path)) return "it is a scan";
  const auto scans = scans_in(path);
  const std::string what = scans.front().file.extension().string() + " file";
  return counted(scans.size(), what + " is there", what + "s are there");
}

}  // namespace

const Layout& recording_layout() {
  static const Layout row = {
      .name = "recording",
      .usual = {"recording", "semantickitti-mos"},
      .title = "A recording of your own: a bag, a scan, or a folder of either",
      .content = "any LiDAR",
      .size = "any",
      .published = "nowhere: it is yours",
      .licence = "yours",
      .folders = {"<file>.bag (ROS 1), .mcap or .db3 (ROS 2), each of these also packed as .zstd",
                  "<root>/metadata.yaml and the files that it names: a ROS 2 bag",
                  "<root>/ with such files or folders: a sequence each",
                  "<root>/*.bin, *.pcd or *.ply, with or without", "  poses.txt   12 numbers a row",
                  "  times.txt   seconds", "  labels/*.label",
                  "<file>.bin, .pcd or .ply: one scan"},
      .files = {.sensor_range_m = 450.0},
      .expected = "a bag, a .bin, .pcd or .ply scan, or a folder with bags or scans",
      .list = list_recording,
      .open = open_recording,
      .no_point_times = recording_without_times,
      .splits = nullptr,
      .evidence = Evidence::kNone,
      .recognise = recognise_recording,
      .writer = LayoutWriter{write_as_ros2_bag, recording_folder, files_of_ros2_bag}};
  return row;
}

}  // namespace mosbench
