#include "datasets/layouts/dataset.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <ranges>
#include <system_error>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/formats/mounts_file.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/layouts/convert.hpp"
#include "datasets/layouts/corrections.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/perturb/perturbation.hpp"
#include "datasets/sequence/pose_mark.hpp"
#include "datasets/sequence/rig_fit.hpp"
#include "datasets/sequence/scan_range.hpp"
#include "datasets/sequence/simulated_origin.hpp"
#include "datasets/sequence/still_sensor.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

/// Names what a path holds by the ends of names, which nothing here reads: " but 12 .pcap files".
std::string what_is_there(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) return ", and is no file that is read";
  std::map<std::string, std::size_t> files_of_end;
  std::size_t files = 0;
  for (std::filesystem::directory_iterator entry(path, error), end; !error && entry != end;
       entry.increment(error)) {
    if (!entry->is_regular_file(error)) continue;
    ++files_of_end[shown_in_line(entry->path().extension().string())];
    ++files;
  }
  const auto most = std::ranges::max_element(
      files_of_end, {}, [](const auto& end_and_files) { return end_and_files.second; });
  if (most == files_of_end.end()) return "";
  return fmt::format(" but {}, {} of them called *{}", counted(files, "file"), most->second,
                     most->first);
}

const Layout& recognise(const std::filesystem::path& path, std::vector<std::string>& remarks) {
  if (const auto origin = simulated_origin(path)) {
    const auto kind = dataset_kind_from_string(origin->layout);
    if (!kind) {
      throw DataError(path / kSimulatedMarker, "names the layout '" + origin->layout + "'",
                      "one of " + dataset_kind_names());
    }
    remarks.push_back("recognised as " + origin->layout + ": it is simulated in this layout");
    return layout_of(*kind);
  }
  for (const Evidence evidence : {Evidence::kFolders, Evidence::kName, Evidence::kNone}) {
    for (const Layout* layout : layouts()) {
      if (layout->evidence != evidence) continue;
      if (const auto why = layout->recognise(path)) {
        remarks.push_back("recognised as " + std::string(layout->name) + ": " + *why);
        return *layout;
      }
    }
  }
  // From the end: SemanticKITTI takes any folder with a number for a name for a part of it.
  for (const Layout* layout : layouts() | std::views::reverse) {
    if (layout->recognise_part == nullptr) continue;
    if (const auto why = layout->recognise_part(path)) {
      remarks.push_back("recognised as " + std::string(layout->name) + ": " + *why);
      return *layout;
    }
  }
  if (const std::string lidars = lidar_folders(path); !lidars.empty()) {
    throw DataError(
        path, "holds scans in the folders " + lidars,
        fmt::format("one of them, {}, or LiDARs of one vehicle, which are merged: {}, with "
                    "times.txt in each, beside {} with a row for each: {}",
                    option("lidars", lidars.substr(0, lidars.find(','))), option("lidars", lidars),
                    kMountsFile, kMountRow));
  }
  throw DataError(
      path, "holds no sequence" + what_is_there(path),
      "a data set, one sequence folder (velodyne/ or binFiles/ with scans, poses.txt), " +
          std::string(layout_of(DatasetKind::kRecording).expected));
}

std::string joined(const std::vector<SequenceFolder>& folders) {
  std::string names;
  for (const SequenceFolder& folder : folders) names += (names.empty() ? "" : ", ") + folder.name;
  return names;
}

bool has_name(const SequenceFolder& folder, const std::string& name) {
  return !name.empty() && (folder.name == name || folder.alias == name);
}

/// Returns the one folder whose alias ends in "_<name>", as "2011_09_26_drive_0011" in "_0011";
/// null where there is none, or are several.
const SequenceFolder* numbered(const std::vector<SequenceFolder>& folders,
                               const std::string& name) {
  const auto has_end = [&](const SequenceFolder& folder) {
    return !name.empty() && folder.alias.ends_with('_' + name);
  };
  if (std::ranges::count_if(folders, has_end) != 1) return nullptr;
  return &*std::ranges::find_if(folders, has_end);
}

