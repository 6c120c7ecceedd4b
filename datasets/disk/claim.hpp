#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "datasets/disk/partial_file.hpp"

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

/// Puts the folder `fresh`, which lies beside `folder`, in place of it and removes the old content.
/// All of `fresh` is on the disk before. After a kill or a power cut, the old or the new folder is
/// whole under its name. If the file system cannot exchange names (NFS), the old one may be at
/// replaced_by(folder). Throws DataError.
void replace_folder(const std::filesystem::path& fresh, const std::filesystem::path& folder);

/// Returns the name of the folder that is about to be removed because another one takes its place.
std::filesystem::path replaced_by(const std::filesystem::path& folder);

/// Brings back what a killed replace_folder left at replaced_by(folder) when nothing is at
/// `folder`.
void restore_folder(const std::filesystem::path& folder);

/// A folder or file that is being made and appears as a whole, by one rename. Its name until then
/// is this process's alone on every host, so that writers need no locks, which file systems that
/// hosts share may lack. What was not put in place goes with the object.
class Claim {
 public:
  /// `place` is the name to take; makes the folder around it.
  explicit Claim(const std::filesystem::path& place);
  /// The same where a lock keeps others away: `path` is where to write, and what a killed process
  /// left there is removed. Throws DataError.
  Claim(std::filesystem::path place, std::filesystem::path path);
  ~Claim();
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;

  /// Where to write until `put`.
  const std::filesystem::path& path() const { return path_; }

  /// Puts what was made at `place`; a folder that lies there is replaced. Throws DataError.
  void put();
  /// The same, but leaves what another process has put there meanwhile.
  void put_unless_there();

 private:
  std::filesystem::path place_, path_;
};

/// Replaces `file` as a whole by a Claim. Throws DataError.
void write_shared(const std::filesystem::path& file, std::string_view bytes);

/// Removes what processes of this host that have ended left half-written in a folder.
void remove_abandoned(const std::filesystem::path& folder);

/// Name of this host in its network, as far as it can be read.
std::string host_name();

}  // namespace mosbench
