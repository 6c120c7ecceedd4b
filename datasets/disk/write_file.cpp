#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <optional>
#include <system_error>

#include "datasets/disk/disk_sync.hpp"
#include "datasets/disk/file_descriptor.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

/// Returns whether a path from the root leads to devices or open files. /dev/shm is a disk in
/// memory.
bool is_of_the_system(const fs::path& path) {
  const std::string& name = path.native();
  return name.starts_with("/proc/") ||
         (name.starts_with("/dev/") && !name.starts_with("/dev/shm/"));
}

/// Returns what to replace so that `file` has new bytes, behind all symbolic links; nothing when it
/// must not be replaced.
std::optional<fs::path> replaceable(fs::path file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) return std::nullopt;
  constexpr int kMostLinks = 40;
  for (int link = 0; link < kMostLinks; ++link) {
    const fs::path folder = file.has_parent_path() ? file.parent_path() : ".";
    file = fs::canonical(folder) / file.filename();
    if (is_of_the_system(file)) return std::nullopt;
    const fs::path target = fs::read_symlink(file, error);
    if (error) return file;
    file = file.parent_path() / target;
  }
  throw fs::filesystem_error("", std::make_error_code(std::errc::too_many_symbolic_link_levels));
}

/// Makes the folder of a file; returns whether it was missing.
bool make_folder_of(const fs::path& file) {
  return file.has_parent_path() && fs::create_directories(file.parent_path());
}

void replace(const fs::path& file, std::string_view bytes, bool on_disk, bool in_new_folder) {
  PartialFile partial(file);
  partial.write(bytes);
  // That folders were made has to reach the disk as well.
  if (on_disk && in_new_folder) sync_file_system_of(file.parent_path());
  if (on_disk) partial.sync();
  partial.put_in_place_of(file);
  if (on_disk) sync_names_of(file.parent_path());
}

bool is_stdout(const struct stat& file) {
  struct stat out {};
  return fstat(STDOUT_FILENO, &out) == 0 && out.st_ino == file.st_ino && out.st_dev == file.st_dev;
}

void write_directly(const fs::path& file, std::string_view bytes) {
  struct stat there {};
  require_success(stat(file.c_str(), &there) == 0);
  // Opened by its name, a file would be written from its start again.
  if (is_stdout(there)) return write_stdout(bytes);
  if (S_ISBLK(there.st_mode)) throw DataError(file, "is a disk", "a file");
  const FileDescriptor opened(open(file.c_str(), O_WRONLY | O_TRUNC | O_NOCTTY | O_CLOEXEC));
  require_success(opened.is_open());
  write_bytes(opened.number(), bytes);
}

void write(const fs::path& file, std::string_view bytes, bool on_disk) {
  try {
    const bool in_new_folder = make_folder_of(file);
    if (const auto target = replaceable(file)) {
      replace(*target, bytes, on_disk, in_new_folder);
    } else {
      write_directly(file, bytes);
    }
  } catch (const std::system_error& error) {
    throw DataError(file, "cannot be written (" + error.code().message() + ")",
                    "a writable output folder with free space");
  }
}

}  // namespace

void write_file_atomic(const fs::path& file, std::string_view bytes) { write(file, bytes, false); }

void commit_file(const fs::path& file, std::string_view bytes) { write(file, bytes, true); }

void write_stdout(std::string_view bytes) {
  // An empty view may be null, which fwrite does not accept.
  const bool written =
      bytes.empty() || std::fwrite(bytes.data(), 1, bytes.size(), stdout) == bytes.size();
  if ((written && std::fflush(stdout) == 0) || errno == EPIPE) return;
  throw DataError("stdout", "cannot be written (" + std::generic_category().message(errno) + ")",
                  "somewhere to write the answer");
}

}  // namespace mosbench
