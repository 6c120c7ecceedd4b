#include "datasets/disk/replace_folder.hpp"

#include <fcntl.h>

#include <cstdio>
#include <system_error>

#include "datasets/disk/disk_sync.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

bool exchange_names(const fs::path& a, const fs::path& b) {
  return renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

/// Returns where the old folder is then.
fs::path put_in_place(const fs::path& fresh, const fs::path& folder) {
  if (exchange_names(fresh, folder)) return fresh;
  const fs::path old = replaced_by(folder);
  if (is_there(folder)) {
    fs::remove_all(old);
    fs::rename(folder, old);
  }
  std::error_code error;
  fs::rename(fresh, folder, error);
  if (!error) return old;
  restore_folder(folder);
  throw std::system_error(error);
}

}  // namespace

fs::path replaced_by(const fs::path& folder) { return folder.native() + ".mosbench.replaced"; }

void restore_folder(const fs::path& folder) {
  if (!is_there(folder) && is_there(replaced_by(folder))) {
    fs::rename(replaced_by(folder), folder);
  }
}

void replace_folder(const fs::path& fresh, const fs::path& folder) {
  try {
    sync_file_system_of(fresh);
    const fs::path old = put_in_place(fresh, folder);
    sync_names_of(folder.parent_path());
    fs::remove_all(old);
  } catch (const std::system_error& error) {
    throw DataError(folder, "cannot be replaced (" + error.code().message() + ")",
                    "a writable output folder with free space");
  }
}

}  // namespace mosbench
