#include "datasets/disk/disk_sync.hpp"

#include <fcntl.h>

#include "datasets/disk/file_descriptor.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

template <typename Sync>
void sync_with(const std::filesystem::path& folder, Sync&& sync) {
  const FileDescriptor opened(
      ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // EINVAL: a file system that has nothing to wait for.
  if (opened.is_open() && (sync(opened.number()) == 0 || errno == EINVAL)) return;
  throw DataError(folder,
                  "does not reach the disk (" + std::generic_category().message(errno) + ")",
                  "a disk that works");
}

}  // namespace

void sync_names_of(const std::filesystem::path& folder) { sync_with(folder, fsync); }

void sync_file_system_of(const std::filesystem::path& folder) { sync_with(folder, syncfs); }

}  // namespace mosbench
