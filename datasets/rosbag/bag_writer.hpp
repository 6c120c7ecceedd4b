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

/// Writes a ROS 1 bag through librosbag_storage. It has the name partial_of(file)
/// until it is closed, and is removed if it is not.
class BagWriter {
 public:
  /// `compression` is none, lz4 or bz2. Throws UsageError for another one, DataError when the file
  /// cannot be created, and always in a build without librosbag_storage.
  BagWriter(std::filesystem::path file, const std::string& compression);
  ~BagWriter();
  BagWriter(const BagWriter&) = delete;
  BagWriter& operator=(const BagWriter&) = delete;

  /// Appends a message as ROS 1 serializes it; `type` is kPointCloud2, kTfMessage or
  /// kString.
  void write(const std::string& topic, std::int64_t stamp_ns, std::string_view type,
             std::string_view message);
  void close();

 private:
  void remove_partial();

  std::filesystem::path file_, partial_;
  /// Closes a bag and deletes it.
  struct BagEnd {
    void operator()(rosbag::Bag* bag) const;
  };
  std::unique_ptr<rosbag::Bag, BagEnd> bag_;
};

}  // namespace mosbench
