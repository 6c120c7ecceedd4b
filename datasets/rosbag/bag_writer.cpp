#include "datasets/rosbag/bag_writer.hpp"

#include <rosbag/bag.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "datasets/disk/partial_file.hpp"
#include "datasets/rosbag/ros_messages.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

/// How a bag describes a message type. MD5 sums ignore the comments of a definition.
struct MessageType {
  std::string_view name;
  const char* md5;
  std::string definition;
};

const MessageType& type_of(std::string_view name) {
  static const std::array<MessageType, 3> kTypes = {
      {{kPointCloud2, "1158d486dd51d683ce2f1be655c3c181",
        message_definition(kPointCloud2, MessageEncoding::kRos1)},
       {kTfMessage, "94810edda583a504dfda3829e70d7eec",
        message_definition(kTfMessage, MessageEncoding::kRos1)},
       {kString, "992ce8a1687cec8c8bd883ec73ca41d1",
        message_definition(kString, MessageEncoding::kRos1)}}};
  return *std::ranges::find(kTypes, name, &MessageType::name);
}

/// A message that is already serialized.
struct SerializedMessage {
  std::string_view bytes;
  const MessageType* type = nullptr;
};

rosbag::CompressionType compression_of(const std::string& name) {
  if (name == "none") return rosbag::compression::Uncompressed;
  if (name == "lz4") return rosbag::compression::LZ4;
  if (name == "bz2") return rosbag::compression::BZ2;
  throw UsageError("compression: '" + name + "' is not known, expected none, lz4 or bz2");
}

}  // namespace
}  // namespace mosbench

namespace ros {
namespace message_traits {

template <>
struct MD5Sum<mosbench::SerializedMessage> {
  static const char* value(const mosbench::SerializedMessage& message) { return message.type->md5; }
};

template <>
struct DataType<mosbench::SerializedMessage> {
  static const char* value(const mosbench::SerializedMessage& message) {
    return message.type->name.data();
  }
};

template <>
struct Definition<mosbench::SerializedMessage> {
  static const char* value(const mosbench::SerializedMessage& message) {
    return message.type->definition.c_str();
  }
};

}  // namespace message_traits

namespace serialization {

template <>
struct Serializer<mosbench::SerializedMessage> {
  template <typename Stream>
  static void write(Stream& stream, const mosbench::SerializedMessage& message) {
    std::memcpy(stream.advance(static_cast<uint32_t>(message.bytes.size())), message.bytes.data(),
                message.bytes.size());
  }
  static uint32_t serializedLength(const mosbench::SerializedMessage& message) {
    return static_cast<uint32_t>(message.bytes.size());
  }
};

}  // namespace serialization
}  // namespace ros

namespace mosbench {
namespace {

/// Asks for the memory that the library's buffers may need next, because the library ends the
/// program if it finds none.
void expect_memory(std::size_t message_bytes) {
  constexpr std::size_t kChunkBytes = 1 << 20;
  std::string().reserve(4 * (kChunkBytes + message_bytes));
}

/// Turns the exceptions of the library and of its plugin loader into DataError.
template <typename Call>
void checked(const std::filesystem::path& file, std::size_t message_bytes, Call&& call) {
  try {
    expect_memory(message_bytes);
    call();
  } catch (const std::exception& error) {
    throw not_written(file, error.what());
  }
}

}  // namespace

bool writes_bags() { return true; }

BagWriter::BagWriter(std::filesystem::path file, const std::string& compression)
    : file_(std::move(file)), partial_(partial_of(file_)) {
  const rosbag::CompressionType type = compression_of(compression);
  try {
    checked(file_, 0, [&] {
      if (file_.has_parent_path()) std::filesystem::create_directories(file_.parent_path());
      bag_.reset(new rosbag::Bag);  // loads a library
      bag_->open(partial_.string(), rosbag::bagmode::Write);
      bag_->setCompression(type);
    });
  } catch (const DataError&) {
    remove_partial();
    throw;
  }
}

void BagWriter::BagEnd::operator()(rosbag::Bag* bag) const {
  try {
    bag->close();
    delete bag;
  } catch (const std::exception&) {
    // Its destructor would close it once more, and end the program with the exception.
    static auto* const kept = new std::vector<rosbag::Bag*>;
    kept->push_back(bag);
  }
}

BagWriter::~BagWriter() { remove_partial(); }

void BagWriter::remove_partial() {
  bag_.reset();
  std::error_code ignored;
  std::filesystem::remove(partial_, ignored);
}

void BagWriter::write(const std::string& topic, std::int64_t stamp_ns, std::string_view type,
                      std::string_view message) {
  if (stamp_ns < 0) throw DataError(file_, "a stamp to be written is negative", "stamps from 0");
  if (stamp_ns / 1'000'000'000 > std::numeric_limits<std::uint32_t>::max()) {
    throw DataError(file_, "a stamp to be written is beyond 2^32 s",
                    "seconds of 32 bits, as in bags");
  }
  const SerializedMessage serialized{message, &type_of(type)};
  ros::Time time;
  // This is the time of recording, which the library wants above 0; the message has its own stamp.
  time.fromNSec(static_cast<std::uint64_t>(std::max<std::int64_t>(stamp_ns, 1)));
  checked(file_, message.size(), [&] { bag_->write(topic, time, serialized); });
}

void BagWriter::close() {
  checked(file_, 0, [&] {
    bag_->close();
    sync_file_system_of(partial_.parent_path());
    std::filesystem::rename(partial_, file_);
    sync_names_of(file_.parent_path());
  });
}

}  // namespace mosbench
