#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/mounts_file.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/kitti_sequence.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/rosbag/bag_rig.hpp"
#include "datasets/rosbag/bag_sequence.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/sequence/rig_sequence.hpp"
#include "datasets/sequence/sequence.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

/// One scan file (.bin, .pcd or .ply) as a sequence of its own. Its pose is the identity unless
/// `options.poses` names a file with one. It has no truth.
class SingleScan : public Sequence {
 public:
  /// Throws DataError for a file that is no scan, UsageError for times of points in a column: one
  /// scan alone shows no motion to correct.
  SingleScan(std::string name, const std::filesystem::path& file, const Reading& asked)
      : bin_columns_(asked.bin_columns.value_or(kUsualBinColumns)) {
    Recording& recording = mutable_recording();
    recording.name = SequenceName(std::move(name), file);
    ScanEntry& entry = recording.scans.emplace_back();
    entry.stem = shown_in_line(file.stem().string());
    entry.file = file;
    if (!asked.bin_columns) check_usual_bin_columns(std::array{StemFile{file, entry.stem}});
    entry.points = read_scan_head(file, bin_columns_).points;
    recording.reading.scan_files = file.filename().string();
    if (asked.pose_file() != nullptr) {
      place_scans(file.parent_path(), "poses.txt", asked, recording);
      return;
    }
    recording.reading.poses.source = "the identity, of one scan";
    recording.remarks = {"one scan: its pose is the identity"};
  }

  using Sequence::read;

  void read(std::size_t scan_index, Frame& frame) const override {
    const ScanEntry& entry = scan(scan_index);
    frame.points = read_scan(*entry.file, bin_columns_, std::move(frame.points));
    if (frame.points.size() != entry.points) {
      throw DataError(*entry.file, "changed since it was opened",
                      std::to_string(entry.points) + " points");
    }
    describe(scan_index, frame);
    frame.point_times_ns.clear();
    frame.truth.reset();
  }

 private:
  std::size_t bin_columns_;
};

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

/// A bag or a scan that is given itself, the bags of a folder, each with its parts, or the folder
/// of scans. One bag is called as its folder.
std::vector<SequenceFolder> list_recording(const std::filesystem::path& path) {
  if (is_bag_folder(path)) return {{folder_name(path), path, ""}};
  if (is_bag_file(path) || is_scan(path)) return {{path.stem().string(), path, ""}};
  if (!std::filesystem::is_directory(path)) return {};
  const std::vector<BagParts> bags = group_parts(bags_of(path));
  const bool is_one = bags.size() == 1;
  std::vector<SequenceFolder> sequences;
  for (const BagParts& bag : bags) {
    const std::filesystem::path& first = bag.files.front();
    const std::filesystem::path own_name = is_bag_folder(first) ? first.filename() : first.stem();
    const bool is_part = bag.files.size() > 1 || !bag.doubt.empty();
    // Two stretches of one drive, with a part missing between, are called as their first parts.
    const bool is_whole = std::ranges::count(bags, bag.name, &BagParts::name) == 1;
    std::string name = is_whole && !bag.name.empty() ? bag.name : own_name.string();
    if (is_one && !is_bag_folder(first)) name = folder_name(path);
    // Only a recording in parts has a second name.
    sequences.push_back({std::move(name), first, is_part ? own_name.string() : ""});
  }
  expect_own_names(path, sequences);
  if (sequences.empty() && !scans_in(path).empty()) return {{folder_name(path), path, ""}};
  return sequences;
}

/// Returns where a LiDAR is mounted. Throws DataError naming `file` for one that has no row.
Pose mount_of(const std::map<std::string, Pose>& mounts, const std::string& name,
              const std::filesystem::path& file) {
  const auto mount = mounts.find(name);
  if (mount == mounts.end()) {
    throw DataError(file, "has no row of " + name, std::string("one for each LiDAR: ") + kMountRow);
  }
  return mount->second;
}