/// Returns the folders whose name or alias is in `names`, in the data set's order; all when `names`
/// is empty.
std::vector<SequenceFolder> keep_named(std::vector<SequenceFolder> folders,
                                       std::vector<std::string> names) {
  if (names.empty()) return folders;
  for (std::string& name : names) {
    if (std::ranges::any_of(folders, [&](const auto& folder) { return has_name(folder, name); })) {
      continue;
    }
    const SequenceFolder* folder = numbered(folders, name);
    if (folder == nullptr) {
      throw UsageError("no sequence \"" + name + "\", expected one of " + joined(folders));
    }
    name = folder->name;
  }
  std::erase_if(folders, [&](const SequenceFolder& folder) {
    return std::ranges::none_of(names, [&](const auto& name) { return has_name(folder, name); });
  });
  return folders;
}

struct ListedSequences {
  const Layout& layout;
  std::vector<SequenceFolder> folders;
};

ListedSequences list_sequences(const std::filesystem::path& path, const OpenOptions& options,
                               std::vector<std::string>& remarks) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    error.clear();
    const std::filesystem::directory_iterator listing(path, error);
  }
  if (error) {
    throw DataError(path, "is no folder that can be listed (" + error.message() + ")",
                    "a data set's root, one sequence folder, a scan or a .bag file");
  }
  if (is_unfinished_conversion(path)) {
    throw DataError(path, "holds part of a data set (mosbench convert was stopped)",
                    "the same command to be run to its end");
  }
  const bool is_recording = !options.kind && options.reading.lidars;
  const Layout& layout = is_recording   ? layout_of(DatasetKind::kRecording)
                         : options.kind ? layout_of(*options.kind)
                                        : recognise(path, remarks);
  auto found = layout.list(path);
  if (holds_lidars(path, options.reading)) found = {{folder_name(path), path, ""}};
  if (found.empty()) throw DataError(path, "holds no sequence", std::string(layout.expected));
  return {layout, keep_named(std::move(found), options.sequences)};
}

/// The file of a sequence's poses in a folder as `mosbench odometry` and `run --odometry` write it.
std::filesystem::path pose_file_in(const std::filesystem::path& folder, const std::string& name) {
  for (const std::string& file : {name + ".txt", name + ".tum", name + "/poses.txt"}) {
    if (is_there(folder / file)) return folder / file;
  }
  throw DataError(folder, "holds no poses of sequence " + name,
                  fmt::format("{0}.txt, {0}.tum or {0}/poses.txt there, as mosbench odometry and "
                              "mosbench run --odometry write them",
                              name));
}

Reading reading_of(const SequenceFolder& sequence, Reading reading) {
  const std::filesystem::path* poses = reading.pose_file();
  std::error_code ignored;
  if (poses != nullptr && std::filesystem::is_directory(*poses, ignored)) {
    reading.poses = PoseFile{pose_file_in(*poses, sequence.name)};
  }
  return reading;
}

/// How far the sensor moves by the poses that the data set itself has; 0 without any.
double moved_m(const Layout& layout, const SequenceFolder& folder, Reading reading) {
  reading.poses = OwnPoses{};
  double most_m = 0.0;
  try {
    const std::unique_ptr<Sequence> sequence = layout.open(folder, reading);
    for (const ScanEntry& scan : sequence->recording().scans) {
      most_m = std::max(most_m, distance_m(scan.map_from_sensor, sequence->map_from_sensor(0)));
    }
  } catch (const DataError&) {  // it may have none
  }
  return most_m;
}

/// Whether something was asked of poses, which others in their place would not have.
bool asks_of_poses(const Reading& asked) {
  return asked.map_frame || asked.pose_topic || asked.pose_frame || asked.pose_direction ||
         asked.pose_format || asked.pose_offset_s != 0.0;
}

std::unique_ptr<Sequence> opened(const Layout& layout, const SequenceFolder& folder,
                                 const Reading& reading) {
  Reading unposed = reading;
  unposed.poses = ByOdometry{};
  if (reading.is_static()) {
    return with_static_poses(layout.open(folder, unposed),
                             "the sensor is taken to stand still: every pose is the identity",
                             moved_m(layout, folder, reading));
  }
  try {
    return layout.open(folder, reading);
  } catch (const MissingPoses& missing) {
    if (missing.of_some || asks_of_poses(reading)) throw;
    std::unique_ptr<Sequence> sequence = layout.open(folder, unposed);
    const StillSensor sensor = find_still_sensor(*sequence);
    if (sensor.stands) return with_static_poses(std::move(sequence), sensor.said);
    if (sensor.said.empty()) throw;
    throw MissingPoses(fmt::format("{}; {}", missing.what(), sensor.said));
  }
}

