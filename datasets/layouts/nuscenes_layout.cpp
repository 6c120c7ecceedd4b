#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/layouts/nuscenes_tables.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/sequence/sequence.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kColumns = 5;

const NuscenesScene& scene_named(const NuscenesTables& tables, const std::string& name,
                                 const std::filesystem::path& folder) {
  const auto scene = std::ranges::find(tables.scenes, name, &NuscenesScene::name);
  if (scene == tables.scenes.end() || scene->scans.empty()) {
    throw DataError(folder / "sample_data.json", "has no scan of LIDAR_TOP in " + name,
                    "scans of every scene");
  }
  return *scene;
}

/// "n008...__LIDAR_TOP__1533151603547590" of the file with .pcd.bin behind it.
std::string stem_of(const std::filesystem::path& file) {
  return shown_in_line(file.stem().stem().string());
}

/// One scene of nuScenes: every scan of LIDAR_TOP, key frames and sweeps, with poses of ego_pose
/// and calibrated_sensor. Key frames have truth where the tables have annotations: 251 in boxes of
/// what moves, 9 elsewhere.
class NuscenesSequence : public Sequence {
 public:
  /// Throws DataError for tables that do not fit each other and for missing scans, UsageError for
  /// options that say how other files are read.
  NuscenesSequence(std::string name, const std::filesystem::path& tables, const Reading& asked)
      : tables_(read_nuscenes_tables(tables)) {
    mutable_recording().name = SequenceName(name, tables);
    list_scans(parent_folder(tables), scene_named(*tables_, name, tables));
    say_what_is_read(tables);
    take_poses(tables, asked);
  }

  using Sequence::read;

  void read(std::size_t scan_index, Frame& frame) const override {
    const ScanEntry& entry = scan(scan_index);
    frame.points = read_scan(*entry.file, kColumns, std::move(frame.points));
    check_count(scan_index, frame.points.size());
    describe(scan_index, frame);
    frame.point_times_ns.clear();
    frame.truth.reset();
    if (!entry.has_truth) return;
    // Boxes are in the map of ego_pose, whatever poses the scans are given.
    const NuscenesScan& row = *scans_[scan_index];
    frame.truth = nuscenes_truth(frame.points, row.map_from_sensor, row.moving);
  }

 private:
  void list_scans(const std::filesystem::path& root, const NuscenesScene& scene) {
    std::size_t absent = 0;
    for (const NuscenesScan& scan : scene.scans) {
      // Who downloaded key frames alone has no sweeps.
      if (!scan.is_key_frame && !is_there(root / scan.file)) {
        ++absent;
        continue;
      }
      ScanEntry& entry = mutable_recording().scans.emplace_back();
      entry.stem = stem_of(scan.file);
      entry.file = root / scan.file;
      entry.stamp_ns = scan.stamp_ns;
      entry.points = read_scan_head(*entry.file, kColumns).points;
      entry.has_truth = scan.is_key_frame && tables_->has_annotations;
      scans_.push_back(&scan);
    }
    if (absent > 0) {
      mutable_recording().doubts.push_back(fmt::format(
          "left out {} on the disk", counted(absent, "sweep of sample_data.json that is not",
                                             "sweeps of sample_data.json that are not")));
    }
  }

  void take_poses(const std::filesystem::path& folder, const Reading& asked) {
    Recording& recording = mutable_recording();
    if (asked.has_own_poses()) {
      SensorPoses own =
          own_poses("ego_pose.json and calibrated_sensor.json", folder / "ego_pose.json");
      for (const NuscenesScan* scan : scans_)
        own.map_from_sensor.emplace_back(scan->map_from_sensor);
      place_scans(std::move(own), recording);
      return;
    }
    const std::vector<const NuscenesScan*> rows = std::exchange(scans_, {});
    for (const std::size_t k : place_scans(folder, "", asked, recording)) scans_.push_back(rows[k]);
  }

  void say_what_is_read(const std::filesystem::path& folder) {
    Recording& recording = mutable_recording();
    for (const char* table : kNuscenesTables) recording.files.push_back(folder / table);
    recording.reading.scan_files = ".pcd.bin of LIDAR_TOP, key frames and sweeps";
    const auto labelled = std::ranges::count(recording.scans, true, &ScanEntry::has_truth);
    if (labelled == 0) {
      const bool has_table = is_there(folder / "sample_annotation.json");
      recording.remarks.emplace_back(
          has_table ? "no annotations: there is no truth"
                    : "no annotations, sample_annotation.json is not there: there is no truth");
      return;
    }
    recording.truth_files = {folder / "attribute.json", folder / "sample_annotation.json"};
    recording.remarks.push_back(
        fmt::format("truth of {} of {}, from boxes of vehicle.moving, "
                    "cycle.with_rider and pedestrian.moving",
                    counted(labelled, "key frame"), counted(recording.scans.size(), "scan")));
  }

