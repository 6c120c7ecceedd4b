#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace mosbench {

/// How a point's truth is counted.
enum class TruthClass : std::uint8_t {
  kIgnored,        ///< not counted at all
  kStatic,         ///< true negative or false positive
  kMoving,         ///< true positive or false negative
  kAlwaysNegative  ///< a true negative whatever is predicted (M-detector on nuScenes, ids 251..999)
};

/// Label ids first..last, both inclusive, belong to one class.
struct IdRange {
  std::uint16_t first, last;
  TruthClass becomes;
};

/// Maps label ids to classes. The lower 16 bits of a label are its id, the upper 16 an instance
/// number.
struct IdMap {
  std::span<const IdRange> ranges;  ///< where two overlap, the later one applies
  TruthClass unknown;               ///< class of the ids in no range; they are counted as unknown
};

/// An IdMap expanded to all 65536 ids, so that each point costs one look-up.
class LabelTable {
 public:
  explicit LabelTable(const IdMap& map);

  TruthClass operator[](std::uint32_t label) const {
    return static_cast<TruthClass>(entries_[label & 0xFFFFU] & ~kUnknown);
  }
  bool is_known(std::uint32_t label) const { return (entries_[label & 0xFFFFU] & kUnknown) == 0; }

 private:
  static constexpr std::uint8_t kUnknown = 0x80;
  std::array<std::uint8_t, 65536> entries_;
};

}  // namespace mosbench
