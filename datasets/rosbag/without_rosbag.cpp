#include "datasets/files/errors.hpp"
#include "datasets/rosbag/bag_compression.hpp"
#include "datasets/rosbag/bag_writer.hpp"

namespace rosbag {
class Bag {};
}  // namespace rosbag

namespace mosbench {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const char* what) {
  throw DataError(file, what,
                  "a build with it (install librosbag-storage-dev, configure with "
                  "-DMOSBENCH_WITH_ROSBAG=ON)");
}

}  // namespace

bool has_rosbag() { return false; }

std::string decompress_chunk(std::string_view, std::string_view, std::uint32_t,
                             const std::filesystem::path& file) {
  refuse(file, "is compressed, which this build without ROS's bag library does not read");
}

BagWriter::BagWriter(std::filesystem::path file, const std::string&) {
  refuse(file, "cannot be written by this build without ROS's bag library");
}
BagWriter::~BagWriter() = default;
void BagWriter::write(const std::string&, std::int64_t, std::string_view, std::string_view) {}
void BagWriter::close() {}

}  // namespace mosbench
