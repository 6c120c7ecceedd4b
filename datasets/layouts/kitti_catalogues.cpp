#include "datasets/files/folder_listing.hpp"
#include "datasets/files/scan_file.hpp"
#include "datasets/layouts/catalogue.hpp"
#include "datasets/layouts/kitti_sequence.hpp"

namespace mosbench {
namespace {

/// A numbered folder without scans is listed too, so that opening it says what it lacks.
std::vector<SequenceFolder> list_kitti(const std::filesystem::path& path) {
  if (scan_folder_of(path)) return {{folder_name(path), path, ""}};
  const auto below = path / "sequences";
  std::vector<SequenceFolder> sequences;
  for (const auto& folder : list_folders(std::filesystem::is_directory(below) ? below : path)) {
    const std::string name = folder.filename().string();
    if (scan_folder_of(folder) || stem_number(name)) sequences.push_back({name, folder, ""});
  }
  return sequences;
}

std::unique_ptr<Sequence> open_kitti(const SequenceFolder& sequence,
                                     const ReadingOptions& options) {
  return std::make_unique<KittiSequence>(sequence.name, sequence.folder, options);
}

std::vector<Split> semantickitti_splits(const std::vector<SequenceFolder>& folders,
                                        const std::vector<std::unique_ptr<Sequence>>&,
                                        std::vector<std::string>&) {
  return splits_of_names(
      {{"train", {"00", "01", "02", "03", "04", "05", "06", "07", "09", "10"}},
       {"valid", {"08"}},
       {"test", {"11", "12", "13", "14", "15", "16", "17", "18", "19", "20", "21"}}},
      folders);
}

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

std::optional<std::string> recognise_semantickitti(const std::filesystem::path& path) {
  if (list_kitti(path).empty()) return std::nullopt;
  return "it has the layout and nothing of another data set";
}

}  // namespace

const Catalogue& sipailou_catalogue() {
  static const Catalogue catalogue = {
      DatasetKind::kSipailou,
      "sequences/00 to 07 with velodyne/, labels/, poses.txt and calib.txt each (Sipailou Campus), "
      "or one such sequence folder",
      list_kitti,
      open_kitti,
      sipailou_splits,
      recognise_sipailou};
  return catalogue;
}

const Catalogue& semantickitti_catalogue() {
  static const Catalogue catalogue = {DatasetKind::kSemanticKitti,
                                      "sequences/NN or NN with velodyne/, labels/, poses.txt and "
                                      "calib.txt each (SemanticKITTI), or "
                                      "one such sequence folder",
                                      list_kitti,
                                      open_kitti,
                                      semantickitti_splits,
                                      recognise_semantickitti};
  return catalogue;
}

}  // namespace mosbench
