#include "datasets/rosbag/point_cloud2.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "datasets/formats/point_times.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr std::uint8_t kLastInteger = 6;  // of sensor_msgs/PointField's numbers

bool is_integer(const CloudField& field) { return field.datatype <= kLastInteger; }

std::vector<std::int64_t> seconds_as_ns(std::span<const double> times_s,
                                        const std::filesystem::path& file) {
  std::vector<std::int64_t> times_ns;
  times_ns.reserve(times_s.size());
  for (const double time_s : times_s) {
    if (!(std::abs(time_s) < 1e6)) {
      throw DataError(file, "a point of a PointCloud2 has no finite time",
                      "seconds since its stamp");
    }
    times_ns.push_back(std::llround(time_s * 1e9));
  }
  return times_ns;
}

std::vector<std::int64_t> read_times(const CloudHead& head, std::string_view message,
                                     const std::filesystem::path& file) {
  const CloudField* field = find_time_field(head);
  if (field == nullptr) return {};
  const bool is_float = !is_integer(*field);
  const bool counts_ns = field->name == "t" || field->name == "offset_time";
  if (counts_ns && !is_float) return integers_of(head, *field, message, file);
  const std::vector<double> stored = numbers_of(head, *field, message, file);
  const auto [first, last] = std::ranges::minmax(stored);
  if (field->name == "time" && is_float) return seconds_as_ns(stored, file);
  if (first == last) return std::vector<std::int64_t>(stored.size(), 0);
  return times_after_stamp_ns(stored, head.stamp_ns, file);
}

std::optional<std::vector<std::uint32_t>> read_labels(const CloudHead& head,
                                                      std::string_view message,
                                                      const std::filesystem::path& file) {
  const CloudField* field = find_field(head, "label");
  if (field == nullptr) return std::nullopt;
  std::vector<std::uint32_t> labels;
  labels.reserve(head.points());
  for (const std::int64_t label : integers_of(head, *field, message, file)) {
    labels.push_back(static_cast<std::uint32_t>(label));
  }
  return labels;
}

}  // namespace

bool has_times(const CloudHead& head) { return find_time_field(head) != nullptr; }

TimedCloud parse_cloud(std::string_view message, const std::filesystem::path& file,
                       const MessageFormat& format) {
  const CloudHead head = parse_cloud_head(message, file, format);
  if (message.size() - head.records_at_bytes < head.records_bytes) {
    throw DataError(file, "a PointCloud2 ends within its points",
                    std::to_string(head.records_bytes) + " bytes of them");
  }
  TimedCloud cloud;
  cloud.stamp_ns = head.stamp_ns;
  if (find_field(head, "label") != nullptr) cloud.labels.emplace();
  if (head.points() == 0) return cloud;
  cloud.points = points_of(head, message, file);
  cloud.times_ns = read_times(head, message, file);
  cloud.labels = read_labels(head, message, file);
  return cloud;
}

}  // namespace mosbench
