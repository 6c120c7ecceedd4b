#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/layout.hpp"

namespace mosbench {
namespace {

std::vector<Split> sipailou_splits(const std::vector<SequenceFolder>& folders,
                                   const std::vector<std::unique_ptr<Sequence>>&,
                                   std::vector<std::string>&) {
  return splits_of_names(
      {{"train", {"01", "02", "03", "04", "05"}}, {"valid", {"06"}}, {"test", {"00", "07"}}},
      folders);
}

std::optional<std::string> recognise_sipailou(const std::filesystem::path& path) {
  const auto named = folder_with_word(path, {"sipailou"});
  if (!named || list_kitti(path).empty()) return std::nullopt;
  return "\"sipailou\" is in the folder name " + *named;
}

}  // namespace

const Layout& sipailou_layout() {
  static const Layout row = {
      .kind = DatasetKind::kSipailou,
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
      .splits = sipailou_splits,
      .evidence = Evidence::kName,
      .recognise = recognise_sipailou,
      .writer = LayoutWriter{write_as_kitti, kitti_folder}};
  return row;
}

}  // namespace mosbench
