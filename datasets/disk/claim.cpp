#include "datasets/disk/claim.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <random>
#include <system_error>
#include <vector>

#include "datasets/disk/disk_sync.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kEnd = ".partial";

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

bool exchange(const fs::path& a, const fs::path& b) {
  return renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

/// Moves what lies at `place` aside, where it can be removed.
void move_aside(const fs::path& place) {
  const fs::path old = own_path(place.parent_path());
  std::error_code error;
  fs::rename(place, old, error);  // another may have done so
  if (!error) fs::remove_all(old, error);
}

}  // namespace

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