  std::shared_ptr<const NuscenesTables> tables_;
  std::vector<const NuscenesScan*> scans_;  ///< in `tables_`
};

constexpr std::string_view kScenePrefix = "scene-";

/// The numbers of the scenes of each split, of nuscenes-devkit,
/// python-sdk/nuscenes/utils/splits.py: 700, 150 and 150 scenes.
constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kSceneSplits = {
    {{"train",
      "1-2 4-11 19-34 41-76 120-135 138-139 149-152 154-155 157-168 170-185 187-188 190-196 "
      "199-200 202-204 206-214 218-220 222 224-264 283-306 315-318 321 323-324 328 347-386 "
      "388-403 405-408 410-459 461-465 467-469 471-472 474-480 499-502 504-515 517-518 525-539 "
      "541-546 566 568 570-578 580 582-600 639-679 681 683-689 695-698 700-701 703-719 726-728 "
      "730-731 733-741 744 746-747 749-752 757-765 767-769 786-787 789-792 803-806 808-813 "
      "815-817 819-822 847-856 858 860-866 868-873 875-878 880 882-903 945 947 949 952-953 "
      "955-961 975-984 988-992 994-1025 1044-1058 1074-1102 1104-1110"},
     {"val",
      "3 12-18 35-36 38-39 92-110 221 268-278 329-332 344-346 519-524 552-565 625-627 629-630 "
      "632-638 770-771 775 777-778 780-784 794-800 802 904-917 919-931 962-963 966-969 971-972 "
      "1059-1073"},
     {"test",
      "77-91 111-119 140 142-148 265-266 279-282 307-314 333-343 481-498 547-551 601-604 "
      "606-624 827-831 833-842 844-846 932-933 935-943 1026-1043"},
     {"mini_train", "61 553 655 757 796 1077 1094 1100"},
     {"mini_val", "103 916"}}};

/// Whether a folder holds tables of nuScenes, if only half of them.
bool has_tables(const fs::path& folder) {
  return missing_nuscenes_tables(folder).size() <= kNuscenesTables.size() / 2;
}

/// Lists the folders of tables, "v1.0-mini" and so on, at a place; those that lack some only where
/// none has all, so that opening them names what they lack.
std::vector<fs::path> versions_in(const fs::path& folder) {
  if (has_tables(folder)) return {folder};
  std::vector<fs::path> whole, partial;
  for (const fs::path& below : list_folders(folder)) {
    if (!below.filename().string().starts_with("v1.0-")) continue;
    const std::size_t missing = missing_nuscenes_tables(below).size();
    if (missing < kNuscenesTables.size()) (missing == 0 ? whole : partial).push_back(below);
  }
  return whole.empty() ? partial : whole;
}

/// The same at a root, else in the folders below it, as `convert` writes them.
std::vector<fs::path> versions_below(const fs::path& path) {
  std::vector<fs::path> versions = versions_in(path);
  if (!versions.empty()) return versions;
  for (const fs::path& folder : list_folders(path)) {
    for (fs::path& version : versions_in(folder)) versions.push_back(std::move(version));
  }
  return versions;
}

/// "0061" of "scene-0061".
std::string alias_of(const std::string& scene) {
  return scene.starts_with(kScenePrefix) ? scene.substr(kScenePrefix.size()) : "";
}

std::vector<SequenceFolder> list_nuscenes(const fs::path& path) {
  std::vector<SequenceFolder> sequences;
  std::map<std::string, fs::path> place_of_name;
  for (const fs::path& version : versions_below(path)) {
    if (const auto missing = missing_nuscenes_tables(version); !missing.empty()) {
      throw DataError(version / missing.front(), "is not there",
                      fmt::format("the tables {} of nuScenes", fmt::join(kNuscenesTables, ", ")));
    }
    for (const std::string& name : nuscenes_scene_names(version)) {
      const auto [other, is_new] = place_of_name.emplace(name, version);
      if (!is_new) {
        throw DataError(path,
                        fmt::format("holds {} twice, in {} and {}", mosbench::quoted(name),
                                    other->second.string(), version.string()),
                        "one of them as DATA");
      }
      sequences.push_back({name, version, alias_of(name)});
    }
  }
  return sequences;
}

std::unique_ptr<Sequence> open_nuscenes(const SequenceFolder& sequence, const Reading& asked) {
  return std::make_unique<NuscenesSequence>(sequence.name, sequence.folder, asked);
}

