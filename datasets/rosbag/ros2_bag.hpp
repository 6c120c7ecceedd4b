#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
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

/// How a ROS 2 bag keeps its messages.
enum class Ros2Storage : std::uint8_t { kMcap, kSqlite };

/// Returns the name of the file of messages in a bag that is written: bag_0.mcap or bag_0.db3.
const char* message_file_of(Ros2Storage storage);

/// Writes a ROS 2 bag: a folder with the file of messages and metadata.yaml. The file has its name
/// only when all is written, and is removed if it is not.
class Ros2BagWriter {
 public:
  /// `compression` is none or zstd, and of chunks of kMcap also lz4. Throws UsageError for another
  /// one, DataError when the file cannot be created.
  static std::unique_ptr<Ros2BagWriter> open(Ros2Storage storage,
                                             const std::filesystem::path& folder,
                                             const std::string& compression);
  virtual ~Ros2BagWriter() = default;
  Ros2BagWriter(const Ros2BagWriter&) = delete;
  Ros2BagWriter& operator=(const Ros2BagWriter&) = delete;

  /// Appends a message in CDR; `type` is kPointCloud2, kTfMessage or kString. Throws DataError
  /// also for a stamp below 0.
  void write(const std::string& topic, std::int64_t stamp_ns, std::string_view type,
             std::string_view message);
  void close();

 protected:
  Ros2BagWriter(const std::filesystem::path& folder, BagSummary summary);
  const BagSummary& summary() const { return summary_; }
  std::filesystem::path file() const { return folder_ / summary_.file; }

 private:
  /// `topic` is the place of its topic in the summary; `is_new` of the first message of one.
  virtual void append(std::size_t topic, bool is_new, std::int64_t stamp_ns,
                      std::string_view message) = 0;
  /// Writes what waits for the last message.
  virtual void end() = 0;
  /// Gives the file its name.
  virtual void put_in_place() = 0;

  std::filesystem::path folder_;
  BagSummary summary_;
};

/// Open the two kinds of `Ros2BagWriter::open`; `compression` is "" for none.
std::unique_ptr<Ros2BagWriter> open_mcap_writer(const std::filesystem::path& folder,
                                                const std::string& compression);
std::unique_ptr<Ros2BagWriter> open_sqlite_writer(const std::filesystem::path& folder,
                                                  const std::string& compression);

}  // namespace mosbench
