#include "datasets/rosbag/ros2_bag_writer.hpp"

#include <algorithm>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/rosbag/message_format.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {

const char* message_file_of(Ros2Storage storage) {
  return storage == Ros2Storage::kMcap ? "bag_0.mcap" : "bag_0.db3";
}

std::unique_ptr<Ros2BagWriter> Ros2BagWriter::open(Ros2Storage storage,
                                                   const std::filesystem::path& folder,
                                                   const std::string& compression) {
  const bool is_mcap = storage == Ros2Storage::kMcap;
  if (compression != "none" && compression != "zstd" && !(is_mcap && compression == "lz4")) {
    throw UsageError("compression: '" + compression + "' is not known, expected " +
                     (is_mcap ? "none, lz4 or zstd" : "none or zstd"));
  }
  const std::string name = compression == "none" ? "" : compression;  // as both formats have it
  return is_mcap ? open_mcap_writer(folder, name) : open_sqlite_writer(folder, name);
}

Ros2BagWriter::Ros2BagWriter(const std::filesystem::path& folder, BagSummary summary)
    : folder_(folder), summary_(std::move(summary)) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw DataError(folder, "cannot be written (" + error.message() + ")", "a writable folder");
  }
}

void Ros2BagWriter::write(const std::string& topic, std::int64_t stamp_ns, std::string_view type,
                          std::string_view message) {
  constexpr std::int64_t kEndNs = (std::int64_t{1} << 31U) * 1'000'000'000;
  if (stamp_ns < 0) throw DataError(file(), "a stamp to be written is negative", "stamps from 0");
  if (stamp_ns >= kEndNs) {
    throw DataError(file(), "a stamp to be written is beyond 2^31 s",
                    "seconds of 31 bits, as in ROS 2");
  }
  auto& topics = summary_.topics;
  auto known = std::ranges::find(topics, topic, &TopicCount::name);
  const bool is_new = known == topics.end();
  if (is_new) known = topics.insert(topics.end(), {topic, ros2_type(type), 0});
  const bool is_first = topics.size() == 1 && known->messages == 0;
  summary_.first_ns = is_first ? stamp_ns : std::min(summary_.first_ns, stamp_ns);
  summary_.last_ns = std::max(summary_.last_ns, stamp_ns);
  ++known->messages;
  append(static_cast<std::size_t>(known - topics.begin()), is_new, stamp_ns, message);
}

void Ros2BagWriter::close() {
  end();
  write_file_atomic(folder_ / kBagMetadataFile, format_bag_metadata(summary_));
  put_in_place();
}

}  // namespace mosbench
