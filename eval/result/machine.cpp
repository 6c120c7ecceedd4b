#include "eval/result/machine.hpp"

#include <sys/utsname.h>
#include <unistd.h>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include <fstream>
#include <thread>

#include "eval/result/version.hpp"

namespace mosbench {
namespace {

std::string processor_name() {
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) {
      return line.substr(colon + 2);
    }
  }
  return "unknown";
}

constexpr double kMiB = 1048576;

std::size_t page_bytes() { return static_cast<std::size_t>(sysconf(_SC_PAGESIZE)); }

}  // namespace

Machine this_machine() {
  utsname system{};
  uname(&system);
  return {processor_name(), std::thread::hardware_concurrency(),
          static_cast<double>(memory_bytes()) / kMiB,
          std::string(system.sysname) + " " + system.machine};
}

nlohmann::ordered_json code_json() {
  return {{"version", std::string(kMosbenchVersion)}, {"compiler", std::string(kCompiler)}};
}

void keep_freed_memory() {
#if defined(__GLIBC__)
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 64 << 20);
#endif
}

void give_back_memory() {
#if defined(__GLIBC__)
  malloc_trim(0);
#endif
}

std::size_t memory_bytes() {
  return static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) * page_bytes();
}

double resident_mib() {
  std::ifstream statm("/proc/self/statm");
  double total_pages = 0.0;
  double resident_pages = 0.0;
  statm >> total_pages >> resident_pages;
  return statm ? resident_pages * static_cast<double>(page_bytes()) / kMiB : 0.0;
}

}  // namespace mosbench
