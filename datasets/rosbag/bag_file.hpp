#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/rosbag/chunk_reader.hpp"

namespace mosbench {

/// A ROS 1 bag of version 2.0, read without ROS. Opening reads the headers of the records only, so
/// its cost depends on the number of chunks, not on their size; every header is checked against the
/// file before it is used. One chunk at a time is in memory.
class BagFile : public BagReader {
 public:
  /// Throws DataError for a file that is no such bag, is cut off, encrypted or was never closed.
  explicit BagFile(const std::filesystem::path& file);

  std::vector<BagMessage> messages(std::string_view topic) const override;
  std::string read(const BagMessage& message, std::size_t most_bytes = SIZE_MAX) const override;

 private:
  void walk(std::uint64_t index_at_bytes);
  void add_chunk(std::string_view header, std::uint64_t content_at_bytes,
                 std::uint32_t content_bytes);
  void add_index(std::string_view header, std::string_view content);
  void add_chunk_summary(std::string_view content);
  void add_connection(std::string_view header, std::string_view content);
  void check_counts(std::uint32_t connections, std::uint32_t chunks) const;

  ChunkReader in_;
  std::vector<BagChunk> chunks_;
  std::vector<BagMessage> messages_;
  std::uint64_t summarised_messages_ = 0;
};

}  // namespace mosbench
