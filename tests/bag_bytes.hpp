#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "datasets/formats/byte_cursor.hpp"
#include "datasets/rosbag/ros_messages.hpp"

namespace mosbench {

using BagField = std::pair<std::string, std::string>;

template <typename Value>
std::string bag_bytes_of(Value value) {
  ByteSink sink;
  sink.put(value);
  return std::move(sink).bytes();
}

inline std::string bag_stamp(std::int64_t stamp_ns) {
  return bag_bytes_of(static_cast<std::uint32_t>(stamp_ns / 1'000'000'000)) +
         bag_bytes_of(static_cast<std::uint32_t>(stamp_ns % 1'000'000'000));
}

inline std::string bag_fields(const std::vector<BagField>& fields) {
  ByteSink sink;
  for (const auto& [name, value] : fields) sink.put_counted(name + "=" + value);
  return std::move(sink).bytes();
}

inline std::string bag_record(const std::vector<BagField>& fields, std::string_view content) {
  ByteSink sink;
  sink.put_counted(bag_fields(fields));
  sink.put_counted(content);
  return std::move(sink).bytes();
}

struct BagEntry {
  std::uint32_t connection;
  std::int64_t recorded_ns;
  std::string message;
};

/// A bag put together by hand, one uncompressed chunk per list of messages, so that tests can spoil
/// any part of it. The members that start as bags have them can be changed before `str`.
struct BagBytes {
  std::vector<std::pair<std::string, std::string>> connections;  ///< topic, type
  std::vector<std::vector<BagEntry>> chunks;
  std::string compression = "none";
  std::vector<BagField> more_header_fields = {};
  std::uint32_t offset_error_bytes = 0;  ///< added to what the index says
  bool closed = true;

  std::string str() const {
    std::string body, chunk_summaries;
    const std::size_t header_bytes = bag_header(0).size();
    for (const auto& chunk : chunks) {
      chunk_summaries += append_chunk(chunk, header_bytes + body.size(), body);
    }
    const std::uint64_t index_at = header_bytes + body.size();
    for (std::size_t i = 0; i < connections.size(); ++i) {
      const auto& [topic, type] = connections[i];
      body += bag_record(
          {{"op", "\x07"}, {"conn", bag_bytes_of(static_cast<std::uint32_t>(i))}, {"topic", topic}},
          bag_fields({{"topic", topic}, {"type", type}, {"md5sum", "*"}}));
    }
    return bag_header(closed ? index_at : 0) + body + chunk_summaries;
  }

 private:
  std::string bag_header(std::uint64_t index_at) const {
    std::vector<BagField> fields = {
        {"op", "\x03"},
        {"index_pos", bag_bytes_of(index_at)},
        {"conn_count", bag_bytes_of(static_cast<std::uint32_t>(connections.size()))},
        {"chunk_count", bag_bytes_of(static_cast<std::uint32_t>(chunks.size()))}};
    fields.insert(fields.end(), more_header_fields.begin(), more_header_fields.end());
    return "#ROSBAG V2.0\n" + bag_record(fields, std::string(64, ' '));
  }

  std::string append_chunk(const std::vector<BagEntry>& entries, std::size_t at,
                           std::string& body) const {
    std::string content, index, counts;
    for (const BagEntry& entry : entries) {
      index += bag_record(
          {{"op", "\x04"},
           {"ver", bag_bytes_of(std::uint32_t{1})},
           {"conn", bag_bytes_of(entry.connection)},
           {"count", bag_bytes_of(std::uint32_t{1})}},
          bag_stamp(entry.recorded_ns) +
              bag_bytes_of(static_cast<std::uint32_t>(content.size()) + offset_error_bytes));
      counts += bag_bytes_of(entry.connection) + bag_bytes_of(std::uint32_t{1});
      content += bag_record({{"op", "\x02"},
                             {"conn", bag_bytes_of(entry.connection)},
                             {"time", bag_stamp(entry.recorded_ns)}},
                            entry.message);
    }
    body += bag_record({{"op", "\x05"},
                        {"compression", compression},
                        {"size", bag_bytes_of(static_cast<std::uint32_t>(content.size()))}},
                       content) +
            index;
    return bag_record({{"op", "\x06"},
                       {"ver", bag_bytes_of(std::uint32_t{1})},
                       {"chunk_pos", bag_bytes_of(std::uint64_t{at})},
                       {"start_time", bag_stamp(0)},
                       {"end_time", bag_stamp(0)},
                       {"count", bag_bytes_of(static_cast<std::uint32_t>(entries.size()))}},
                      counts);
  }
};

/// A message with points of x y z intensity float32 and t uint32.
inline std::string timed_cloud(std::int64_t stamp_ns, const std::vector<Point>& points,
                               const std::vector<std::uint32_t>& times_ns,
                               MessageEncoding encoding = MessageEncoding::kRos1) {
  CloudHead head;
  head.stamp_ns = stamp_ns;
  head.frame = "lidar";
  head.height = 1;
  head.width = static_cast<std::uint32_t>(points.size());
  head.fields = {{"x", 0, 7, 1}, {"y", 4, 7, 1}, {"z", 8, 7, 1}, {"intensity", 12, 7, 1}};
  head.fields.push_back({"t", 16, 6, 1});
  head.point_step_bytes = 20;
  head.row_step_bytes = 20 * head.width;
  ByteSink records;
  for (std::size_t i = 0; i < points.size(); ++i) {
    records.put(points[i]);
    records.put(times_ns.empty() ? 0U : times_ns[i]);
  }
  return format_cloud(head, std::move(records).bytes(), encoding);
}

inline std::string tf_at(std::int64_t stamp_ns, const Pose& map_from_lidar,
                         MessageEncoding encoding = MessageEncoding::kRos1) {
  return format_tf_message({{stamp_ns, "map", "lidar", map_from_lidar}}, encoding);
}

}  // namespace mosbench
