#include "eval/store/baseline.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <system_error>

#include "datasets/disk/claim.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/text/errors.hpp"
#include "eval/result/result_file.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

/// The changes of a baseline; files are named from its folder.
struct BaselineChange {
  std::map<fs::path, std::string> written;  ///< with their bytes
  std::vector<fs::path> superseded;
};

/// Formats an accepted result.json: what `read_result` reads, without anything that
/// depends on the clock or the machine, so that accepting the same results again changes nothing.
std::string format_accepted(const Result& result) {
  Result accepted = result;
  accepted.from.machine.reset();
  accepted.timing.reset();
  accepted.places.reset();
  return format_result(accepted);
}

BaselineChange change_of(const ResultSet& run, const fs::path& folder) {
  BaselineChange change;
  std::set<fs::path> accepted;
  for (const Result& sequence : run.sequences) {
    const fs::path file = sequence.sequence.folder() / "result.json";
    accepted.insert(file);
    std::string bytes = format_accepted(sequence);
    if (!is_there(folder / file) || read_file(folder / file) != bytes) {
      change.written[file] = std::move(bytes);
    }
  }
  for (const fs::path& file : find_result_files(folder)) {
    const fs::path name = file.lexically_relative(folder);
    if (!accepted.contains(name)) change.superseded.push_back(name);
  }
  return change;
}

/// Makes a folder with the files of another. The same bytes have two names then, where links are
/// possible; the writes that follow replace names, not bytes.
void make_twin(const fs::path& folder, const fs::path& twin) {
  constexpr auto kAll = fs::copy_options::recursive | fs::copy_options::copy_symlinks;
  std::error_code error;
  fs::copy(folder, twin, kAll | fs::copy_options::create_hard_links, error);
  if (!error) return;
  fs::remove_all(twin);
  fs::copy(folder, twin, kAll);
}

void apply(const BaselineChange& change, const fs::path& folder) {
  for (const auto& [file, bytes] : change.written) write_file_atomic(folder / file, bytes);
  for (const fs::path& file : change.superseded) fs::remove(folder / file);
}

}  // namespace

std::vector<ResultSet> accepted_runs(const fs::path& folder) {
  if (!is_there(folder) || find_result_files(folder).empty()) return {};
  return load_result_sets(folder);
}

void refuse_overlap(const ResultSet& newer, const fs::path& folder) {
  const fs::path baseline = resolved(folder);
  const bool is_file = newer.path.filename() == "result.json";
  const fs::path results = resolved(is_file ? newer.path.parent_path() : newer.path);
  if (is_in(baseline, results) || is_in(results, baseline)) {
    throw UsageError(folder.string() + ": overlaps with the results in " + newer.path.string() +
                     ", expected a folder apart from them");
  }
  for (const Result& sequence : newer.sequences) {
    const fs::path place = folder / sequence.sequence.folder();
    if (is_in(resolved(place / "result.json"), baseline)) continue;
    throw UsageError(place.string() + ": is a link that leads out of the baseline, expected none");
  }
}

void accept_baseline(const ResultSet& run, const fs::path& folder) {
  const fs::path baseline = resolved(folder);
  const fs::path fresh = partial_of(baseline);
  fs::remove_all(fresh);  // what a killed one left
  const BaselineChange change = change_of(run, baseline);
  if (change.superseded.empty() && change.written.size() <= 1) {
    for (const auto& [file, bytes] : change.written) commit_file(baseline / file, bytes);
    return;
  }
  // Several files change at the same moment only with the folder that they are in.
  try {
    make_twin(baseline, fresh);
    const FolderLock lock(fresh);  // goes on holding the baseline under its name
    apply(change, fresh);
    replace_folder(fresh, baseline);
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(fresh, ignored);
    throw;
  }
}

}  // namespace mosbench
