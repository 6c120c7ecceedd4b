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

/// Returns whether this build writes bags (MOSBENCH_WITH_ROSBAG).
bool writes_bags();

/// Writes a ROS 1 bag through librosbag_storage. It is named `<file>.partial` until it
/// is closed.
class BagWriter {
 public:
  /// `compression` is none, lz4 or bz2. Throws UsageError for another one, DataError when the file
  /// cannot be created, and always in a build without librosbag_storage.
  BagWriter(std::filesystem::path file, const std::string& compression);
  ~BagWriter();
  BagWriter(const BagWriter&) = delete;
  BagWriter& operator=(const BagWriter&) = delete;

  /// Appends a message as ROS 1 serializes it; `type` is kPointCloud2 or kTfMessage.
  void write(const std::string& topic, std::int64_t stamp_ns, std::string_view type,
             std::string_view message);
  void close();

 private:
  std::filesystem::path file_, partial_;
  std::unique_ptr<rosbag::Bag> bag_;
};

}  // namespace mosbench