/// Opens folders of scans as one RigSequence, or the one folder.
std::unique_ptr<Sequence> open_folder_lidars(const SequenceFolder& sequence, const Reading& asked) {
  const std::vector<std::string> names = lidar_names(asked);
  const std::filesystem::path file = sequence.folder / kMountsFile;
  const auto mounts = names.size() > 1
                          ? parse_mounts(read_file(file), file)
                          : std::map<std::string, Pose>{{names.front(), Pose::Identity()}};
  std::vector<RigLidar> lidars;
  for (const std::string& name : names) {
    const std::filesystem::path folder = sequence.folder / name;
    if (!std::filesystem::is_directory(folder)) {
      throw DataError(folder, "is no folder", "the scans of a LiDAR");
    }
    const std::filesystem::path shared = sequence.folder / "poses.txt";
    Reading reading = lidars.empty() ? asked : without_poses(asked);
    if (reading.has_own_poses() && !is_there(folder / "poses.txt") && is_there(shared)) {
      reading.poses = PoseFile{shared};
    }
    const std::string_view scan_folder = scans_in(folder).empty() ? "" : ".";
    const Pose first_from_this =
        mount_of(mounts, names.front(), file).inverse() * mount_of(mounts, name, file);
    auto own = std::make_unique<KittiSequence>(
        sequence.name, folder, reading, SequenceLayout{.folder = {.scan_folder = scan_folder}});
    own->set_mark(merged(merged(mark_in(sequence.folder), mark_in(folder)),
                         mark_of_file(*own->scan_file(0), 0)));
    lidars.push_back({name, std::move(own), first_from_this});
  }
  if (lidars.size() == 1) return std::move(lidars.front().sequence);
  return std::make_unique<RigSequence>(std::move(lidars), std::vector{file});
}

/// Returns the parts that a recording was found as, none where it is one bag.
std::optional<BagParts> parts_of(const SequenceFolder& sequence) {
  const auto& path = sequence.folder;
  if (sequence.alias.empty()) return std::nullopt;
  auto bags = group_parts(bags_of(path.parent_path()));
  const auto parts =
      std::ranges::find_if(bags, [&](const BagParts& bag) { return bag.files.front() == path; });
  if (parts == bags.end()) throw DataError(path, "changed while it was read", "a whole recording");
  return std::move(*parts);
}

std::unique_ptr<Sequence> open_recording(const SequenceFolder& sequence, const Reading& asked) {
  const auto& path = sequence.folder;
  if (!sequence.alias.empty() || is_bag(path)) {
    const auto parts = parts_of(sequence);
    const auto open = [&] { return parts ? open_bag(*parts) : open_bag(path); };
    std::unique_ptr<Sequence> drive;
    if (asked.lidars) {
      drive = open_bag_lidars(sequence.name, open, asked);
    } else {
      drive = std::make_unique<BagSequence>(sequence.name, open(), asked);
    }
    if (parts && !parts->doubt.empty()) drive->add_doubt(parts->doubt);
    return drive;
  }
  if (asked.lidars) return open_folder_lidars(sequence, asked);
  if (is_scan(path)) return std::make_unique<SingleScan>(sequence.name, path, asked);
  return std::make_unique<KittiSequence>(sequence.name, path, asked,
                                         SequenceLayout{.folder = {.scan_folder = "."}});
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
                  "<root>/ with such files or folders: a sequence each; parts of one recording,",
                  "  numbered as drive_0.bag, drive_1.bag, are one",
                  "<root>/*.bin, *.pcd or *.ply, with or without", "  poses.txt   12 numbers a row",
                  "  times.txt   seconds", "  labels/*.label",
                  "<file>.bin, .pcd or .ply: one scan"},
      .files = {.sensor_range_m = 450.0},
      .expected = "a bag, a .bin, .pcd or .ply scan, or a folder with bags or scans",
      .list = list_recording,
      .open = open_recording,
      .no_point_times = recording_without_times,
      .evidence = Evidence::kNone,
      .recognise = recognise_recording,
      .writer = LayoutWriter{write_as_ros2_bag, flat_folder, files_of_ros2_bag}};
  return row;
}

}  // namespace mosbench
