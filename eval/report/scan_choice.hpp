#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "eval/result/result_file.hpp"

namespace mosbench {

/// Scans of a sequence to show, as the user wrote them: "auto", "all", "none", or a list of
/// "K", "A-B", "every:N" and "worst:N", counting from 0.
class ScanChoice {
 public:
  /// Throws UsageError naming --scans for anything else.
  explicit ScanChoice(const std::string& text);

  bool none() const { return parts_.empty(); }
  /// Returns scan indices in order of preference without duplicates; those after the sequence's end
  /// are left out, of the worst also those without truth. "auto" prefers the worst tenth, then
  /// scans spread evenly and ever more densely.
  std::vector<std::size_t> wanted(const std::vector<ScanRow>& rows) const;

 private:
  struct Part {
    enum class Kind { kAuto, kRange, kEvery, kWorst } kind;
    std::size_t first = 0;
    std::size_t last = 0;  ///< inclusive; of kEvery and kWorst the number is `first`
  };
  static Part parse(const std::string& word);

  std::vector<Part> parts_;
};

/// Returns scan indices by falling number of false points (FP + FN), equal ones in order; then
/// those in which the method did not look for motion, and scans without truth.
std::vector<std::size_t> worst_first(const std::vector<ScanRow>& rows);

}  // namespace mosbench
