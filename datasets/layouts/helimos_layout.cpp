#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <span>

#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

// Folders as published: the place, in it the scans, in it the sensors.
constexpr const char* kPlace = "KAIST05";
constexpr const char* kScans = "Deskewed_LiDAR";
constexpr std::array<const char*, 4> kSensors = {"Aeva", "Avia", "Ouster", "Velodyne"};

/// The folder of the sensors and of the split files, relative to the root.
std::filesystem::path folder_of_sensors() { return std::filesystem::path(kPlace) / kScans; }

/// The four recordings differ by up to this many scans (12475 to 12477) and share their split
/// files.
constexpr std::uint64_t kLongestTail = 2;

bool is_sensor(const std::string& name) {
  return std::ranges::find(kSensors, name) != kSensors.end();
}

/// Lists all sensor folders if one has scans: one without is listed too, so that opening it says
/// what it lacks.
std::vector<SequenceFolder> list_sensors(const std::filesystem::path& root) {
  std::vector<SequenceFolder> sequences;
  bool has_scans = false;
  for (const char* sensor : kSensors) {
    if (!is_there(root / sensor)) continue;
    sequences.push_back({sensor, root / sensor, ""});
    has_scans = has_scans || scan_folder_of(root / sensor);
  }
  return has_scans ? sequences : std::vector<SequenceFolder>{};
}

/// Lists the sensors in `root`, else in its folder Deskewed_LiDAR, spelt in any case.
std::vector<SequenceFolder> list_deskewed(const std::filesystem::path& root) {
  if (auto sequences = list_sensors(root); !sequences.empty()) return sequences;
  for (const auto& folder : list_folders(root)) {
    if (lower_case(folder.filename().string()) == lower_case(kScans)) return list_sensors(folder);
  }
  return {};
}

std::vector<SequenceFolder> list_helimos(const std::filesystem::path& path) {
  if (scan_folder_of(path)) return {{folder_name(path), path, ""}};
  if (auto sequences = list_deskewed(path); !sequences.empty()) return sequences;
  const auto kaist = path / kPlace;
  return std::filesystem::is_directory(kaist) ? list_deskewed(kaist)
                                              : std::vector<SequenceFolder>{};
}

/// Returns the stems of the scans whose numbers are in a split file. A number without a scan is an
/// error, as the score would silently be over another set, except in the tail that a shorter
/// recording lacks.
std::set<std::string> stems_of_split(const Sequence& sequence, const std::filesystem::path& file,
                                     std::vector<std::string>& remarks) {
  std::map<std::uint64_t, std::size_t> scan_of_number;
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    if (const auto number = stem_number(sequence.stem(i))) scan_of_number.emplace(*number, i);
  }
  std::set<std::uint64_t> without_pose;
  for (const ScanEntry& scan : sequence.recording().left_out) {
    if (const auto number = stem_number(scan.stem)) without_pose.insert(*number);
  }
  const std::uint64_t last = scan_of_number.empty() ? 0 : scan_of_number.rbegin()->first;
  std::set<std::string> stems;
  std::size_t beyond = 0;
  std::size_t poseless = 0;
  std::size_t unlabelled = 0;
  for (const std::uint64_t number : parse_split(read_file(file), file)) {
    const auto scan = scan_of_number.find(number);
    if (scan != scan_of_number.end()) {
      stems.insert(sequence.stem(scan->second));
      if (!sequence.has_truth(scan->second)) ++unlabelled;
    } else if (without_pose.contains(number)) {
      ++poseless;
    } else if (number > last && number - last <= kLongestTail) {
      ++beyond;
    } else {
      throw DataError(
          file, fmt::format("names frame {}, which {} does not have", number, sequence.name()),
          "numbers of scans");
    }
  }
  const auto remark = [&](std::size_t count, const char* fault) {
    if (count == 0) return;
    remarks.push_back(fmt::format("{}: {} of the frames in {} {}", sequence.name(), count,
                                  file.filename().string(), fault));
  };
  remark(unlabelled, "have no label and do not count");
  remark(poseless, "have no pose and are left out");
  remark(beyond, "lie after the end of the recording and are left out");
  return stems;
}

std::vector<Split> helimos_splits(const std::vector<SequenceFolder>& folders,
                                  const std::vector<std::unique_ptr<Sequence>>& sequences,
                                  std::vector<std::string>& remarks) {
  std::vector<Split> splits = {{"all", {}}, {"test", {}}, {"val", {}}, {"train", {}}};
  for (std::size_t i = 0; i < folders.size(); ++i) {
    splits.front().parts.push_back({i, std::nullopt});
    for (Split& split : std::span(splits).subspan(1)) {
      const auto file = parent_folder(folders[i].folder) / (split.name + ".txt");
      if (!is_there(file)) continue;
      auto stems = stems_of_split(*sequences[i], file, remarks);
      if (!stems.empty()) split.parts.push_back({i, std::move(stems)});
    }
  }
  std::erase_if(splits, [](const Split& split) { return split.parts.empty(); });
  return splits;
}

