#include "datasets/formats/point_range.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/layout.hpp"

namespace mosbench {
namespace {

std::optional<std::string> recognise_sipailou(const std::filesystem::path& path) {
  const auto named = folder_with_word(path, {"sipailou"});
  if (!named || list_kitti(path).empty()) return std::nullopt;
  return "\"sipailou\" is in the folder name " + *named;
}

/// 9, 251 or for vehicles 252 within 3 and 50 m, else 0.
std::uint32_t simulated_sipailou_label(const SimulatedReturn& seen) {
  constexpr double kNearest_m = 3.0, kFarthest_m = 50.0;
  constexpr std::uint32_t kMovingVehicle = 252;
  const double distance_m = range_m(seen.point);
  if (distance_m < kNearest_m || distance_m > kFarthest_m) return 0;
  const OwnerState& owner = seen.owner;
  const bool is_vehicle = owner.substance == Substance::kMoverBody &&
                          (owner.mover == MoverKind::kCar || owner.mover == MoverKind::kTruck);
  const std::uint32_t label = moving_label(seen);
  return label == kMovingLabel && is_vehicle ? kMovingVehicle : label;
}

}  // namespace

const Layout& sipailou_layout() {
  static const Layout row = {
      .name = "sipailou",
      .usual = {"sipailou", "sipailou"},
      .title = "Sipailou Campus, of MotionBEV, RA-L 2023",
      .content = "Livox Avia on a ground robot, every scan labelled between 3 and 50 m",
      .size = "8 sequences, 06: 3191 scans, 00 and 07: 6201 scans",
      .published = "github.com/xieKKKi/MotionBEV",
      .licence = kUnknownLicence,
      .folders = {"<root>/sequences/00 ... 07/", "  velodyne/%06d.bin", "  labels/%06d.label",
                  "  poses.txt", "  calib.txt"},
      .files = {.label_ids = {0, 9, 251, 252},
                .sensor_range_m = 450.0,
                .label_min_m = 3.0,
                .label_max_m = 50.0,
                // Output of MotionBEV's evaluator.
                .published = {{"06", 3191}}},
      .expected =
          "sequences/00 to 07 with velodyne/, labels/, poses.txt and calib.txt each "
          "(Sipailou Campus), or one such sequence folder",
      .list = list_kitti,
      .open = open_kitti,
      .named_splits = {{"train", {"01", "02", "03", "04", "05"}},
                       {"valid", {"06"}},
                       {"test", {"00", "07"}}},
      .evidence = Evidence::kName,
      .recognise = recognise_sipailou,
      .writer = LayoutWriter{write_as_kitti, kitti_folder, files_of_kitti},
      // The valid split.
      .simulation = LayoutSimulation{.recordings = {{"sequences/06", "06", SensorKind::kAvia}},
                                     .label = simulated_sipailou_label,
                                     .stamp_ns = no_stamp}};
  return row;
}

}  // namespace mosbench
