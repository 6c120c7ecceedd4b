#include "datasets/disk/partial_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <cstdio>
#include <optional>
#include <random>

#include "datasets/disk/files.hpp"

namespace mosbench {
namespace fs = std::filesystem;
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

constexpr const char* kPartial = ".mosbench.partial";

/// Returns whether this process alone writes the file from now on. One that another process has
/// meanwhile put in place or removed is no longer at `path`. A file system without locks locks all.
bool take(int descriptor, const fs::path& path) {
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return false;
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && lstat(path.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev &&
         S_ISREG(opened.st_mode) && ftruncate(descriptor, 0) == 0;
}

FileDescriptor open_to_write(const fs::path& path, int more_flags) {
  // The path may hold a link or a FIFO.
  constexpr int kFlags = O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;
  constexpr int kReadableByAll = 0666;
  return FileDescriptor(open(path.c_str(), kFlags | more_flags, kReadableByAll));
}

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
  write_by(file, [&] {
    const bool in_new_folder = make_folder_of(file);
    const auto target = replaceable(file);
    target ? replace(*target, bytes, on_disk, in_new_folder) : write_directly(file, bytes);
  });
}

}  // namespace

DataError not_written(const fs::path& file, const std::string& why) {
  return {file, "cannot be written (" + why + ")", "a writable output folder with free space"};
}

void sync_names_of(const std::filesystem::path& folder) { sync_with(folder, fsync); }

void sync_file_system_of(const std::filesystem::path& folder) { sync_with(folder, syncfs); }

fs::path partial_of(const fs::path& path) { return path.native() + kPartial; }

bool is_partial_of(const std::string& name, const std::string& file) {
  return name.starts_with(file + '.') && name.ends_with(kPartial);
}

PartialFile::PartialFile(const fs::path& file)
    : path_(partial_of(file)), descriptor_(open_to_write(path_, 0)) {
  if (descriptor_.is_open() && take(descriptor_.number(), path_)) return;
  path_ = partial_of(fmt::format("{}.{}-{:08x}", file.native(), getpid(), std::random_device()()));
  descriptor_ = open_to_write(path_, O_EXCL);
  require_success(descriptor_.is_open());
}

PartialFile::~PartialFile() {
  if (!path_.empty() && descriptor_.is_open()) unlink(path_.c_str());
}

void PartialFile::write(std::string_view bytes) const {
  write_bytes(descriptor_.number(), bytes);
  // A full disk of another machine may be reported only when the file is closed; the lock stays.
  require_success(close(dup(descriptor_.number())) == 0);
}

void PartialFile::sync() const { require_success(fsync(descriptor_.number()) == 0); }

void PartialFile::put_in_place_of(const fs::path& file) {
  require_success(std::rename(path_.c_str(), file.c_str()) == 0);
  path_.clear();
}

void write_bytes(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    require_success(written >= 0 || errno == EINTR);
    if (written > 0) bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

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
