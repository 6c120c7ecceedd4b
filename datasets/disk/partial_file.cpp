#include "datasets/disk/partial_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <cstdio>
#include <random>

namespace mosbench {
namespace fs = std::filesystem;
namespace {

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

}  // namespace

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

}  // namespace mosbench
