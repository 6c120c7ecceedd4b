#include "datasets/rosbag/point_cloud2.hpp"

#include <cmath>

#include "datasets/files/errors.hpp"

namespace mosbench {
namespace {

std::vector<std::int64_t> read_times(const CloudHead& head, std::string_view message,
                                     const std::filesystem::path& file) {
  if (const CloudField* t = find_field(head, "t")) return integers_of(head, *t, message, file);
  const CloudField* time = find_field(head, "time");
  if (time == nullptr) return {};
  std::vector<std::int64_t> times_ns;
  times_ns.reserve(head.points());
  for (const double time_s : numbers_of(head, *time, message, file)) {
    if (!(std::abs(time_s) < 1e6)) {
      throw DataError(file, "a point of a PointCloud2 has no finite time",
                      "seconds since its stamp");
    }
    times_ns.push_back(std::llround(time_s * 1e9));
  }
  return times_ns;
}

}  // namespace

bool has_times(const CloudHead& head) {
  return find_field(head, "t") != nullptr || find_field(head, "time") != nullptr;
}

TimedCloud parse_cloud(std::string_view message, const std::filesystem::path& file) {
  const CloudHead head = parse_cloud_head(message, file);
  if (message.size() - head.records_at_bytes < head.records_bytes) {
    throw DataError(file, "a PointCloud2 ends within its points",
                    std::to_string(head.records_bytes) + " bytes of them");
  }
  TimedCloud cloud;
  cloud.stamp_ns = head.stamp_ns;
  if (head.points() == 0) return cloud;
  cloud.points = points_of(head, message, file);
  cloud.times_ns = read_times(head, message, file);
  return cloud;
}

}  // namespace mosbench
