#include <algorithm>

#include "datasets/formats/scan_file.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/layout.hpp"

namespace mosbench {
namespace {

std::optional<std::string> recognise_semantickitti(const std::filesystem::path& path) {
  const bool has_scans = std::ranges::any_of(list_kitti(path), [](const SequenceFolder& sequence) {
    const auto folder = scan_folder_of(sequence.folder);
    return folder && !scans_in(*folder).empty();
  });
  if (!has_scans) return std::nullopt;
  return "it has the layout and nothing of another data set";
}

std::optional<std::string> recognise_part_of_semantickitti(const std::filesystem::path& path) {
  if (list_kitti(path).empty()) return std::nullopt;
  return "it has the folders and nothing of another data set";
}

// The class ids of semantic-kitti.yaml.
std::uint32_t class_of_mover(const OwnerState& owner) {
  switch (owner.mover) {
    case MoverKind::kPedestrian:
      return owner.moving ? 254 : 30;
    case MoverKind::kCyclist:
      return owner.moving ? 253 : 31;
    case MoverKind::kCar:
      return owner.moving ? 252 : 10;
    case MoverKind::kTruck:
      return owner.moving ? 258 : 18;
  }
  return 0;
}

std::uint32_t class_of(const OwnerState& owner) {
  if (!owner.labelled) return 0;
  switch (owner.substance) {
    case Substance::kGround:
      return 40;
    case Substance::kBuilding:
      return 50;
    case Substance::kPole:
      return 80;
    case Substance::kVegetation:
      return 70;
    case Substance::kMoverBody:
      return class_of_mover(owner);
    case Substance::kDoor:
    case Substance::kBall:
      return owner.moving ? 259 : 99;
  }
  return 0;
}

std::uint32_t simulated_semantickitti_label(const SimulatedReturn& seen) {
  const std::uint32_t id = class_of(seen.owner);
  return is_movable(seen.owner) ? with_instance(id, seen.owner_number) : id;
}

/// KITTI's cameras look along the car: camera x is lidar -y, camera y lidar -z, camera z lidar x.
Pose simulated_camera_from_lidar() {
  Pose tr = Pose::Identity();
  tr.linear() << 0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0;
  tr.translation() << 0.0, -0.08, -0.27;
  return tr;
}

}  // namespace

const Layout& semantickitti_layout() {
  static const Layout row = {
      .name = "semantickitti",
      .usual = {"semantickitti", "semantickitti-mos"},
      .title = "SemanticKITTI-MOS, and data laid out like it",
      .content = "Velodyne HDL-64E on a car",
      .size = "43552 scans in 22 sequences, about 80 GB",
      .published = "semantic-kitti.org",
      .licence = "CC BY-NC-SA 4.0",
      .folders = {"<root>/sequences/00 ... 21/", "  velodyne/%06d.bin",
                  "  labels/%06d.label  for 00 to 10",
                  "  poses.txt          camera frame, turned into the lidar's by Tr of calib.txt",
                  "  calib.txt times.txt"},
      .files = {.label_ids = semantickitti_label_ids(),
                .sensor_range_m = 200.0,
                // Rows of the pose files that the authors of MotionBEV publish.
                .published = {{"00", 4541}, {"01", 1101}, {"02", 4661}, {"03", 801},  {"04", 271},
                              {"05", 2761}, {"06", 1101}, {"07", 1101}, {"08", 4071}, {"09", 1591},
                              {"10", 1201}, {"11", 921},  {"12", 1061}, {"13", 3281}, {"14", 631},
                              {"15", 1901}, {"16", 1731}, {"17", 491},  {"18", 1801}, {"19", 4981},
                              {"20", 831},  {"21", 2721}, {"30", 297},  {"31", 188},  {"32", 430},
                              {"33", 430},  {"34", 390},  {"35", 78},   {"36", 420},  {"37", 936},
                              {"38", 339},  {"39", 279},  {"40", 1170}, {"41", 837}}},
      .expected =
          "sequences/NN or NN with velodyne/, labels/, poses.txt and calib.txt each "
          "(SemanticKITTI), or one such sequence folder",
      .list = list_kitti,
      .open = open_kitti,
      .named_splits = {{"train", {"00", "01", "02", "03", "04", "05", "06", "07", "09", "10"}},
                       {"valid", {"08"}},
                       {"test", {"11", "12", "13", "14", "15", "16", "17", "18", "19", "20", "21"}},
                       // Those of KITTI-Road-MOS in MotionSeg3D's semantic-kitti-mos.yaml.
                       {"road-train", {"30", "31", "32", "33", "34", "40"}},
                       {"road-valid", {"35", "36", "37", "38", "39", "41"}}},
      .evidence = Evidence::kNone,
      .recognise = recognise_semantickitti,
      .recognise_part = recognise_part_of_semantickitti,
      .writer = LayoutWriter{write_as_kitti, kitti_folder, files_of_kitti},
      .related = {{"KITTI-Road-MOS, IROS 2022",
                   "12 of KITTI's raw drives on roads as sequences 30 to 41, 5794 scans, labels 9 "
                   "and 251",
                   "github.com/haomo-ai/MotionSeg3D, config/kitti_road_mos.md",
                   "score --split road-train or road-valid"},
                  {"KITTI tracking 19, RA-L 2023",
                   "one sequence of KITTI's tracking benchmark with labels of points",
                   "github.com/PRBonn/MapMOS", "run or score --protocol mapmos-kitti-tracking"}},
      // The valid split.
      .simulation = LayoutSimulation{
          .recordings = {{"sequences/08", "08", SensorKind::kHdl64e}},
          .label = simulated_semantickitti_label,
          .stamp_ns = [](std::int64_t stamp_ns,
                         std::int64_t first_ns) { return std::optional(stamp_ns - first_ns); },
          .camera_from_lidar = simulated_camera_from_lidar()}};
  return row;
}

}  // namespace mosbench
