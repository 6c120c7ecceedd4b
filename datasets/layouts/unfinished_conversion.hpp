#pragma once

#include <filesystem>
#include <set>
#include <string>

namespace mosbench {

/// Marks a folder to which `convert` writes, until all is written. `statement` says what is
/// converted from where to what: the same conversion may go on after a kill.
class UnfinishedConversion {
 public:
  /// `expected` are the files that the conversion writes, named from `root`. Throws UsageError when
  /// the folder holds another one, or another conversion was not finished there.
  UnfinishedConversion(const std::filesystem::path& root, const std::string& statement,
                       const std::set<std::filesystem::path>& expected);

  /// Removes the mark: all is written.
  void finish() const;
  /// Removes all that was written, unless an earlier conversion went on.
  void give_up() const;

 private:
  std::filesystem::path root_;
  bool is_resumed_;
};

/// Returns whether a conversion to the folder was not finished.
bool is_unfinished_conversion(const std::filesystem::path& root);

}  // namespace mosbench
