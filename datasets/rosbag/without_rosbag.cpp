#include "datasets/rosbag/bag_writer.hpp"
#include "datasets/text/errors.hpp"

namespace rosbag {
class Bag {};
}  // namespace rosbag

namespace mosbench {

bool writes_bags() { return false; }

BagWriter::BagWriter(std::filesystem::path file, const std::string&) {
  throw DataError(file, "this build writes no bags",
                  "a build with librosbag_storage (install librosbag-storage-dev, configure with "
                  "-DMOSBENCH_WITH_ROSBAG=ON)");
}
void BagWriter::BagEnd::operator()(rosbag::Bag*) const {}
BagWriter::~BagWriter() = default;
void BagWriter::write(const std::string&, std::int64_t, std::string_view, std::string_view) {}
void BagWriter::close() {}

}  // namespace mosbench
