// Labels clouds of PCL: a wall 10 m away, and 5 m away a box that moves by 0.5 m from scan to scan.
// Prints how many points of each cloud are labelled as moving.

#include <cstdio>
#include <memory>
#include <mosbench/method.hpp>
#include <mosbench/pcl.hpp>

namespace {

pcl::PointCloud<pcl::PointXYZI> scan_of_wall_and_box(int scan_index) {
  pcl::PointCloud<pcl::PointXYZI> cloud;
  const auto add = [&](float x, float y, float z) {
    pcl::PointXYZI point;
    point.x = x;
    point.y = y;
    point.z = z;
    cloud.push_back(point);
  };
  const float box_y_m = 0.5F * static_cast<float>(scan_index) - 5.0F;
  for (int column = -100; column < 100; ++column) {
    for (int row = -30; row < 30; ++row) {
      const float y_m = 0.1F * static_cast<float>(column), z_m = 0.1F * static_cast<float>(row);
      const bool behind_box =
          y_m > 2 * box_y_m && y_m < 2 * (box_y_m + 1.0F) && row > -10 && row < 10;
      if (!behind_box) add(10.0F, y_m, z_m);
      if (behind_box) add(5.0F, y_m / 2, z_m / 2);
    }
  }
  return cloud;
}

}  // namespace

int main() {
  const mosbench::MethodKind& kind = *mosbench::find_method("hmm-mos");
  const std::unique_ptr<mosbench::Method> method = kind.make(kind.defaults, {});
  for (int scan_index = 0; scan_index < 20; ++scan_index) {
    const pcl::PointCloud<pcl::PointXYZI> cloud = scan_of_wall_and_box(scan_index);
    const auto labelled = method->push(mosbench::from_pcl(cloud), mosbench::Pose::Identity());
    for (const auto& scan : labelled) {
      const pcl::PointCloud<pcl::PointXYZL> labels = mosbench::labelled_cloud(cloud, scan.labels);
      std::size_t moving = 0;
      for (const pcl::PointXYZL& point : labels) moving += point.label == mosbench::kMovingLabel;
      std::printf("scan %d: %zu of %zu points move\n", scan_index, moving, labels.size());
    }
  }
}
