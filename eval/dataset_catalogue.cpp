#include "eval/dataset_catalogue.hpp"

#include <array>

namespace mosbench {
namespace {

constexpr std::array<std::string_view, 5> kDoalsFolders = {
    "<root>/{hauptgebaeude,niederdorf,shopville,station}/sequence_{1,2}/",
    "  velodyne/*.bin (or binFiles/)  scans exported from the bag: x y z intensity float32,",
    "                                 all 131072 points in firing order, none dropped",
    "  indices.csv                    stamp in ns, then the moving points of a labelled scan",
    "  poses.txt                      12 numbers a row, lidar frame"};

constexpr std::array<std::string_view, 5> kSipailouFolders = {
    "<root>/sequences/00 ... 07/", "  velodyne/%06d.bin", "  labels/%06d.label", "  poses.txt",
    "  calib.txt"};

constexpr std::array<std::string_view, 6> kHelimosFolders = {
    "<root>/ (KAIST05/Deskewed_LiDAR of the download)",
    "  train.txt val.txt test.txt     scan numbers of the splits",
    "  {Aeva,Avia,Ouster,Velodyne}/velodyne/%06d.bin",
    "  {Aeva,Avia,Ouster,Velodyne}/labels/%06d.label   for part of the scans",
    "  {Aeva,Avia,Ouster,Velodyne}/poses.txt           the HMM-MOS authors publish theirs",
    "  {Aeva,Avia,Ouster,Velodyne}/calib.txt"};

constexpr std::array<std::string_view, 5> kSemanticKittiFolders = {
    "<root>/sequences/00 ... 21/", "  velodyne/%06d.bin", "  labels/%06d.label  for 00 to 10",
    "  poses.txt          camera frame, turned into the lidar's by Tr of calib.txt",
    "  calib.txt times.txt"};

}  // namespace

std::span<const CataloguedDataset> catalogued_datasets() {
  static const std::array kCatalogue = {
      CataloguedDataset{DatasetKind::kDoals, "Urban Dynamic Objects LiDAR, ICRA 2021",
                        "hand-held Ouster OS1-64 in 4 places, 10 labelled scans in each of 8 "
                        "sequences",
                        "12825 scans, 8 bags", "DOI 10.3929/ethz-c-000788171", "see its page",
                        kDoalsFolders},
      CataloguedDataset{DatasetKind::kSipailou, "Sipailou Campus, of MotionBEV, RA-L 2023",
                        "Livox Avia on a ground robot, every scan labelled between 3 and 50 m",
                        "8 sequences, 06: 3191 scans, 00 and 07: 6201 scans",
                        "github.com/xieKKKi/MotionBEV", "see its page", kSipailouFolders},
      CataloguedDataset{DatasetKind::kHelimos, "HeLiMOS, IROS 2024",
                        "Aeva, Livox Avia, Ouster OS2-128 and Velodyne VLP-16 on one car",
                        "about 35 GB zipped, some 12476 scans per sensor",
                        "github.com/url-kaist/HeLiMOS-PointCloud-Toolbox", "see its page",
                        kHelimosFolders},
      CataloguedDataset{DatasetKind::kSemanticKitti, "SemanticKITTI-MOS, and data laid out like it",
                        "Velodyne HDL-64E on a car", "43552 scans in 22 sequences, about 80 GB",
                        "semantic-kitti.org", "CC BY-NC-SA 4.0", kSemanticKittiFolders},
  };
  return kCatalogue;
}

}  // namespace mosbench
