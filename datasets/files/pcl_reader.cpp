#include "datasets/files/pcl_reader.hpp"

#include <dlfcn.h>

#include <string>
#include <system_error>
#include <utility>

#include "datasets/files/errors.hpp"

namespace mosbench {
namespace {

struct PclModule {
  UnpackPcd* unpack = nullptr;
  std::string error = "it is in none of its folders";
};

PclModule open_pcl_module() {
  std::error_code ignored;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  PclModule opened;
  for (const std::filesystem::path& folder : {program.parent_path() / MOSBENCH_MODULES_FROM_PROGRAM,
                                              std::filesystem::path(MOSBENCH_MODULES_INSTALLED),
                                              std::filesystem::path(MOSBENCH_MODULES_BUILT)}) {
    const auto file = folder / kPclModule;
    if (!file.is_absolute() || !std::filesystem::exists(file, ignored)) continue;
    void* module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    void* function = module == nullptr ? nullptr : dlsym(module, kPclModuleFunction);
    opened.unpack = reinterpret_cast<UnpackPcd*>(function);
    if (opened.unpack != nullptr) return opened;
    opened.error = dlerror();
  }
  return opened;
}

/// Loads PCL when the first .pcd file is read: with all its libraries it would cost every start of
/// the program 22 MB and 30 ms.
UnpackPcd* pcl_function(const std::filesystem::path& file) {
  static const PclModule module = open_pcl_module();
  if (module.unpack != nullptr) return module.unpack;
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
