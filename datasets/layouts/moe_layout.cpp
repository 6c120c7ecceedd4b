#include "datasets/formats/label_file.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/kitti_sequence.hpp"
#include "datasets/layouts/layout.hpp"

namespace mosbench {
namespace {

std::vector<SequenceFolder> list_moe(const std::filesystem::path& path) {
  return list_with(path, "pcd");
}

std::unique_ptr<Sequence> open_moe(const SequenceFolder& sequence, const Reading& asked) {
  return std::make_unique<KittiSequence>(
      sequence.name, sequence.folder, asked,
      SequenceLayout{{"pcd", "gt_poses.txt", false}, "label", {".txt"}, read_moe_labels});
}

std::optional<std::string> recognise_moe(const std::filesystem::path& path) {
  if (any_holds(list_moe(path), "gt_poses.txt")) return "pcd/ and gt_poses.txt are there";
  return std::nullopt;
}

}  // namespace

const Layout& moe_layout() {
  static const Layout row = {
      .name = "moe",
      .usual = {"moe", "moe"},
      .title = "MOE",
      .content = "simulators and a real campus, dense with moving objects",
      .size = "10 sequences, 00 to 04 with public labels",
      .published = "releases of github.com/DeepDuke/MOE-Dataset",
      .licence = kUnknownLicence,
      .folders = {"<root>/00 ... 09/", "  pcd/%06d.pcd",
                  "  label/%06d.txt   Moveable_ID Moving_Status Class_ID",
                  "  gt_poses.txt     12 numbers a row, lidar frame"},
      .files = {.label_ids = {kStaticLabel, kMovingLabel}, .sensor_range_m = 450.0},
      .expected = "NN with pcd/*.pcd, label/*.txt and gt_poses.txt (MOE), or one such folder",
      .list = list_moe,
      .open = open_moe,
      .evidence = Evidence::kFolders,
      .recognise = recognise_moe};
  return row;
}

}  // namespace mosbench
