#include "datasets/rosbag/ros2_bag.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/rosbag/message_format.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

std::string unquoted(std::string_view text) {
  text = trim(text);
  const bool quotes = text.size() >= 2 && (text.front() == '"' || text.front() == '\'') &&
                      text.back() == text.front();
  return std::string(quotes ? text.substr(1, text.size() - 2) : text);
}

/// Takes a list in brackets.
void add_listed(std::string_view list, std::vector<std::string>& files) {
  if (!list.starts_with('[') || !list.ends_with(']')) return;
  for (const std::string_view name : split_at_commas(list.substr(1, list.size() - 2))) {
    if (!name.empty()) files.push_back(unquoted(name));
  }
}

}  // namespace

BagMetadata parse_bag_metadata(std::string_view text, const std::filesystem::path& file) {
  constexpr std::string_view kFiles = "relative_file_paths:", kCompression = "compression_format:";
  BagMetadata metadata;
  bool lists_files = false;
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    if (lists_files && line.starts_with("- ")) {
      metadata.files.push_back(unquoted(line.substr(2)));
      continue;
    }
    lists_files = line.starts_with(kFiles);
    if (lists_files) add_listed(trim(line.substr(kFiles.size())), metadata.files);
    if (line.starts_with(kCompression)) {
      metadata.compression = unquoted(line.substr(kCompression.size()));
    }
  }
  if (metadata.files.empty()) {
    throw DataError(file, "names no file of the bag", "relative_file_paths with at least one");
  }
  return metadata;
}

std::string format_bag_metadata(const BagSummary& summary) {
  std::size_t messages = 0;
  std::string topics;
  for (const TopicCount& topic : summary.topics) {
    messages += topic.messages;
    topics += fmt::format(
        "    - topic_metadata:\n"
        "        name: {}\n"
        "        type: {}\n"
        "        serialization_format: cdr\n"
        "        offered_qos_profiles: \"\"\n"
        "      message_count: {}\n",
        topic.name, topic.type, topic.messages);
  }
  return fmt::format(
      "{}\n"
      "  version: 5\n"
      "  storage_identifier: {}\n"
      "  duration:\n"
      "    nanoseconds: {}\n"
      "  starting_time:\n"
      "    nanoseconds_since_epoch: {}\n"
      "  message_count: {}\n"
      "  topics_with_message_count:\n"
      "{}"
      "  compression_format: \"{}\"\n"
      "  compression_mode: \"{}\"\n"
      "  relative_file_paths:\n"
      "    - {}\n",
      kBagMetadataStart, summary.storage, summary.last_ns - summary.first_ns, summary.first_ns,
      messages, topics, summary.compression, summary.compression.empty() ? "" : "MESSAGE",
      summary.file);
}

const char* message_file_of(Ros2Storage storage) {
  return storage == Ros2Storage::kMcap ? "bag_0.mcap" : "bag_0.db3";
}

std::unique_ptr<Ros2BagWriter> Ros2BagWriter::open(Ros2Storage storage,
                                                   const std::filesystem::path& folder,
                                                   const std::string& compression) {
  const bool is_mcap = storage == Ros2Storage::kMcap;
  if (compression != "none" && compression != "zstd" && !(is_mcap && compression == "lz4")) {
    throw UsageError("compression: '" + compression + "' is not known, expected " +
                     (is_mcap ? "none, lz4 or zstd" : "none or zstd"));
  }
  const std::string name = compression == "none" ? "" : compression;  // as both formats have it
  return is_mcap ? open_mcap_writer(folder, name) : open_sqlite_writer(folder, name);
}

Ros2BagWriter::Ros2BagWriter(const std::filesystem::path& folder, BagSummary summary)
    : folder_(folder), summary_(std::move(summary)) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw DataError(folder, "cannot be written (" + error.message() + ")", "a writable folder");
  }
}

void Ros2BagWriter::write(const std::string& topic, std::int64_t stamp_ns, std::string_view type,
                          std::string_view message) {
  constexpr std::int64_t kEndNs = (std::int64_t{1} << 31U) * 1'000'000'000;
  if (stamp_ns < 0) throw DataError(file(), "a stamp to be written is negative", "stamps from 0");
  if (stamp_ns >= kEndNs) {
    throw DataError(file(), "a stamp to be written is beyond 2^31 s",
                    "seconds of 31 bits, as in ROS 2");
  }
  auto& topics = summary_.topics;
  auto known = std::ranges::find(topics, topic, &TopicCount::name);
  const bool is_new = known == topics.end();
  if (is_new) known = topics.insert(topics.end(), {topic, ros2_type(type), 0});
  const bool is_first = topics.size() == 1 && known->messages == 0;
  summary_.first_ns = is_first ? stamp_ns : std::min(summary_.first_ns, stamp_ns);
  summary_.last_ns = std::max(summary_.last_ns, stamp_ns);
  ++known->messages;
  append(static_cast<std::size_t>(known - topics.begin()), is_new, stamp_ns, message);
}

void Ros2BagWriter::close() {
  end();
  write_file_atomic(folder_ / kBagMetadataFile, format_bag_metadata(summary_));
  put_in_place();
}

}  // namespace mosbench
