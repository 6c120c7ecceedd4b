#include "eval/cli/dataset_catalogue.hpp"

#include <array>

namespace mosbench {
namespace {

constexpr std::string_view kUnknownLicence = "not known to mosbench, see where it is published";

constexpr std::array<std::string_view, 6> kDoalsFolders = {
    "<root>/{hauptgebaeude,niederdorf,shopville,station}/sequence_{1,2}/",
    "  *.bag                          as published: /os1_cloud_node/points and /tf",
    "  indices.csv                    stamp in ns, then the moving points of a labelled scan",
    "or instead of the bag",
    "  velodyne/*.bin (or binFiles/)  x y z intensity float32, all 131072 points in firing order",
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

constexpr std::array<std::string_view, 5> kApolloFolders = {
    "<root>/sequences/00, 03, .../ (of LiDAR-MOS.zip)", "  velodyne/%06d.bin",
    "  labels/%06d.label", "  velodyne_poses_kitti.txt   lidar frame, or",
    "  poses.txt and calib.txt    camera frame"};

constexpr std::array<std::string_view, 4> kMoeFolders = {
    "<root>/00 ... 09/", "  pcd/%06d.pcd", "  label/%06d.txt   Moveable_ID Moving_Status Class_ID",
    "  gt_poses.txt     12 numbers a row, lidar frame"};

constexpr std::array<std::string_view, 3> kKthFolders = {
    "<root>/<sequence>/",
    "  pcd/%06d.pcd   points in the map's frame, pose in VIEWPOINT, intensity 1 is dynamic",
    "  gt_cloud.pcd   not read, but tells the layout"};

constexpr std::array<std::string_view, 4> kMdetectorFolders = {
    "<root>/sequences/0000/, M-detector in some folder's name",
    "  velodyne/*.bin   scans exported from its bag (mosbench convert)",
    "  labels/*.label   int32, 251 and above dynamic, 65535 ignored", "  poses.txt"};

}  // namespace

std::span<const CataloguedDataset> catalogued_datasets() {
  static const std::array kCatalogue = {
      CataloguedDataset{DatasetKind::kDoals, "Urban Dynamic Objects LiDAR, ICRA 2021",
                        "hand-held Ouster OS1-64 in 4 places, 10 labelled scans in each of 8 "
                        "sequences",
                        "12825 scans, 8 bags", "DOI 10.3929/ethz-c-000788171", kUnknownLicence,
                        kDoalsFolders},
      CataloguedDataset{DatasetKind::kSipailou, "Sipailou Campus, of MotionBEV, RA-L 2023",
                        "Livox Avia on a ground robot, every scan labelled between 3 and 50 m",
                        "8 sequences, 06: 3191 scans, 00 and 07: 6201 scans",
                        "github.com/xieKKKi/MotionBEV", kUnknownLicence, kSipailouFolders},
      CataloguedDataset{DatasetKind::kHelimos, "HeLiMOS, IROS 2024",
                        "Aeva, Livox Avia, Ouster OS2-128 and Velodyne VLP-16 on one car",
                        "about 35 GB zipped, some 12476 scans per sensor",
                        "github.com/url-kaist/HeLiMOS-PointCloud-Toolbox",
                        "CC BY-NC-SA 4.0 for the HeLiPR data it is made of", kHelimosFolders},
      CataloguedDataset{DatasetKind::kSemanticKitti, "SemanticKITTI-MOS, and data laid out like it",
                        "Velodyne HDL-64E on a car", "43552 scans in 22 sequences, about 80 GB",
                        "semantic-kitti.org", "CC BY-NC-SA 4.0", kSemanticKittiFolders},
      CataloguedDataset{DatasetKind::kApollo, "Apollo, labelled by the authors of 4DMOS",
                        "Velodyne HDL-64E on a car",
                        "00: 2000 scans and 03: 500 scans in the HMM-MOS paper's program",
                        "LiDAR-MOS.zip of ipb.uni-bonn.de", kUnknownLicence, kApolloFolders},
      CataloguedDataset{
          DatasetKind::kMoe, "MOE", "simulators and a real campus, dense with moving objects",
          "10 sequences, 00 to 04 with public labels",
          "releases of github.com/DeepDuke/MOE-Dataset", kUnknownLicence, kMoeFolders},
      CataloguedDataset{DatasetKind::kKth, "KTH DynamicMap_Benchmark, ITSC 2023",
                        "windows of KITTI, Argoverse 2 and an indoor recording", "see its page",
                        "github.com/KTH-RPL/DynamicMap_Benchmark, zenodo 10886629", kUnknownLicence,
                        kKthFolders},
      CataloguedDataset{DatasetKind::kMdetector, "M-detector's sets, Nature Communications 2024",
                        "Livox Avia, KITTI, nuScenes and Waymo",
                        "45, 20, 10 and 44 sequences, scans in bags",
                        "github.com/hku-mars/M-detector", kUnknownLicence, kMdetectorFolders},
  };
  return kCatalogue;
}

}  // namespace mosbench
