#include "datasets/disk/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

/// Returns whether an open folder is still the one of that name; another may have replaced it.
bool is_at(int descriptor, const std::filesystem::path& folder) {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && stat(folder.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder) : folder_(folder) {
  try {
    do {
      made_ = std::filesystem::create_directories(folder);
      descriptor_ = FileDescriptor(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
      require_success(descriptor_.is_open());
      if (flock(descriptor_.number(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        throw UsageError(folder.string() +
                         ": another mosbench is writing there, expected one at a time");
      }
    } while (!is_at(descriptor_.number(), folder));
  } catch (const std::system_error& error) {
    throw DataError(folder, "cannot be opened (" + error.code().message() + ")",
                    "a writable output folder");
  }
}

FolderLock::~FolderLock() {
  if (made_) rmdir(folder_.c_str());
}

}  // namespace mosbench
