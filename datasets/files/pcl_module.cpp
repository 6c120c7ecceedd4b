#include "datasets/files/pcl_module.hpp"

#include <pcl/PCLPointCloud2.h>
#include <pcl/PCLPointField.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>

#include <exception>

namespace mosbench {
namespace {

static_assert(pcl::PCLPointField::INT8 == 1 && pcl::PCLPointField::FLOAT64 == 8);

std::string read_cloud(const char* file, RawCloud& cloud) {
  // PCL would report every bad file on the console as well.
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  pcl::PCLPointCloud2 read;
  if (pcl::PCDReader().read(file, read) < 0) return "PCL does not read it";
  for (const pcl::PCLPointField& field : read.fields) {
    cloud.fields.push_back({field.name, field.offset, field.datatype, field.count});
  }
  cloud.bytes = std::move(read.data);
  cloud.point_step_bytes = read.point_step;
  return "";
}

}  // namespace
}  // namespace mosbench

// The C name is what dlsym finds; both sides are of one build, so C++ types may pass.
extern "C" __attribute__((visibility("default"))) std::string mosbench_read_pcd_cloud(
    const char* file, mosbench::RawCloud& cloud) {
  try {
    return mosbench::read_cloud(file, cloud);
  } catch (const std::exception& error) {
    return error.what();
  }
}
