#pragma once

#include <filesystem>

#include "datasets/disk/file_descriptor.hpp"

namespace mosbench {

/// Holds a folder for one writer until destroyed, also against other processes.
class FolderLock {
 public:
  /// Makes the folder when missing. Throws DataError when that fails, UsageError when another
  /// process holds it.
  explicit FolderLock(const std::filesystem::path& folder);
  /// Removes the folder if it was made and nothing was written to it.
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::filesystem::path folder_;
  bool made_ = false;
  FileDescriptor descriptor_;
};

}  // namespace mosbench
