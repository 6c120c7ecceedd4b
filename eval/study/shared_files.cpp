#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <random>
#include <system_error>

#include "datasets/disk/files.hpp"
#include "datasets/simulator/simulate.hpp"
#include "datasets/text/errors.hpp"
#include "eval/result/machine.hpp"
#include "eval/study/study_plan.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kEnd = ".partial";

std::string own_start() { return fmt::format(".{}-", host_name()); }

/// Where this process writes, under a name that no other takes on any host. What is there when this
/// object goes was not put in place, and is removed.
class OwnPath {
 public:
  explicit OwnPath(const fs::path& folder) {
    std::random_device random;
    path_ = folder /
            fmt::format("{}{}-{:08x}{:08x}{}", own_start(), getpid(), random(), random(), kEnd);
  }
  ~OwnPath() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  OwnPath(const OwnPath&) = delete;
  OwnPath& operator=(const OwnPath&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

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

}  // namespace

void write_shared(const fs::path& file, const std::string& bytes) {
  const OwnPath own(file.parent_path());
  try {
    commit_file(own.path(), bytes);
  } catch (const DataError& full) {
    throw DataError(fmt::format("{}, as {}", file.string(), full.what()));
  }
  std::error_code error;
  fs::rename(own.path(), file, error);
  if (!error) return;
  throw DataError(file, fmt::format("cannot be written ({})", error.message()),
                  "a writable folder");
}

void remove_abandoned(const fs::path& out) {
  std::vector<fs::path> abandoned;
  std::error_code ignored;
  for (const fs::path& folder : {out, out / "cells", out / "data"}) {
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
      if (is_abandoned(entry.path().filename().string())) abandoned.push_back(entry.path());
    }
  }
  for (const fs::path& path : abandoned) fs::remove_all(path, ignored);
}

fs::path made_data(const fs::path& out, const StudyData& data) {
  if (!data.simulation) return data.path;
  const fs::path folder = simulated_folder(out, data);
  if (is_there(folder)) return folder;
  const OwnPath own(folder.parent_path());
  simulate({.layout = data.simulation->layout,
            .scene = data.simulation->scene,
            .scans = data.simulation->scans,
            .seed = data.simulation->seed,
            .out = own.path()});
  // Where another process was first, its data are the same.
  std::error_code error;
  fs::rename(own.path(), folder, error);
  if (!error || is_there(folder)) return folder;
  throw DataError(folder, fmt::format("cannot be made ({})", error.message()), "a writable folder");
}

}  // namespace mosbench