/// Refuses what was asked of sequences that cannot have it.
void check_asked(const Reading& asked, const Layout& layout,
                 const std::vector<SequenceFolder>& folders) {
  const std::filesystem::path* poses = asked.pose_file();
  std::error_code ignored;
  if (poses != nullptr && folders.size() > 1 && !std::filesystem::is_directory(*poses, ignored)) {
    throw UsageError(
        fmt::format("{} is for one sequence, not for {}, expected one name in {}, or a folder with "
                    "a file for each",
                    option("poses"), joined(folders), option("sequences")));
  }
  if (poses != nullptr && !layout.only_own_poses.empty()) {
    throw UsageError(
        fmt::format("{} is not for {}, {}", option("poses"), layout.name, layout.only_own_poses));
  }
  if (asked.refine_poses && asked.is_by_odometry()) {
    throw UsageError(option("refine_poses") +
                     ": corrects poses that are given, expected it without odometry");
  }
  check_lidars(asked, layout.kind() == DatasetKind::kRecording);
  if (asked.moving_speed_m_s && !layout.truth_by_speed) {
    throw UsageError(fmt::format(
        "{}: the truth of {} is no speed, expected a data set of scene flow, as opensceneflow, or "
        "of boxes, as kitti-raw",
        option("moving_speed_m_s"), layout.name));
  }
}

void check_point_times(const Reading& asked, const Layout& layout, const SequenceFolder& folder) {
  const bool by_column = asked.undistorts() && asked.takes_column();
  if (!by_column || layout.no_point_times == nullptr) return;
  const std::string why = layout.no_point_times(folder.folder);
  if (!why.empty()) throw UsageError(option("point_times", "column") + ": " + why);
}

/// Returns what made a sequence. A data set with a marker of its own alone was simulated before
/// sequences had them, or got recorded ones since: neither may pass for the other.
DataMark mark_of(const Sequence& sequence, const SequenceFolder& folder, const Layout& layout,
                 const std::filesystem::path& root) {
  const Recording& recording = sequence.recording();
  if (recording.is_marked_inside) return recording.mark;
  DataMark mark = recording.mark.is_set() ? recording.mark : mark_in(folder.folder);
  if (!mark.is_set() && !recording.scans.empty() && recording.scans.front().file) {
    mark = mark_of_file(*recording.scans.front().file, layout.scan_folders);
  } else if (!mark.is_set() && !recording.files.empty()) {
    mark = mark_of_file(recording.files.front(), 0);
  }
  if (!mark.simulated && simulated_origin(root)) {
    throw DataError(
        folder.folder,
        fmt::format("has no {0}, but the data set {1} has", kSimulatedMarker, root.string()),
        "one in each simulated sequence: mosbench simulate, called as before, adds it");
  }
  return mark;
}

/// Refuses an offset of stamps that no pose has.
void check_offset(const Sequence& sequence, const Reading& asked) {
  if (asked.pose_offset_s == 0.0 || sequence.reading().poses.offset_s) return;
  throw UsageError(fmt::format(
      "{}: the poses of {} are not looked up by stamps, expected those of a TUM file or a bag",
      option("pose_offset_s"), sequence.name()));
}

/// Throws DataError for a sequence whose poses no sensor can have had.
void check_positions(const Sequence& sequence, const SequenceFolder& folder) {
  const std::vector<ScanEntry>& scans = sequence.recording().scans;
  for (const ScanEntry& scan : scans) {
    const double far_m = distance_m(scan.map_from_sensor, scans.front().map_from_sensor);
    if (far_m <= kFarthestPose_m) continue;
    throw DataError(folder.folder,
                    fmt::format("the pose of scan {} is {:g} m from the first", scan.stem, far_m),
                    fmt::format("at most {:g} m", kFarthestPose_m));
  }
}

