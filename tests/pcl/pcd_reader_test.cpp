#include <gtest/gtest.h>
#include <pcl/PCLPointCloud2.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include <cstring>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "datasets/formats/pcd_file.hpp"
#include "tests/shared_folder.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

/// The same points as PCL reads them; it leaves an intensity that a file lacks as it was, 0.
std::vector<Point> read_by_pcl(const fs::path& file) {
  pcl::PointCloud<pcl::PointXYZI> cloud;
  EXPECT_EQ(pcl::io::loadPCDFile(file.string(), cloud), 0) << file;
  std::vector<Point> points;
  for (const pcl::PointXYZI& point : cloud) {
    points.push_back({point.x, point.y, point.z, point.intensity});
  }
  return points;
}

void expect_the_same(const fs::path& file) {
  const std::vector<Point> ours = read_pcd(file), theirs = read_by_pcl(file);
  ASSERT_EQ(ours.size(), theirs.size()) << file;
  ASSERT_FALSE(ours.empty());
  EXPECT_EQ(std::memcmp(ours.data(), theirs.data(), ours.size() * sizeof(Point)), 0) << file;
}

TEST(PcdReader, EqualsThatOfPclOnRealScans) {
  const fs::path folder = shared_folder() / "real/pcd";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not there";
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".pcd") expect_the_same(entry.path());
  }
}

TEST(PcdReader, EqualsThatOfPclOnWhatPclWrites) {
  std::mt19937 random(7);
  std::normal_distribution<float> coordinate_m(0.0F, 30.0F);
  const TempFolder folder;
  for (const std::size_t count : {1U, 2U, 300U, 20000U}) {
    pcl::PointCloud<pcl::PointXYZI> cloud;
    for (std::size_t i = 0; i < count; ++i) {
      pcl::PointXYZI point;
      point.x = coordinate_m(random);
      point.y = i % 3 == 0 ? 0.0F : coordinate_m(random);  // repeats, which LZF packs
      point.z = i % 50 == 0 ? std::numeric_limits<float>::quiet_NaN() : -1.5F;
      point.intensity = static_cast<float>(i % 256);
      cloud.push_back(point);
    }
    pcl::PCDWriter writer;
    writer.writeASCII((folder / "ascii.pcd").string(), cloud, 9);
    writer.writeBinary((folder / "binary.pcd").string(), cloud);
    writer.writeBinaryCompressed((folder / "packed.pcd").string(), cloud);
    for (const char* file : {"ascii.pcd", "binary.pcd", "packed.pcd"})
      expect_the_same(folder / file);
  }
}

}  // namespace
}  // namespace mosbench
