#pragma once

/// Point clouds of PCL as the points of mosbench, and labels back into them. This header is for
/// programs that use PCL anyway; nothing else of mosbench needs it.

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cstddef>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace mosbench {

/// A point type of PCL with coordinates, as pcl::PointXYZ, PointXYZI, PointXYZL, PointNormal.
template <typename T>
concept PclPoint = requires(const T& point) {
  static_cast<float>(point.x);
  static_cast<float>(point.y);
  static_cast<float>(point.z);
};

/// Returns the points of `cloud`, in metres in the sensor's frame, in their order and none dropped:
/// not a number stays so. Intensity is 0 where T has none.
template <PclPoint T>
std::vector<Point> from_pcl(const pcl::PointCloud<T>& cloud) {
  std::vector<Point> points;
  points.reserve(cloud.size());
  for (const T& point : cloud) {
    float intensity = 0.0F;
    if constexpr (requires { point.intensity; }) intensity = static_cast<float>(point.intensity);
    points.push_back({static_cast<float>(point.x), static_cast<float>(point.y),
                      static_cast<float>(point.z), intensity});
  }
  return points;
}

/// Writes one label per point into the field `label` of T. Throws std::invalid_argument for another
/// number of labels than points.
template <PclPoint T>
requires requires(T& point, std::uint32_t label) { point.label = label; }
void set_labels(std::span<const std::uint32_t> labels, pcl::PointCloud<T>& cloud) {
  if (labels.size() != cloud.size()) {
    throw std::invalid_argument(std::to_string(labels.size()) +
                                " labels, expected one for each of " +
                                std::to_string(cloud.size()) + " points");
  }
  for (std::size_t i = 0; i < labels.size(); ++i) cloud[i].label = labels[i];
}

/// Returns `cloud` with a label for each point; header, width, height and sensor pose stay. Throws
/// as `set_labels`.
template <PclPoint T>
pcl::PointCloud<pcl::PointXYZL> labelled_cloud(const pcl::PointCloud<T>& cloud,
                                               std::span<const std::uint32_t> labels) {
  pcl::PointCloud<pcl::PointXYZL> labelled;
  labelled.resize(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    labelled[i].x = static_cast<float>(cloud[i].x);
    labelled[i].y = static_cast<float>(cloud[i].y);
    labelled[i].z = static_cast<float>(cloud[i].z);
  }
  set_labels(labels, labelled);
  labelled.header = cloud.header;
  labelled.width = cloud.width;
  labelled.height = cloud.height;
  labelled.is_dense = cloud.is_dense;
  labelled.sensor_origin_ = cloud.sensor_origin_;
  labelled.sensor_orientation_ = cloud.sensor_orientation_;
  return labelled;
}

}  // namespace mosbench
