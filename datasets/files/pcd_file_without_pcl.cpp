#include "datasets/files/errors.hpp"
#include "datasets/files/pcd_file.hpp"

namespace mosbench {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file) {
  throw DataError(file, "this build reads no .pcd files",
                  ".bin scans, or a build with PCL (install libpcl-dev, configure with "
                  "-DMOSBENCH_WITH_PCL=ON)");
}

}  // namespace

bool reads_pcd() { return false; }

std::vector<Point> read_pcd(const std::filesystem::path& file) { refuse(file); }

PcdHeader read_pcd_header(const std::filesystem::path& file) { refuse(file); }

bool pcd_has_labels(const std::filesystem::path& file) { refuse(file); }

std::vector<std::uint32_t> read_pcd_labels(const std::filesystem::path& file) { refuse(file); }

std::size_t pcd_point_count(const std::filesystem::path& file) { refuse(file); }

}  // namespace mosbench
