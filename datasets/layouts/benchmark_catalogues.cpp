#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/files/folder_listing.hpp"
#include "datasets/files/moe_labels.hpp"
#include "datasets/files/scan_file.hpp"
#include "datasets/layouts/catalogue.hpp"
#include "datasets/layouts/kitti_sequence.hpp"
#include "datasets/layouts/kth_sequence.hpp"

namespace mosbench {
namespace {

constexpr const char* kApolloPoses = "velodyne_poses_kitti.txt";

/// Folders with `mark` in them: `path` itself, else those below it or below its sequences/.
std::vector<SequenceFolder> list_with(const std::filesystem::path& path,
                                      const std::filesystem::path& mark) {
  if (is_there(path / mark)) return {{folder_name(path), path, ""}};
  const auto below = path / "sequences";
  std::vector<SequenceFolder> sequences;
  for (const auto& folder : list_folders(std::filesystem::is_directory(below) ? below : path)) {
    if (is_there(folder / mark)) sequences.push_back({folder.filename().string(), folder, ""});
  }
  return sequences;
}

std::vector<SequenceFolder> list_pcd(const std::filesystem::path& path) {
  return list_with(path, "pcd");
}

std::vector<SequenceFolder> list_velodyne(const std::filesystem::path& path) {
  return list_with(path, "velodyne");
}

bool any_holds(const std::vector<SequenceFolder>& sequences, const char* file) {
  for (const SequenceFolder& sequence : sequences) {
    if (is_there(sequence.folder / file)) return true;
  }
  return false;
}

std::unique_ptr<Sequence> open_apollo(const SequenceFolder& sequence,
                                      const ReadingOptions& options) {
  SequenceLayout layout;
  if (is_there(sequence.folder / kApolloPoses)) {
    layout.folder.poses_file = kApolloPoses;
    layout.folder.poses_of_lidar = true;
  }
  return std::make_unique<KittiSequence>(sequence.name, sequence.folder, options, layout);
}

std::unique_ptr<Sequence> open_mdetector(const SequenceFolder& sequence,
                                         const ReadingOptions& options) {
  return std::make_unique<KittiSequence>(sequence.name, sequence.folder, options);
}

std::unique_ptr<Sequence> open_moe(const SequenceFolder& sequence, const ReadingOptions& options) {
  return std::make_unique<KittiSequence>(
      sequence.name, sequence.folder, options,
      SequenceLayout{{"pcd", "gt_poses.txt", false}, "label", ".txt", read_moe_labels, nullptr});
}

std::unique_ptr<Sequence> open_kth(const SequenceFolder& sequence, const ReadingOptions& options) {
  if (options.poses) {
    throw UsageError("--poses is not for kth, whose scans hold their poses in VIEWPOINT");
  }
  return std::make_unique<KthSequence>(sequence.name, sequence.folder);
}

std::vector<Split> no_splits(const std::vector<SequenceFolder>&,
                             const std::vector<std::unique_ptr<Sequence>>&,
                             std::vector<std::string>&) {
  return {};
}

std::optional<std::string> recognise_apollo(const std::filesystem::path& path) {
  if (any_holds(list_velodyne(path), kApolloPoses)) return std::string(kApolloPoses) + " is there";
  return std::nullopt;
}

std::optional<std::string> recognise_moe(const std::filesystem::path& path) {
  if (any_holds(list_pcd(path), "gt_poses.txt")) return "pcd/ and gt_poses.txt are there";
  return std::nullopt;
}

std::optional<std::string> recognise_kth(const std::filesystem::path& path) {
  if (any_holds(list_pcd(path), "gt_cloud.pcd")) return "pcd/ and gt_cloud.pcd are there";
  return std::nullopt;
}

std::optional<std::string> recognise_mdetector(const std::filesystem::path& path) {
  if (!folder_with_word(path, {"m-detector", "m_detector", "mdetector"}) ||
      list_velodyne(path).empty()) {
    return std::nullopt;
  }
  return "M-detector is in the folder name";
}

}  // namespace

const Catalogue& apollo_catalogue() {
  static const Catalogue catalogue = {DatasetKind::kApollo,
                                      "sequences/NN with velodyne/, labels/ and "
                                      "velodyne_poses_kitti.txt or poses.txt and calib.txt "
                                      "(Apollo of LiDAR-MOS), or one such folder",
                                      list_velodyne,
                                      open_apollo,
                                      no_splits,
                                      recognise_apollo};
  return catalogue;
}

const Catalogue& moe_catalogue() {
  static const Catalogue catalogue = {
      DatasetKind::kMoe,
      "NN with pcd/*.pcd, label/*.txt and gt_poses.txt (MOE), or one such folder",
      list_pcd,
      open_moe,
      no_splits,
      recognise_moe};
  return catalogue;
}

const Catalogue& kth_catalogue() {
  static const Catalogue catalogue = {
      DatasetKind::kKth,
      "folders with pcd/*.pcd in the map's frame (KTH DynamicMap_Benchmark), or one such folder",
      list_pcd,
      open_kth,
      no_splits,
      recognise_kth};
  return catalogue;
}

const Catalogue& mdetector_catalogue() {
  static const Catalogue catalogue = {
      DatasetKind::kMdetector,
      "sequences/NNNN with velodyne/ (exported from the bags), labels/ and poses.txt (M-detector), "
      "or one such folder",
      list_velodyne,
      open_mdetector,
      no_splits,
      recognise_mdetector};
  return catalogue;
}

}  // namespace mosbench
