#include "datasets/layouts/nuscenes_sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

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

}  // namespace

NuscenesSequence::NuscenesSequence(std::string name, const std::filesystem::path& tables,
                                   const Reading& asked)
    : tables_(read_nuscenes_tables(tables)) {
  mutable_recording().name = SequenceName(name, tables);
  list_scans(parent_folder(tables), scene_named(*tables_, name, tables));
  say_what_is_read(tables);
  take_poses(tables, asked);
}

void NuscenesSequence::list_scans(const std::filesystem::path& root, const NuscenesScene& scene) {
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
    mutable_recording().remarks.push_back(fmt::format(
        "left out {} on the disk", counted(absent, "sweep of sample_data.json that is not",
                                           "sweeps of sample_data.json that are not")));
  }
}

void NuscenesSequence::say_what_is_read(const std::filesystem::path& folder) {
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

void NuscenesSequence::take_poses(const std::filesystem::path& folder, const Reading& asked) {
  Recording& recording = mutable_recording();
  if (asked.has_own_poses()) {
    SensorPoses own =
        own_poses("ego_pose.json and calibrated_sensor.json", folder / "ego_pose.json");
    for (const NuscenesScan* scan : scans_) own.map_from_sensor.emplace_back(scan->map_from_sensor);
    place_scans(std::move(own), recording);
    return;
  }
  const std::vector<const NuscenesScan*> rows = std::exchange(scans_, {});
  for (const std::size_t k : place_scans(folder, "", asked, recording)) scans_.push_back(rows[k]);
}

void NuscenesSequence::read(std::size_t scan_index, Frame& frame) const {
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

std::vector<std::uint32_t> NuscenesSequence::read_truth(std::size_t scan_index) const {
  if (!has_truth(scan_index)) refuse_truth(scan_index);
  Frame frame;
  read(scan_index, frame);
  return std::move(*frame.truth);
}

}  // namespace mosbench
