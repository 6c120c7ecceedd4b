#include "eval/statistics/baseline.hpp"

#include <algorithm>
#include <system_error>

#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

void remove_result(const fs::path& file) {
  std::error_code error;
  fs::remove(file, error);
  if (error)
    throw DataError(file, "cannot be removed (" + error.message() + ")", "a writable file");
}

}  // namespace

std::string format_accepted(const SequenceResult& result) {
  nlohmann::ordered_json header = result.header;
  header.erase("machine");
  return format_scored(header, result.scans);
}

std::vector<ResultSet> accepted_runs(const fs::path& folder) {
  if (!is_there(folder) || find_result_files(folder).empty()) return {};
  return load_result_sets(folder);
}

void accept_baseline(const ResultSet& run, const fs::path& folder) {
  for (const ResultSet& known : accepted_runs(folder)) {
    for (const SequenceResult& sequence : known.sequences) remove_result(sequence.file);
  }
  for (const SequenceResult& sequence : run.sequences) {
    write_file_atomic(folder / sequence.sequence / "result.json", format_accepted(sequence));
  }
}

}  // namespace mosbench
