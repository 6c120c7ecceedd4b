#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <mosbench/pcl.hpp>

namespace mosbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

pcl::PointCloud<pcl::PointXYZI> two_points() {
  pcl::PointCloud<pcl::PointXYZI> cloud;
  cloud.resize(2);
  cloud[0].x = 1.0F;
  cloud[0].y = 2.0F;
  cloud[0].z = 3.0F;
  cloud[0].intensity = 4.0F;
  cloud[1].x = std::numeric_limits<float>::quiet_NaN();
  cloud.width = 1;
  cloud.height = 2;
  cloud.is_dense = false;
  cloud.header.stamp = 17;
  cloud.header.frame_id = "lidar";
  return cloud;
}

TEST(PclPoints, KeepOrderCountAndIntensity) {
  const std::vector<Point> points = from_pcl(two_points());
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].x, 1.0F);
  EXPECT_EQ(points[0].y, 2.0F);
  EXPECT_EQ(points[0].z, 3.0F);
  EXPECT_EQ(points[0].intensity, 4.0F);
  EXPECT_TRUE(std::isnan(points[1].x));
}

TEST(PclPoints, WithoutIntensityHaveZero) {
  pcl::PointCloud<pcl::PointXYZ> cloud;
  cloud.push_back({5.0F, 6.0F, 7.0F});
  const std::vector<Point> points = from_pcl(cloud);
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0].z, 7.0F);
  EXPECT_EQ(points[0].intensity, 0.0F);
  EXPECT_TRUE(from_pcl(pcl::PointCloud<pcl::PointXYZ>()).empty());
}

TEST(PclPoints, GetTheirLabelsInTheirOrder) {
  const pcl::PointCloud<pcl::PointXYZI> cloud = two_points();
  const std::vector<std::uint32_t> labels = {kMovingLabel, kStaticLabel};
  const pcl::PointCloud<pcl::PointXYZL> labelled = labelled_cloud(cloud, labels);
  ASSERT_EQ(labelled.size(), 2U);
  EXPECT_EQ(labelled[0].label, kMovingLabel);
  EXPECT_EQ(labelled[1].label, kStaticLabel);
  EXPECT_EQ(labelled[0].y, 2.0F);
  EXPECT_TRUE(std::isnan(labelled[1].x));
  EXPECT_EQ(labelled.width, 1U);
  EXPECT_EQ(labelled.height, 2U);
  EXPECT_FALSE(labelled.is_dense);
  EXPECT_EQ(labelled.header.stamp, 17U);
  EXPECT_EQ(labelled.header.frame_id, "lidar");
}

TEST(PclPoints, TakeNoOtherNumberOfLabels) {
  pcl::PointCloud<pcl::PointXYZL> cloud;
  cloud.resize(2);
  const std::vector<std::uint32_t> labels = {kMovingLabel, kStaticLabel, kStaticLabel};
  EXPECT_THAT(
      [&] { set_labels(labels, cloud); },
      ThrowsMessage<std::invalid_argument>(HasSubstr("3 labels, expected one for each of 2")));
  set_labels(std::span(labels).first(2), cloud);
  EXPECT_EQ(cloud[0].label, kMovingLabel);
  EXPECT_THROW(labelled_cloud(two_points(), labels), std::invalid_argument);
}

}  // namespace
}  // namespace mosbench
