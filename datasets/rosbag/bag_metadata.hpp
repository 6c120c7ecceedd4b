#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// What rosbag2 writes beside the files of a bag.
inline constexpr const char* kBagMetadataFile = "metadata.yaml";
inline constexpr std::string_view kBagMetadataStart = "rosbag2_bagfile_information:";

/// What is needed of it to read the bag.
struct BagMetadata {
  std::vector<std::string> files;  ///< relative_file_paths; at least one
  std::string compression;         ///< compression_format, "" for none
};

/// Parses a metadata.yaml as rosbag2 writes it: these keys on lines of their own, a list with a
/// line for each file or in brackets. Throws DataError when it names no file.
BagMetadata parse_bag_metadata(std::string_view text, const std::filesystem::path& file);

/// What a new metadata.yaml says.
struct TopicCount {
  std::string name, type;  ///< "/tf", "tf2_msgs/msg/TFMessage"
  std::size_t messages = 0;
};
struct BagSummary {
  std::string storage;      ///< "mcap" or "sqlite3"
  std::string file;         ///< of the messages
  std::string compression;  ///< of single messages: "" or "zstd"
  std::int64_t first_ns = 0, last_ns = 0;
  std::vector<TopicCount> topics;
};
std::string format_bag_metadata(const BagSummary& summary);

}  // namespace mosbench
