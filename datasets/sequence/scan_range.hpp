#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

class Sequence;

/// Which scans of a sequence are read, by Python's rules for slices of numbers from 0 on.
struct ScanRange {
  std::size_t from = 0;
  std::optional<std::size_t> to = std::nullopt;  ///< one past the last; nothing: up to the end
  std::size_t step = 1;

  bool holds(std::size_t scan) const {
    return scan >= from && (!to || scan < *to) && (scan - from) % step == 0;
  }
};

/// Parses "FROM:TO:STEP", where each part may be missing, or "TO" alone. Throws UsageError without
/// the option's name, also for a range that holds no number.
ScanRange parse_scan_range(std::string_view text);
/// Returns the shortest text that `parse_scan_range` takes: equal ranges have equal texts.
std::string to_string(const ScanRange& range);

/// Returns the sequence with only the scans in the range, which its recording says. Each keeps its
/// name, pose and truth; scans without a pose count, too. Returns it as it is where all are in the
/// range. Throws UsageError when none is.
std::unique_ptr<Sequence> with_scan_range(std::unique_ptr<Sequence> inner, const ScanRange& range);

/// Returns the sequence in the same way without scans that have no points, and those that have the
/// points of an earlier one bit for bit. Throws UsageError when none is left.
std::unique_ptr<Sequence> without_useless_scans(std::unique_ptr<Sequence> inner);

/// Returns those of the doubts that stay with what is made of all that was read: not that this was
/// a part.
std::vector<std::string> doubts_that_stay(std::vector<std::string> doubts, const Sequence& read);

}  // namespace mosbench
