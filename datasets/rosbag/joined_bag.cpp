#include "datasets/rosbag/joined_bag.hpp"

#include <algorithm>
#include <utility>

namespace mosbench {

JoinedBag::JoinedBag(const std::filesystem::path& folder,
                     std::vector<std::unique_ptr<const BagReader>> parts)
    : BagReader(folder), parts_(std::move(parts)) {
  files_.clear();
  for (const auto& part : parts_) {
    files_.insert(files_.end(), part->files().begin(), part->files().end());
    remarks_.insert(remarks_.end(), part->remarks().begin(), part->remarks().end());
    for (const BagConnection& connection : part->connections()) {
      connections_.push_back(connection);
    }
  }
}

std::vector<BagMessage> JoinedBag::messages(std::string_view topic) const {
  std::vector<BagMessage> joined;
  for (std::size_t part = 0; part < parts_.size(); ++part) {
    for (BagMessage message : parts_[part]->messages(topic)) {
      message.part = part;
      joined.push_back(message);
    }
  }
  std::ranges::stable_sort(joined, {}, &BagMessage::recorded_ns);
  return joined;
}

std::string JoinedBag::read(const BagMessage& message, std::size_t most_bytes) const {
  return parts_.at(message.part)->read(message, most_bytes);
}

MessageFormat JoinedBag::format_of(const BagMessage& message) const {
  return parts_.at(message.part)->format_of(message);
}

}  // namespace mosbench
