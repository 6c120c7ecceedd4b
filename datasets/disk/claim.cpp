#include "datasets/disk/claim.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <random>
#include <system_error>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kEnd = ".partial";

/// Returns whether an open folder is still the one of that name; another may have replaced it.
bool is_at(int descriptor, const fs::path& folder) {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && stat(folder.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

bool exchange(const fs::path& a, const fs::path& b) {
  return renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

/// Returns where the old folder is then.
fs::path put_in_place(const fs::path& fresh, const fs::path& folder) {
  if (exchange(fresh, folder)) return fresh;
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

std::string own_start() { return fmt::format(".{}-", host_name()); }

/// Returns a name in `folder` that no other process takes on any host.
fs::path own_path(const fs::path& folder) {
  std::random_device random;
  return folder /
         fmt::format("{}{}-{:08x}{:08x}{}", own_start(), getpid(), random(), random(), kEnd);
}

/// Whether a process of this host that has ended gave this name.
bool is_abandoned(const std::string& name) {
  const std::string start = own_start();
  if (!name.starts_with(start) || !name.ends_with(kEnd)) return false;
  pid_t process = 0;
  const char* first = name.data() + start.size();
  const auto [end, error] = std::from_chars(first, name.data() + name.size(), process);
  if (error != std::errc() || *end != '-' || process <= 0) return false;
  return kill(process, 0) != 0 && errno == ESRCH;
}

/// Moves what lies at `place` aside, where it can be removed.
void move_aside(const fs::path& place) {
  const fs::path old = own_path(place.parent_path());
  std::error_code error;
  fs::rename(place, old, error);  // another may have done so
  if (!error) fs::remove_all(old, error);
}

}  // namespace

FolderLock::FolderLock(const fs::path& folder) : folder_(folder) {
  try {
    do {
      made_ = fs::create_directories(folder);
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

Claim::Claim(const fs::path& place) : Claim(place, own_path(place.parent_path())) {}

Claim::Claim(fs::path place, fs::path path) : place_(std::move(place)), path_(std::move(path)) {
  try {
    fs::remove_all(path_);
    fs::create_directories(place_.parent_path());
  } catch (const fs::filesystem_error& error) {
    throw DataError(place_.parent_path(),
                    fmt::format("cannot be made ({})", error.code().message()),
                    "a writable output folder");
  }
}

Claim::~Claim() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void Claim::put() {
  std::error_code error;
  constexpr int kMostWriters = 100;  // that take the place between two looks
  for (int i = 0; i < kMostWriters; ++i) {
    fs::rename(path_, place_, error);
    if (!error) return sync_names_of(place_.parent_path());
    if (error != std::errc::directory_not_empty && error != std::errc::file_exists) break;
    if (exchange(path_, place_)) return sync_names_of(place_.parent_path());
    move_aside(place_);  // as on NFS
  }
  throw DataError(place_, fmt::format("cannot be written ({})", error.message()),
                  "a writable folder");
}

void Claim::put_unless_there() {
  std::error_code error;
  fs::rename(path_, place_, error);
  if (!error || is_there(place_)) return;
  throw DataError(place_, fmt::format("cannot be made ({})", error.message()), "a writable folder");
}

void write_shared(const fs::path& file, std::string_view bytes) {
  Claim claim(file);
  try {
    commit_file(claim.path(), bytes);
  } catch (const DataError& full) {
    throw DataError(fmt::format("{}, as {}", file.string(), full.what()));
  }
  claim.put();
}

void remove_abandoned(const fs::path& folder) {
  std::vector<fs::path> abandoned;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (is_abandoned(entry.path().filename().string())) abandoned.push_back(entry.path());
  }
  for (const fs::path& path : abandoned) fs::remove_all(path, ignored);
}

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

}  // namespace mosbench
