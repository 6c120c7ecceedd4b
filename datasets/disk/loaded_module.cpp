#include "datasets/disk/loaded_module.hpp"

#include <dlfcn.h>

#include <filesystem>
#include <system_error>

namespace mosbench {

ModuleFunction load_function(const char* module, const char* function) {
  std::error_code ignored;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  ModuleFunction loaded;
  for (const std::filesystem::path& folder : {program.parent_path() / MOSBENCH_MODULES_FROM_PROGRAM,
                                              std::filesystem::path(MOSBENCH_MODULES_INSTALLED),
                                              std::filesystem::path(MOSBENCH_MODULES_BUILT)}) {
    const auto file = folder / module;
    if (!file.is_absolute() || !std::filesystem::exists(file, ignored)) continue;
    void* opened = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    loaded.function = opened == nullptr ? nullptr : dlsym(opened, function);
    if (loaded.function != nullptr) return loaded;
    loaded.error = dlerror();
  }
  return loaded;
}

}  // namespace mosbench
