#include "datasets/disk/loaded_module.hpp"
#include "datasets/hdf5/hdf5_module.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {

bool has_hdf5() { return true; }

const Hdf5Functions& hdf5_functions(const std::string& file) {
  static const ModuleFunction module = load_function(kHdf5Module, kHdf5ModuleFunction);
  if (module.function != nullptr) {
    return *reinterpret_cast<const Hdf5Functions* (*)()>(module.function)();
  }
  throw DataError(file,
                  std::string("cannot be used without ") + kHdf5Module + " (" + module.error + ")",
                  "the module where mosbench was built or installed, and Debian's libhdf5");
}

}  // namespace mosbench
