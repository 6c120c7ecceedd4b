#include <dlfcn.h>

#include <filesystem>
#include <system_error>

#include "datasets/hdf5/hdf5_module.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

/// A function of a module of the program, or why there is none.
struct ModuleFunction {
  void* function = nullptr;
  std::string error = "it is in none of its folders";
};

/// Where this code lies: the program, or the library of the Python package.
std::filesystem::path own_folder() {
  static const char kAddress = 0;
  Dl_info found{};
  if (dladdr(&kAddress, &found) == 0) return {};
  return std::filesystem::path(found.dli_fname).parent_path();
}

/// Loads a module (a shared library beside the program, of the same build) when it is first needed:
/// with all its libraries libhdf5 would cost every start of the program milliseconds. Looks in
/// four folders: beside this code, where a wheel has it, relative to the installed program, in the
/// build tree, and in the installation prefix.
ModuleFunction load_function(const char* module, const char* function) {
  std::error_code ignored;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  ModuleFunction loaded;
  for (const std::filesystem::path& folder :
       {own_folder(), program.parent_path() / MOSBENCH_MODULES_FROM_PROGRAM,
        std::filesystem::path(MOSBENCH_MODULES_BUILT),
        std::filesystem::path(MOSBENCH_MODULES_INSTALLED)}) {
    const auto file = folder / module;
    if (!file.is_absolute() || !std::filesystem::exists(file, ignored)) continue;
    void* opened = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    loaded.function = opened == nullptr ? nullptr : dlsym(opened, function);
    if (loaded.function != nullptr) return loaded;
    loaded.error = opened == nullptr ? dlerror() : file.string() + " is of another mosbench";
  }
  return loaded;
}

}  // namespace

bool has_hdf5() { return true; }

const Hdf5Functions& hdf5_functions(const std::string& file) {
  static const ModuleFunction module = load_function(kHdf5Module, kHdf5ModuleFunction);
  if (module.function != nullptr) {
    return *reinterpret_cast<const Hdf5Functions* (*)()>(module.function)();
  }
  throw DataError(file,
                  std::string("cannot be used without ") + kHdf5Module + " (" + module.error + ")",
                  "it there: `apt-get install` the package mosbench-hdf5 of the same build, or run "
                  "`cmake --install` again");
}

}  // namespace mosbench
