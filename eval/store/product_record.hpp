#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace mosbench {

/// Writes files of `run --write` into a folder and keeps their hashes in its products.json, so that
/// a later run knows which are as they were written.
class ProductRecord {
 public:
  /// Throws DataError for a damaged products.json.
  explicit ProductRecord(std::filesystem::path folder);

  /// Returns whether `file`, a path below the folder, is there and known. Throws UsageError when it
  /// was changed since it was written.
  bool has(const std::string& file) const;
  /// Writes the file as a whole. `save` makes it known; every 50th call does so, so that a killed
  /// run makes few files again.
  void write(const std::string& file, std::string_view bytes);
  void save();
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
  nlohmann::ordered_json hashes_;  ///< by file
  std::size_t unsaved_ = 0;
};

}  // namespace mosbench
