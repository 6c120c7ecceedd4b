#include "datasets/hdf5/hdf5_module.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {

bool has_hdf5() { return false; }

const Hdf5Functions& hdf5_functions(const std::string& file) {
  throw DataError(file, "this build reads and writes no .h5",
                  "a build with libhdf5: `scripts/setup.sh && scripts/build.sh release --target "
                  "mosbench`, or of the Python package `scripts/setup.sh --python && pip install "
                  "--no-build-isolation --force-reinstall --no-deps .`");
}

}  // namespace mosbench
