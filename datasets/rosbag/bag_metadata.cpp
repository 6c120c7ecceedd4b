#include "datasets/rosbag/bag_metadata.hpp"

#include <fmt/format.h>

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

}  // namespace mosbench
