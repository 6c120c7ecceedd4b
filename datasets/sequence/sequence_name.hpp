#pragma once

#include <array>
#include <compare>
#include <filesystem>
#include <string>
#include <string_view>

namespace mosbench {

/// Folders of a file per scan that a run keeps beside its result.json.
inline constexpr std::array<std::string_view, 4> kScanFileFolders = {"labels", "scores", "reasons",
                                                                     "moving"};

/// Name of a sequence, which is also its folder below those of results: the name of a folder, or
/// two with a slash between as in "station/sequence_1".
class SequenceName {
 public:
  SequenceName() = default;
  /// Takes what `file`, a result.json or the sequence's folder, says. Throws DataError naming it
  /// unless every part is UTF-8 of 1 to 255 bytes without control characters, no "." or "..", and
  /// none that results use themselves: kScanFileFolders, result.json, *.partial, *.replaced.
  SequenceName(std::string text, const std::filesystem::path& file);

  const std::string& text() const { return text_; }
  operator const std::string&() const { return text_; }
  /// Relative, and below the folder that it is appended to.
  std::filesystem::path folder() const { return text_; }
  auto operator<=>(const SequenceName&) const = default;

 private:
  std::string text_;
};

}  // namespace mosbench
