#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mosbench {

/// One topic of one publisher.
struct BagConnection {
  std::uint32_t id = 0;
  std::string topic;
  std::string type;  ///< "sensor_msgs/PointCloud2"
};

/// Where a message is stored.
struct BagMessage {
  std::uint32_t connection = 0;
  std::int64_t recorded_ns = 0;  ///< when it was recorded, not the stamp of its header
  std::size_t chunk = 0;
  std::uint32_t offset_bytes = 0;  ///< of its record in the uncompressed chunk
};

/// A ROS 1 bag of version 2.0, read without ROS. Opening reads the headers of the records only, so
/// its cost depends on the number of chunks, not on their size; every header is checked against the
/// file before it is used. One chunk at a time is in memory.
class BagFile {
 public:
  /// Throws DataError for a file that is no such bag, is cut off, encrypted or was never closed.
  explicit BagFile(const std::filesystem::path& file);

  const std::filesystem::path& path() const { return file_; }
  const std::vector<BagConnection>& connections() const { return connections_; }
  std::vector<BagConnection> connections_of_type(std::string_view type) const;
  /// Returns the messages of a topic in the order in which they were recorded.
  std::vector<BagMessage> messages(std::string_view topic) const;
  /// Returns the bytes of a message, from an uncompressed chunk no more than `most_bytes`. Safe to
  /// call from several threads. Throws DataError.
  std::string read(const BagMessage& message, std::size_t most_bytes = SIZE_MAX) const;

 private:
  struct Chunk {
    std::uint64_t offset_bytes = 0;  ///< of its content
    std::uint32_t stored_bytes = 0;
    std::uint32_t size_bytes = 0;  ///< uncompressed
    std::string compression;
  };

  void walk(std::uint64_t index_at_bytes);
  void add_chunk(std::string_view header, std::uint64_t content_at_bytes,
                 std::uint32_t content_bytes);
  void add_index(std::string_view header, std::string_view content);
  void add_chunk_summary(std::string_view content);
  void add_connection(std::string_view header, std::string_view content);
  void check_counts(std::uint32_t connections, std::uint32_t chunks) const;
  std::string bytes_at(std::uint64_t offset_bytes, std::uint64_t count) const;
  std::shared_ptr<const std::string> chunk_content(std::size_t chunk) const;

  std::filesystem::path file_;
  std::uint64_t file_bytes_ = 0;
  mutable std::ifstream in_;
  mutable std::mutex mutex_;  ///< of in_ and unpacked_
  std::vector<BagConnection> connections_;
  std::vector<Chunk> chunks_;
  std::vector<BagMessage> messages_;
  std::uint64_t summarised_messages_ = 0;
  mutable std::pair<std::size_t, std::shared_ptr<const std::string>> unpacked_;
};

}  // namespace mosbench
