#include "datasets/formats/pcl_reader.hpp"

#include <string>

#include "datasets/disk/loaded_module.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

/// Loads PCL when the first .pcd file is read: it has 22 MB of libraries.
UnpackPcd* pcl_function(const std::filesystem::path& file) {
  static const ModuleFunction module = load_function(kPclModule, kPclModuleFunction);
  if (module.function != nullptr) return reinterpret_cast<UnpackPcd*>(module.function);
  throw DataError(file,
                  std::string("cannot be read without ") + kPclModule + " (" + module.error + ")",
                  "the module where mosbench was built or installed, and Debian's PCL libraries");
}

}  // namespace

bool reads_pcd() { return true; }

PclCloud unpack_pcd(std::string_view bytes, const PcdHeader& header,
                    const std::filesystem::path& file) {
  PclCloud cloud;
  std::string error = pcl_function(file)(bytes, header.body_offset_bytes, cloud);
  if (error.empty()) {
    const std::size_t step_bytes = cloud.head.point_step_bytes;
    if (step_bytes > 0 && cloud.records.size() / step_bytes >= header.points) return cloud;
    error = "less than the points of its header";
  }
  throw DataError(file, "cannot be read as a point cloud (" + error + ")",
                  "a PCD file, version 0.7, with fields x y z [intensity]");
}

}  // namespace mosbench
