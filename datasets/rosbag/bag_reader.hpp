#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "datasets/rosbag/message_format.hpp"

namespace mosbench {

/// One topic of one publisher.
struct BagConnection {
  std::uint32_t id = 0;
  std::string topic;
  std::string type;  ///< as ROS 1 writes it: "sensor_msgs/PointCloud2"
  MessageEncoding encoding = MessageEncoding::kRos1;
};

/// Where a message is stored.
struct BagMessage {
  std::uint32_t connection = 0;
  std::int64_t recorded_ns = 0;  ///< when it was recorded, not the stamp of its header
  std::size_t chunk = 0;
  std::uint64_t offset_bytes = 0;  ///< of its record in the uncompressed chunk; a row of a database
  std::size_t part = 0;            ///< of a bag of several files
};

/// The recorded messages of a robot, whatever file keeps them.
class BagReader {
 public:
  virtual ~BagReader() = default;
  BagReader(const BagReader&) = delete;
  BagReader& operator=(const BagReader&) = delete;

  /// What errors name.
  const std::filesystem::path& path() const { return path_; }
  /// All files that were opened; at least one.
  const std::vector<std::filesystem::path>& files() const { return files_; }
  /// Plain sentences on how it is read, and on what of it may be missing.
  const std::vector<std::string>& remarks() const { return remarks_; }
  const std::vector<std::string>& doubts() const { return doubts_; }
  const std::vector<BagConnection>& connections() const { return connections_; }
  std::vector<BagConnection> connections_of_type(std::string_view type) const;
  /// Returns the connection with this id, or nullptr.
  const BagConnection* find_connection(std::uint32_t id) const;

  /// Returns when the first and the last message were recorded; nothing without any.
  virtual std::optional<std::pair<std::int64_t, std::int64_t>> extent_ns() const;
  /// Returns the messages of a topic in the order in which they were recorded.
  virtual std::vector<BagMessage> messages(std::string_view topic) const;
  /// Returns the bytes of a message, no more than `most_bytes` where that spares reading them. Safe
  /// to call from several threads. Throws DataError.
  virtual std::string read(const BagMessage& message, std::size_t most_bytes = SIZE_MAX) const = 0;
  /// Returns how the bytes of a message are to be parsed, valid as long as this reader.
  virtual MessageFormat format_of(const BagMessage& message) const;

 protected:
  explicit BagReader(const std::filesystem::path& path) : path_(path), files_{path} {}

  std::filesystem::path path_;
  std::vector<std::filesystem::path> files_;
  std::vector<std::string> remarks_, doubts_;
  std::vector<BagMessage> messages_;  ///< of all topics

  /// Adds a connection; returns false where one of its id is there, which the others find.
  bool add(BagConnection connection);

 private:
  std::vector<BagConnection> connections_;
  std::unordered_map<std::uint32_t, std::size_t> position_;  ///< by id
};

/// Open a ROS 1 bag of version 2.0; a ROS 2 bag in one MCAP file (mcap.dev); one in a database of
/// SQLite (.db3), or in the content of such a file, which outlives it and may be changed. Throw
/// DataError for a file that is none, or is damaged.
std::unique_ptr<const BagReader> open_ros1_bag(const std::filesystem::path& file);
std::unique_ptr<const BagReader> open_mcap(const std::filesystem::path& file);
std::unique_ptr<const BagReader> open_sqlite_bag(const std::filesystem::path& file);
std::unique_ptr<const BagReader> open_sqlite_bag(const std::filesystem::path& file,
                                                 std::span<unsigned char> content);

/// Returns whether a file is named as a bag (.bag, .mcap, .db3, each of ROS 2 also with .zstd after
/// it) or begins as one.
bool is_bag_file(const std::filesystem::path& path);

/// Returns whether a folder is a ROS 2 bag: it holds rosbag2's metadata.yaml.
bool is_bag_folder(const std::filesystem::path& path);

/// Opens a ROS 1 bag, a file or a folder of ROS 2, told apart by their bytes. Throws DataError.
std::unique_ptr<const BagReader> open_bag(const std::filesystem::path& path);

/// Returns the files of one recording as one bag, which errors name by `path`.
std::unique_ptr<const BagReader> join_bags(const std::filesystem::path& path,
                                           std::vector<std::unique_ptr<const BagReader>> parts,
                                           std::vector<std::string> remarks);

/// Files that a recorder made of one drive, in their order.
struct BagParts {
  std::string
      name;  ///< "drive" of drive_2024-01-01-12-00-00_0.bag and drive_2024-01-01-12-00-30_1.bag
  std::vector<std::filesystem::path> files;
  std::string doubt = {};  ///< about parts that are not there
};

/// Returns the bags of one folder, those together that `rosbag record --split` or a ROS 2 recorder
/// that was killed left as parts: numbered by their names, each recorded right after the one
/// before.
std::vector<BagParts> group_parts(const std::vector<std::filesystem::path>& bags);

/// Opens the parts as one bag. Throws DataError.
std::unique_ptr<const BagReader> open_bag(const BagParts& parts);

}  // namespace mosbench