/// Whether a number is one of "1-2 4-11 61".
bool holds(std::string_view ranges, std::uint64_t number) {
  return std::ranges::any_of(split_at_blanks(ranges), [&](std::string_view range) {
    const auto first = parse_unsigned(range.substr(0, range.find('-')));
    const auto last = parse_unsigned(range.substr(range.find('-') + 1));
    return number >= first && number <= last;
  });
}

std::vector<Split> nuscenes_splits(const std::vector<SequenceFolder>& folders,
                                   const std::vector<std::unique_ptr<Sequence>>&,
                                   std::vector<std::string>&) {
  std::vector<std::string_view> names;
  for (const auto& [name, ranges] : kSceneSplits) names.push_back(name);
  return splits_of_sequences(
      names, folders, [](std::string_view split, const SequenceFolder& folder) {
        const auto number = stem_number(alias_of(folder.name));
        const auto row =
            std::ranges::find(kSceneSplits, split, [](const auto& r) { return r.first; });
        return number && holds(row->second, *number);
      });
}

/// Whether half of the tables are there, and one whose name no other data set has.
bool is_surely_nuscenes(const fs::path& tables) {
  return has_tables(tables) &&
         (is_there(tables / "sample_data.json") || is_there(tables / "calibrated_sensor.json"));
}

std::optional<std::string> recognise_nuscenes(const fs::path& path) {
  const auto versions = versions_below(path);
  const auto sure = std::ranges::find_if(versions, is_surely_nuscenes);
  if (sure == versions.end()) return std::nullopt;
  return "the tables of " + folder_name(*sure) + " are there";
}

std::optional<std::string> recognise_part_of_nuscenes(const fs::path& path) {
  const auto versions = versions_below(path);
  if (versions.empty()) return std::nullopt;
  return "some tables of " + folder_name(versions.front()) + " are there";
}

/// What is in no box is static; the owner of a moving point is its instance, as that of a box.
std::uint32_t simulated_nuscenes_label(const SimulatedReturn& seen) {
  return seen.owner.moving ? with_instance(kMovingLabel, seen.owner_number) : kStaticLabel;
}

std::optional<std::int64_t> whole_microseconds(std::int64_t stamp_ns, std::int64_t) {
  constexpr std::int64_t kNsPerUs = 1000;
  return stamp_ns / kNsPerUs * kNsPerUs;
}

}  // namespace

const Layout& nuscenes_layout() {
  static const Layout row = {
      .name = "nuscenes",
      .usual = {"nuscenes", "mapmos-nuscenes"},
      .title = "nuScenes, CVPR 2020, with the truth that MapMOS makes of its boxes",
      .content = "32-beam Velodyne on a car, 20 Hz, boxes at 2 Hz",
      .size = "1000 scenes of 20 s, some 390,000 scans",
      .published = "nuscenes.org",
      .licence = "CC BY-NC-SA 4.0, with nuScenes' terms of use",
      .folders = {"<root>/", "  v1.0-{mini,trainval,test}/*.json   the tables",
                  "  samples/LIDAR_TOP/*.pcd.bin        key frames, which have truth",
                  "  sweeps/LIDAR_TOP/*.pcd.bin         the scans between",
                  "<root>/<folder>/                    such roots, as convert writes them"},
      .files = {.label_ids = {kStaticLabel, kMovingLabel}, .sensor_range_m = 200.0},
      .expected =
          "v1.0-mini, v1.0-trainval or v1.0-test with the tables of nuScenes beside samples/ and "
          "sweeps/, or one such folder of tables",
      .list = list_nuscenes,
      .open = open_nuscenes,
      .no_point_times = [](const std::filesystem::path&) -> std::string {
        return "the fifth column of nuScenes is the ring, expected azimuth or none";
      },
      .splits = nuscenes_splits,
      .evidence = Evidence::kFolders,
      .recognise = recognise_nuscenes,
      .recognise_part = recognise_part_of_nuscenes,
      .scan_folders = 2,
      .writer = LayoutWriter{.open = write_as_nuscenes,
                             .folder = flat_folder,
                             .files = files_of_nuscenes,
                             .last_file = [](const WriteOptions&) { return kNuscenesLastFile; },
                             .keeps = KeptTruth::kMoving},
      .simulation =
          LayoutSimulation{.recordings = {{"{}", "{}", SensorKind::kHdl32e}},
                           .label = simulated_nuscenes_label,
                           .labelled = [](std::size_t scans) { return every_labelled(5, scans); },
                           .stamp_ns = whole_microseconds}};
  return row;
}

}  // namespace mosbench
