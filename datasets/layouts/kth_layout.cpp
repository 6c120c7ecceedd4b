#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/kth_sequence.hpp"
#include "datasets/layouts/layout.hpp"

namespace mosbench {
namespace {

std::vector<SequenceFolder> list_kth(const std::filesystem::path& path) {
  return list_with(path, "pcd");
}

std::unique_ptr<Sequence> open_kth(const SequenceFolder& sequence, const Reading&) {
  return std::make_unique<KthSequence>(sequence.name, sequence.folder);
}

std::optional<std::string> recognise_kth(const std::filesystem::path& path) {
  if (any_holds(list_kth(path), "gt_cloud.pcd")) return "pcd/ and gt_cloud.pcd are there";
  return std::nullopt;
}

}  // namespace

const Layout& kth_layout() {
  static const Layout row = {
      .name = "kth",
      .usual = {"kth", "semantickitti-mos"},
      .title = "KTH DynamicMap_Benchmark, ITSC 2023",
      .content = "windows of KITTI, Argoverse 2 and an indoor recording",
      .size = "see its page",
      .published = "github.com/KTH-RPL/DynamicMap_Benchmark, zenodo 10886629",
      .licence = kUnknownLicence,
      .folders = {"<root>/<sequence>/",
                  "  pcd/%06d.pcd   points in the map's frame, pose in VIEWPOINT, intensity 1 is "
                  "dynamic",
                  "  gt_cloud.pcd   read by mosbench score alone; identifies the layout"},
      .files = {.label_ids = {kStaticLabel, kMovingLabel}, .sensor_range_m = 450.0},
      .expected =
          "folders with pcd/*.pcd in the map's frame (KTH DynamicMap_Benchmark), or one such "
          "folder",
      .list = list_kth,
      .open = open_kth,
      .only_own_poses = "whose scans hold their poses in VIEWPOINT",
      .splits = nullptr,
      .evidence = Evidence::kFolders,
      .recognise = recognise_kth,
      .writer = std::nullopt};
  return row;
}

}  // namespace mosbench
