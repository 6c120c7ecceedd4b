#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "datasets/disk/partial_file.hpp"
#include "datasets/formats/byte_cursor.hpp"
#include "datasets/rosbag/mcap_file.hpp"
#include "datasets/rosbag/ros2_bag_writer.hpp"

namespace mosbench {

/// Writes an MCAP file in chunks, each with an index of its messages, and a summary.
class McapWriter : public Ros2BagWriter {
 public:
  /// `compression` is "", "lz4" or "zstd".
  McapWriter(const std::filesystem::path& folder, const std::string& compression);

 private:
  void append(std::size_t topic, bool is_new, std::int64_t stamp_ns,
              std::string_view message) override;
  void end() override;
  void put_in_place() override;

  void put(std::string_view bytes);
  void put_chunk();
  std::string channel_records(std::size_t topic) const;
  std::string chunk_index(std::uint64_t at_bytes, std::uint64_t chunk_bytes,
                          std::uint64_t stored_bytes,
                          const std::map<std::uint16_t, std::uint64_t>& index_at_bytes) const;
  std::string statistics() const;

  std::string compression_;
  std::unique_ptr<PartialFile> out_;
  std::uint64_t written_bytes_ = 0;
  std::string chunk_;  ///< records that are not yet in the file
  std::int64_t chunk_first_ns_ = 0, chunk_last_ns_ = 0;
  /// Time and place in the chunk of its messages, by channel.
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> index_;
  std::uint32_t chunks_ = 0;
  std::string chunk_indexes_;
};

}  // namespace mosbench
