#include <cstddef>
#include <cstdint>

#include "tests/fuzz/parse_anything.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  mosbench::fuzz::gives_value(mosbench::fuzz::tracks, {reinterpret_cast<const char*>(bytes), size});
  return 0;
}
