#include "eval/result/machine.hpp"

#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <limits>
#include <thread>
#include <vector>

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

double thread_cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

/// Reads and writes cells in random order and multiplies, as maps of voxels do.
double work(std::vector<double>& cells) {
  constexpr int kSteps = 500'000;
  std::uint64_t random = 1;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    random = random * 6364136223846793005U + 1442695040888963407U;
    double& cell = cells[(random >> 40) % cells.size()];
    cell = 0.5 * cell + 1.0;
    sum += cell;
  }
  return sum;
}

double least_work_ms() {
  constexpr int kRounds = 6;
  constexpr std::size_t kCells = 1 << 17;
  std::vector<double> cells(kCells, 1.0);
  double least_ms = std::numeric_limits<double>::max();
  for (int round = 0; round < kRounds; ++round) {
    const double start_ms = thread_cpu_ms();
    const volatile double kept = work(cells);  // so that it is done
    static_cast<void>(kept);
    least_ms = std::min(least_ms, thread_cpu_ms() - start_ms);
  }
  return least_ms;
}

}  // namespace

double calibration_ms() {
  static const double kMeasured_ms = least_work_ms();
  return kMeasured_ms;
}

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