/// Takes scans that were lost out of the splits.
void keep_left_scans(Dataset& dataset) {
  for (Split& split : dataset.splits) {
    for (SplitPart& part : split.parts) {
      if (!part.stems) continue;
      std::set<std::string> left;
      for (const ScanEntry& scan : dataset.sequences[part.sequence]->recording().scans) {
        if (part.stems->contains(scan.stem)) left.insert(scan.stem);
      }
      part.stems = std::move(left);
    }
  }
}

std::vector<Split> named_splits(const Layout& layout, const std::vector<SequenceFolder>& folders) {
  std::vector<std::string_view> names;
  for (const NamedSplit& split : layout.named_splits) names.emplace_back(split.name);
  return splits_of_sequences(
      names, folders, [&](std::string_view name, const SequenceFolder& folder) {
        const auto split = std::ranges::find(layout.named_splits, name, &NamedSplit::name);
        return std::ranges::find(split->sequences, folder.name) != split->sequences.end();
      });
}

void perturb(Dataset& dataset, const Reading& reading) {
  if (reading.is_by_odometry() && !changes_points_only(*reading.perturb)) {
    throw UsageError(fmt::format(
        "{0}: changes scans or poses, or needs poses, which odometry has yet to find, expected "
        "kinds that change points only, or mosbench convert {0} first",
        option("perturb")));
  }
  for (std::unique_ptr<Sequence>& sequence : dataset.sequences) {
    sequence = perturbed(std::move(sequence), *reading.perturb);
  }
  keep_left_scans(dataset);
}

void keep_range(Dataset& dataset, const ScanRange& range) {
  for (std::unique_ptr<Sequence>& sequence : dataset.sequences) {
    sequence = with_scan_range(std::move(sequence), range);
  }
  keep_left_scans(dataset);
}

void refine(Dataset& dataset, const Reading& reading, const ScanCount& count) {
  for (std::unique_ptr<Sequence>& sequence : dataset.sequences) {
    const auto deskew =
        deskews_by_refined_poses(reading) ? deskew_of(*sequence, reading) : std::nullopt;
    sequence = with_refined_poses(std::move(sequence), deskew, count);
  }
}

}  // namespace

std::vector<SequenceFolder> find_sequences(const std::filesystem::path& path,
                                           const OpenOptions& options,
                                           std::optional<DatasetKind>& kind) {
  std::vector<std::string> ignored;
  ListedSequences listed = list_sequences(path, options, ignored);
  kind = listed.layout.kind();
  return std::move(listed.folders);
}

Dataset open_dataset(const std::filesystem::path& path, const OpenOptions& options,
                     const ScanCount& refined) {
  Dataset dataset;
  const auto [layout, folders] = list_sequences(path, options, dataset.remarks);
  dataset.kind = layout.kind();
  dataset.root = path;
  check_asked(options.reading, layout, folders);
  for (const SequenceFolder& folder : folders) {
    const Reading reading = reading_of(folder, options.reading);
    check_point_times(reading, layout, folder);
    std::unique_ptr<Sequence> sequence = opened(layout, folder, reading);
    check_offset(*sequence, reading);
    check_positions(*sequence, folder);
    sequence->set_mark(mark_of(*sequence, folder, layout, path));
    if (const auto* poses = reading.pose_file()) {
      for (std::string& doubt : doubts_of_poses(*poses, sequence->mark())) {
        sequence->add_doubt(std::move(doubt));
      }
    }
    dataset.sequences.push_back(std::move(sequence));
  }
  dataset.splits = layout.splits != nullptr
                       ? layout.splits(folders, dataset.sequences, dataset.remarks)
                       : named_splits(layout, folders);
  for (std::unique_ptr<Sequence>& sequence : dataset.sequences) {
    sequence = corrected(std::move(sequence), options.reading);
  }
  if (!options.reading.is_by_odometry()) {
    for (std::unique_ptr<Sequence>& sequence : dataset.sequences) doubt_mounts(*sequence);
  }
  if (options.reading.drop_scans == Drop::kAuto) keep_left_scans(dataset);
  if (options.reading.perturb) perturb(dataset, options.reading);
  if (options.reading.scans) keep_range(dataset, *options.reading.scans);
  if (options.reading.refine_poses) refine(dataset, options.reading, refined);
  return dataset;
}

}  // namespace mosbench
