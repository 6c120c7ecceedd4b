#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include "datasets/formats/byte_cursor.hpp"

namespace mosbench {

/// How the numbers of a message follow one another.
enum class MessageEncoding : std::uint8_t {
  kRos1,         ///< packed, little endian
  kCdr,          ///< OMG's CDR, as ROS 2 writes it: aligned, a byte order said in four bytes before
  kCdrBigEndian  ///< the same; only writers have to tell it from kCdr
};

/// The message types that are read; messages of other types are skipped.
inline constexpr std::string_view kPointCloud2 = "sensor_msgs/PointCloud2";
/// Of its drivers for both ROS, for ROS 1 and its first one for ROS 2: all with the same content.
inline constexpr std::array<std::string_view, 3> kLivoxMessages = {
    "livox_ros_driver2/CustomMsg", "livox_ros_driver/CustomMsg", "livox_interfaces/CustomMsg"};
inline constexpr std::string_view kTfMessage = "tf2_msgs/TFMessage";
inline constexpr std::string_view kOldTfMessage = "tf/tfMessage";
inline constexpr std::string_view kTransformStamped = "geometry_msgs/TransformStamped";
inline constexpr std::string_view kOdometry = "nav_msgs/Odometry";
inline constexpr std::string_view kPoseStamped = "geometry_msgs/PoseStamped";
inline constexpr std::string_view kPoseWithCovarianceStamped =
    "geometry_msgs/PoseWithCovarianceStamped";
inline constexpr std::string_view kPath = "nav_msgs/Path";
inline constexpr std::string_view kString = "std_msgs/String";

/// The topic on which a bag keeps the mark of its data (see DataMark), in one kString.
inline constexpr const char* kMarkTopic = "/mosbench/mark";

/// What a message is and how it is encoded.
struct MessageFormat {
  std::string_view type = kPointCloud2;
  MessageEncoding encoding = MessageEncoding::kRos1;
};

/// Turns the ROS 2 name of a type, "sensor_msgs/msg/PointCloud2", into that of ROS 1,
/// "sensor_msgs/PointCloud2".
inline std::string ros1_type(std::string_view name) {
  constexpr std::string_view kMiddle = "/msg/";
  const std::size_t middle = name.find(kMiddle);
  if (middle == std::string_view::npos) return std::string(name);
  return std::string(name.substr(0, middle)) + '/' +
         std::string(name.substr(middle + kMiddle.size()));
}

/// The inverse, for types of ROS 1.
inline std::string ros2_type(std::string_view name) {
  const std::size_t slash = name.find('/');
  return std::string(name.substr(0, slash)) + "/msg" + std::string(name.substr(slash));
}

/// Returns a number with its bytes in the other order.
template <typename Value>
Value byte_swapped(Value value) {
  std::array<char, sizeof(Value)> bytes;
  std::memcpy(bytes.data(), &value, bytes.size());
  std::ranges::reverse(bytes);
  std::memcpy(&value, bytes.data(), bytes.size());
  return value;
}

/// What CDR puts before a message: two bytes that say plain CDR and its byte order, two options.
inline constexpr std::size_t kCdrHeadBytes = 4;

/// Reads the values of a message one after the other. Throws DataError that says `what` in `file`
/// ends early or is not plain CDR.
class MessageCursor {
 public:
  MessageCursor(std::string_view bytes, MessageEncoding encoding, const std::filesystem::path& file,
                std::string what)
      : size_bytes_(bytes.size()), cursor_(bytes, file, what) {
    if (encoding == MessageEncoding::kRos1) return;
    is_cdr_ = true;
    const std::string_view head = cursor_.take_bytes(kCdrHeadBytes);
    if (head[0] != 0 || (head[1] != 0 && head[1] != 1)) {
      throw DataError(file, what + " is not encoded as plain CDR", "bytes 0 0 or 0 1 before it");
    }
    is_big_endian_ = head[1] == 0;
  }

  template <typename Value>
  Value take() {
    align(sizeof(Value));
    const Value value = cursor_.take<Value>();
    return is_big_endian_ ? byte_swapped(value) : value;
  }

  std::string_view take_text() {
    std::string_view text = cursor_.take_bytes(take<std::uint32_t>());
    // CDR counts the byte 0 at the end.
    if (is_cdr_ && text.ends_with('\0')) text.remove_suffix(1);
    return text;
  }

  void align(std::size_t size_bytes) {
    if (!is_cdr_) return;
    const std::size_t past_bytes = (position_bytes() - kCdrHeadBytes) % size_bytes;
    if (past_bytes != 0) cursor_.take_bytes(size_bytes - past_bytes);
  }

  /// Of the next value in the message's bytes.
  std::size_t position_bytes() const { return size_bytes_ - cursor_.rest().size(); }
  bool is_cdr() const { return is_cdr_; }
  bool is_big_endian() const { return is_big_endian_; }

 private:
  std::size_t size_bytes_;
  ByteCursor cursor_;
  bool is_cdr_ = false;
  bool is_big_endian_ = false;
};

/// Writes the values of a message: the inverse of MessageCursor.
class MessageSink {
 public:
  explicit MessageSink(MessageEncoding encoding) : encoding_(encoding) {
    if (!is_cdr()) return;
    bytes_ = {'\0', encoding == MessageEncoding::kCdr ? '\1' : '\0', '\0', '\0'};
  }

  template <typename Value>
  void put(Value value) {
    if (is_cdr()) {
      const std::size_t past_bytes = (bytes_.size() - kCdrHeadBytes) % sizeof(Value);
      if (past_bytes != 0) bytes_.append(sizeof(Value) - past_bytes, '\0');
    }
    if (encoding_ == MessageEncoding::kCdrBigEndian) value = byte_swapped(value);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(Value));
  }
  void put_text(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size() + (is_cdr() ? 1 : 0)));
    bytes_ += text;
    if (is_cdr()) bytes_ += '\0';
  }
  void put_counted(std::string_view bytes) {
    put(static_cast<std::uint32_t>(bytes.size()));
    bytes_ += bytes;
  }
  bool is_cdr() const { return encoding_ != MessageEncoding::kRos1; }
  std::string bytes() && { return std::move(bytes_); }

 private:
  MessageEncoding encoding_;
  std::string bytes_;
};

}  // namespace mosbench
