#include "eval/protocols/label_map.hpp"

#include <algorithm>

namespace mosbench {

LabelTable::LabelTable(const IdMap& map) {
  entries_.fill(static_cast<std::uint8_t>(static_cast<std::uint8_t>(map.unknown) | kUnknown));
  for (const IdRange& range : map.ranges) {
    std::fill(entries_.begin() + range.first, entries_.begin() + range.last + 1,
              static_cast<std::uint8_t>(range.becomes));
  }
}

}  // namespace mosbench
