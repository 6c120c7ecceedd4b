#include "datasets/rosbag/bag_reader.hpp"

#include <algorithm>
#include <set>

namespace mosbench {

std::vector<BagConnection> BagReader::connections_of_type(std::string_view type) const {
  std::vector<BagConnection> found;
  for (const BagConnection& connection : connections_) {
    if (connection.type == type) found.push_back(connection);
  }
  return found;
}

const BagConnection* BagReader::find_connection(std::uint32_t id) const {
  const auto found = std::ranges::find(connections_, id, &BagConnection::id);
  return found == connections_.end() ? nullptr : &*found;
}

MessageFormat BagReader::format_of(const BagMessage& message) const {
  const BagConnection* connection = find_connection(message.connection);
  return {connection->type, connection->encoding};
}

std::vector<BagMessage> BagReader::messages(std::string_view topic) const {
  std::set<std::uint32_t> ids;
  for (const BagConnection& connection : connections_) {
    if (connection.topic == topic) ids.insert(connection.id);
  }
  std::vector<BagMessage> found;
  for (const BagMessage& message : messages_) {
    if (ids.contains(message.connection)) found.push_back(message);
  }
  std::ranges::stable_sort(found, {}, &BagMessage::recorded_ns);
  return found;
}

}  // namespace mosbench
