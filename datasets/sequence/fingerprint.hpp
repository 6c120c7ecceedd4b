#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "datasets/sequence/sequence.hpp"

struct XXH3_state_s;

namespace mosbench {

/// XXH3-128 over everything of a sequence that decides results: stems, points, poses, stamps and
/// truth of its frames in order, bit for bit. Frames are added while they are read.
class ContentFingerprint {
 public:
  enum class Of { kAll, kAllButPoses };
  explicit ContentFingerprint(Of of = Of::kAll);
  void add(const Frame& frame);
  /// Returns 32 hexadecimal digits for the frames added so far.
  std::string hex() const;

 private:
  struct FreeState {
    void operator()(XXH3_state_s* state) const;
  };
  void add_pose(const Pose& pose);

  Of of_;
  std::unique_ptr<XXH3_state_s, FreeState> state_;
};

/// Returns XXH3-128 over bytes, 32 hexadecimal digits.
std::string hash_of_text(std::string_view text);

/// Returns XXH3-128, 32 hexadecimal digits, over the size and the bytes of a file; of a file of
/// more than 32 MiB, as bags have, over half of that at each end.
std::string hash_of_file(const std::filesystem::path& file);

/// 16 hexadecimal digits. A fixed array: thousands of small strings would fragment the heap.
using LabelHash = std::array<char, 16>;

/// Returns XXH3-64 over the raw labels of one scan, which shows whether two results were scored
/// against the same truth, and whether labels were changed.
LabelHash hash_of_labels(std::span<const std::uint32_t> labels);

/// Returns 32 hexadecimal digits over names, sizes, inodes and times of a sequence's files: equal
/// when nothing was modified or replaced since, and cheap, as no scan is read. Not comparable
/// between machines. Throws DataError when a file is gone.
std::string file_stamp(const Sequence& sequence);

}  // namespace mosbench
