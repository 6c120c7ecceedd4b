#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "datasets/sequence/sequence.hpp"

struct XXH3_state_s;

namespace mosbench {

/// XXH3-128 over everything of a sequence that decides results: stems, points, poses, stamps and
/// truth of its frames in order, bit for bit. Frames are added while they are read.
class ContentFingerprint {
 public:
  ContentFingerprint();
  void add(const Frame& frame);
  /// Returns 32 hexadecimal digits for the frames added so far.
  std::string hex() const;

 private:
  struct FreeState {
    void operator()(XXH3_state_s* state) const;
  };
  std::unique_ptr<XXH3_state_s, FreeState> state_;
};

/// 16 hexadecimal digits. A fixed array: thousands of small strings would fragment the heap.
using TruthHash = std::array<char, 16>;

/// Returns XXH3-64 over the raw labels of one scan, which shows whether two results were scored
/// against the same truth.
TruthHash truth_hash(std::span<const std::uint32_t> labels);

/// Returns 32 hexadecimal digits over names, sizes and modification times of a sequence's files:
/// equal when nothing was modified since, and cheap, as no scan is read. Not comparable between
/// machines. Throws DataError when a file is gone.
std::string file_stamp(const Sequence& sequence);

}  // namespace mosbench
