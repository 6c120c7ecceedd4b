#include <fmt/format.h>
#include <unistd.h>

#include <random>
#include <system_error>

#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/simulator/simulate.hpp"
#include "eval/results/machine.hpp"
#include "eval/study/study_plan.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

/// A name that no other process takes, on any host.
std::string own_name() {
  std::random_device random;
  return fmt::format(".{}-{}-{:08x}{:08x}.partial", host_name(), getpid(), random(), random());
}

}  // namespace

void write_shared(const fs::path& file, const std::string& bytes) {
  const fs::path own = file.parent_path() / own_name();
  std::error_code error;
  try {
    commit_file(own, bytes);
  } catch (const DataError& full) {
    fs::remove(own, error);
    throw DataError(fmt::format("{}, as {}", file.string(), full.what()));
  }
  fs::rename(own, file, error);
  if (!error) return;
  const std::string why = error.message();
  fs::remove(own, error);
  throw DataError(file, fmt::format("cannot be written ({})", why), "a writable folder");
}

fs::path made_data(const fs::path& out, const StudyData& data) {
  if (!data.simulation) return data.path;
  const fs::path folder = simulated_folder(out, data);
  if (is_there(folder)) return folder;
  const fs::path own = folder.parent_path() / own_name();
  std::error_code error;
  try {
    simulate({.layout = data.simulation->layout,
              .scene = data.simulation->scene,
              .scans = data.simulation->scans,
              .seed = data.simulation->seed,
              .out = own});
  } catch (...) {
    fs::remove_all(own, error);
    throw;
  }
  // Where another process was first, its data are the same.
  fs::rename(own, folder, error);
  if (!error) return folder;
  const std::string why = error.message();
  fs::remove_all(own, error);
  if (is_there(folder)) return folder;
  throw DataError(folder, fmt::format("cannot be made ({})", why), "a writable folder");
}

}  // namespace mosbench
