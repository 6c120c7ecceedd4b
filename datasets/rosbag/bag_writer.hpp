#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace rosbag {
class Bag;
}

namespace mosbench {

/// Writes a ROS 1 bag through librosbag_storage. It appears under its name when it is closed: until
/// then it is `<file>.partial`.
class BagWriter {
 public:
  /// `compression` is none, lz4 or bz2. Throws UsageError for another one, DataError when the file
  /// cannot be made, and always in a build without the library.
  BagWriter(std::filesystem::path file, const std::string& compression);
  ~BagWriter();
  BagWriter(const BagWriter&) = delete;
  BagWriter& operator=(const BagWriter&) = delete;

  /// `message` as ROS serializes a message of `type`, one of those in ros_messages.hpp.
  void write(const std::string& topic, std::int64_t stamp_ns, std::string_view type,
             std::string_view message);
  void close();

 private:
  std::filesystem::path file_, partial_;
  std::unique_ptr<rosbag::Bag> bag_;
};

}  // namespace mosbench
