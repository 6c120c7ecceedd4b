#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "datasets/rosbag/bag_metadata.hpp"

namespace mosbench {

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

  /// Appends a message in CDR; `type` is kPointCloud2 or kTfMessage. Throws DataError also for a
  /// stamp below 0.
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
