#pragma once

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "eval/answer/answer.hpp"

namespace mosbench {

/// Two runs, and what `mosbench compare` does with them.
struct CompareFlags {
  std::filesystem::path baseline, newer;
  double max_drop_points = 0.5;
  bool statistical = false, even_if = false, quiet = false, accept = false;
  std::vector<std::string> by;
  std::optional<std::filesystem::path> data;
  std::string dataset = "auto";
  std::size_t top = 10;
  std::filesystem::path summary;

  bool shows(std::string_view what) const { return std::ranges::find(by, what) != by.end(); }
};

/// Returns what the new run changes, paired scan by scan. Throws DataError unless both are under
/// one protocol, over the same scans and truth.
Answer paired_difference(const CompareFlags& options);
/// Returns the scans and, with --data, the objects on which the runs disagree.
Answer scans_and_objects(const CompareFlags& options);
/// Makes the new run the baseline and returns what that changes.
Answer accepted(const CompareFlags& options);

}  // namespace mosbench