std::optional<std::string> recognise_helimos(const std::filesystem::path& path) {
  const auto sequences = list_helimos(path);
  if (sequences.empty() || !is_sensor(sequences.front().name)) return std::nullopt;
  return "the sensor folder " + sequences.front().name + " is there";
}

std::filesystem::path helimos_sequence_folder(const std::string& name, std::size_t position) {
  if (is_sensor(name)) return folder_of_sensors() / name;
  if (position < kSensors.size()) return folder_of_sensors() / kSensors[position];
  throw UsageError(fmt::format("{} has room for 4 sequences, not for {}, expected fewer in {}",
                               option("layout", "helimos"), name, option("sequences")));
}

constexpr std::array<const char*, 3> kSplits = {"train", "val", "test"};

std::vector<std::filesystem::path> files_of_helimos(const Sequence& sequence) {
  std::vector<std::filesystem::path> files = files_of_kitti(sequence);
  for (const std::string name : kSplits) files.push_back("../" + name + ".txt");
  return files;
}

/// Writes the split files, one set for all sensors, of the splits that have a scan.
void write_splits(const std::filesystem::path& root, const SplitNumbers& splits) {
  for (const std::string name : kSplits) {
    const auto numbers = splits.find(name);
    if (numbers == splits.end() || numbers->second.empty()) continue;
    write_file_atomic(root / folder_of_sensors() / (name + ".txt"), format_split(numbers->second));
  }
}

/// 9 or 251 within 80 m, else 0.
std::uint32_t simulated_helimos_label(const SimulatedReturn& seen) {
  constexpr double kFarthest_m = 80.0;
  return range_m(seen.point) > kFarthest_m ? 0 : moving_label(seen);
}

std::vector<SimulatedRecording> simulated_recordings() {
  constexpr std::array<SensorKind, kSensors.size()> kModels = {
      SensorKind::kAeva, SensorKind::kAvia, SensorKind::kOs2_128, SensorKind::kVlp16};
  std::vector<SimulatedRecording> recordings;
  for (std::size_t i = 0; i < kModels.size(); ++i) {
    recordings.push_back({folder_of_sensors() / kSensors[i], kSensors[i], kModels[i]});
  }
  return recordings;
}

}  // namespace

const Layout& helimos_layout() {
  static const Layout row = {
      .name = "helimos",
      .usual = {"helimos", "helimos-all"},
      .title = "HeLiMOS, IROS 2024",
      .content = "Aeva, Livox Avia, Ouster OS2-128 and Velodyne VLP-16 on one car",
      .size = "about 35 GB zipped, some 12476 scans per sensor",
      .published = "github.com/url-kaist/HeLiMOS-PointCloud-Toolbox",
      .licence = "CC BY-NC-SA 4.0 for the HeLiPR data it is made of",
      .folders = {"<root>/ (KAIST05/Deskewed_LiDAR of the download)",
                  "  train.txt val.txt test.txt     scan numbers of the splits",
                  "  {Aeva,Avia,Ouster,Velodyne}/velodyne/%06d.bin",
                  "  {Aeva,Avia,Ouster,Velodyne}/labels/%06d.label   for part of the scans",
                  "  {Aeva,Avia,Ouster,Velodyne}/poses.txt           the HMM-MOS authors publish "
                  "theirs",
                  "  {Aeva,Avia,Ouster,Velodyne}/calib.txt"},
      .files =
          {.label_ids = {0, 9, 251},
           .sensor_range_m = 450.0,
           // Rows of the pose files that the authors of HMM-MOS publish.
           .published = {{"Velodyne", 12477}, {"Ouster", 12477}, {"Avia", 12476}, {"Aeva", 12475}}},
      .expected =
          "Aeva, Avia, Ouster, Velodyne with velodyne/, labels/ and poses.txt each, in "
          "KAIST05/Deskewed_LiDAR, Deskewed_LiDAR or the folder itself (HeLiMOS), or one "
          "such folder",
      .list = list_helimos,
      .open = open_kitti,
      .splits = helimos_splits,
      .evidence = Evidence::kFolders,
      .recognise = recognise_helimos,
      .writer = LayoutWriter{.open = write_as_kitti,
                             .folder = helimos_sequence_folder,
                             .files = files_of_helimos,
                             .write_splits = write_splits},
      .simulation =
          LayoutSimulation{.recordings = simulated_recordings(),
                           .label = simulated_helimos_label,
                           .labelled = [](std::size_t scans) { return every_labelled(4, scans); },
                           .is_global = true,
                           .stamp_ns = no_stamp}};
  return row;
}

}  // namespace mosbench
