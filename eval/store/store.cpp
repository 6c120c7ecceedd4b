#include "eval/store/store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <system_error>

#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/result_json.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;
namespace fs = std::filesystem;

/// Nothing flattens to an unnamed null, which is no member.
ordered_json flat(const ordered_json& object) {
  return object.empty() ? ordered_json::object() : object.flatten();
}

std::string text_at(const ordered_json& members, const std::string& key) {
  if (!members.contains(key)) return "nothing";
  return members[key].dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

/// What differs, in the order of `now` and then what only the first has.
std::string differences(const ordered_json& there, const ordered_json& now) {
  const ordered_json theirs = flat(there), ours = flat(now);
  std::string text;
  for (const ordered_json* side : {&ours, &theirs}) {
    for (const auto& [key, unused] : side->items()) {
      if (side == &theirs && ours.contains(key)) continue;
      const std::string first = text_at(theirs, key), second = text_at(ours, key);
      if (first == second) continue;
      text += fmt::format("{}{} is {} there and {} now", text.empty() ? "" : "; ",
                          key.substr(key.starts_with('/') ? 1 : 0), first, second);
    }
  }
  return text;
}

constexpr const char* kLabels = "labels";
constexpr const char* kResult = "result.json";
// What a run writes; poses.txt with its mark where it found them, the last six by --write.
constexpr std::array kWritten = {kLabels,     "scores",     "reasons",         kResult,
                                 "poses.txt", "boxes.txt",  "poses.txt.frame", "boxes.json",
                                 "moving",    "static.ply", "static.pcd",      "products.json",
                                 "objects"};

std::vector<fs::path> entries(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> paths;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    paths.push_back(it->path());
  }
  if (error && error != std::errc::no_such_file_or_directory) {
    throw DataError(folder, "cannot be listed (" + error.message() + ")", "a readable folder");
  }
  return paths;
}

template <typename Operation>
void checked(const fs::path& path, const char* what, Operation&& operation) {
  std::error_code error;
  operation(error);
  if (error) {
    throw DataError(path, fmt::format("cannot be {} ({})", what, error.message()),
                    "a writable output folder");
  }
}

fs::path place_until_done(const fs::path& folder) { return folder.native() + ".partial"; }

/// A file per scan with so many bytes for each point.
struct ScanFiles {
  const char* folder;
  const char* extension;
  std::size_t bytes_per_point;
  bool are_wanted;
};

bool all_present(const fs::path& folder, const ScanFiles& files, const Result& result) {
  return std::ranges::all_of(result.scans, [&](const ScanRow& row) {
    std::error_code error;
    const auto size = fs::file_size(folder / (row.stem + files.extension), error);
    return !error && size == row.points * files.bytes_per_point;
  });
}

void refuse_extra(const fs::path& folder, const char* extension, const Sequence& sequence) {
  std::set<std::string> expected;
  for (std::size_t k = 0; k < sequence.size(); ++k) expected.insert(sequence.stem(k) + extension);
  for (const fs::path& file : entries(folder)) {
    if (expected.contains(file.filename().string())) continue;
    throw UsageError(fmt::format(
        "{}: belongs to no scan of the sequence, expected only {} files of its scans; remove it, "
        "or replace the results with --overwrite",
        file.string(), extension));
  }
}

/// The changes of a baseline; files are named from its folder.
struct BaselineChange {
  std::map<fs::path, std::string> written;  ///< with their bytes
  std::vector<fs::path> superseded;
};

/// The bytes of a result that is accepted where `before` is; nothing where it is the same.
std::optional<std::string> accepted_bytes(const Result& result, const fs::path& before,
                                          const std::optional<Acceptance>& why) {
  // Of the clock and the machine only what the run cost: accepting it again changes nothing.
  Result plain = result;
  plain.cost = run_cost(result);
  plain.from.machine.reset();
  plain.timing.reset();
  plain.places.reset();
  if (is_there(before)) {
    plain.accepted = read_result(before).accepted;
    if (format_result(plain) == read_file(before)) return std::nullopt;
  }
  plain.accepted = why;
  return format_result(plain);
}

BaselineChange change_of(const ResultSet& run, const fs::path& folder,
                         const std::optional<Acceptance>& why, Others others) {
  BaselineChange change;
  std::set<fs::path> accepted;
  for (const Result& sequence : run.sequences) {
    const fs::path file = sequence.sequence.folder() / "result.json";
    accepted.insert(file);
    if (auto bytes = accepted_bytes(sequence, folder / file, why)) {
      change.written[file] = std::move(*bytes);
    }
  }
  if (others == Others::kKeep) return change;
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

constexpr const char* kRecord = "products.json";

/// The hashes by file of an earlier run, none where there was none.
ordered_json read_hashes(const fs::path& file) {
  if (!is_there(file)) return ordered_json::object();
  const ordered_json json = parse_json(read_file(file), file);
  const auto files = json.is_object() ? json.find("files") : json.end();
  const bool fits = json.is_object() && files != json.end() && files->is_object() &&
                    std::ranges::all_of(*files, &ordered_json::is_string);
  if (fits) return *files;
  throw DataError(file, "has no hashes by file", "it as `mosbench run --write` wrote it, or none");
}

}  // namespace

std::string changed_members(const ordered_json& there, const ordered_json& now) {
  ordered_json same_keys;
  ordered_json compared = now;
  // Settings of another method are no changes of these.
  if (there.contains("method") && now.contains("method") && there["method"] != now["method"]) {
    compared.erase("settings");
  }
  for (const auto& [key, unused] : compared.items()) {
    if (there.contains(key)) same_keys[key] = there[key];
  }
  for (ordered_json* side : {&same_keys, &compared}) {
    // How long a program may take decides no label.
    const auto settings = side->find("settings");
    if (settings != side->end() && settings->is_object()) settings->erase("timeout_s");
  }
  return differences(same_keys, compared);
}

void ResultFolder::check_replaceable() const {
  const std::vector<fs::path> found = entries(folder_);
  bool has_result = found.empty();
  for (const fs::path& path : found) {
    const std::string name = path.filename();
    has_result = has_result || name == kResult;
    // A killed run leaves a file half-written.
    const auto is_ours = [&](const char* ours) {
      return name == ours || is_partial_of(name, ours);
    };
    if (std::ranges::none_of(kWritten, is_ours)) {
      throw UsageError(path.string() +
                       ": was not written by mosbench run, expected --out to name a folder of "
                       "its own");
    }
  }
  if (!has_result) {
    throw UsageError(folder_.string() +
                     ": holds labels but no result.json of mosbench run, expected --out to name a "
                     "folder of its own");
  }
}

std::optional<Result> ResultFolder::finished(const Sequence& sequence, const Result& asked,
                                             const PointFiles& point_files) const {
  check_replaceable();
  if (!fs::exists(folder_ / kResult)) return std::nullopt;
  Result result = read_result(folder_ / kResult);
  const std::string different = changed_members(identity_json(result), identity_json(asked));
  if (!different.empty()) {
    throw UsageError(fmt::format(
        "{}: holds results of another run ({}), expected the same; give another --out, or "
        "--overwrite to replace them",
        folder_.string(), different));
  }
  const std::array<ScanFiles, 4> kinds = {{{kLabels, ".label", 4, true},
                                           {"scores", ".score", 4, point_files.scores},
                                           {"reasons", ".reason", 1, point_files.reasons},
                                           {"objects", ".object", 4, point_files.objects}}};
  for (const ScanFiles& files : kinds) {
    refuse_extra(folder_ / files.folder, files.extension, sequence);
  }
  if (result.scans.size() != sequence.size()) return std::nullopt;
  for (const ScanFiles& files : kinds) {
    if (files.are_wanted && !all_present(folder_ / files.folder, files, result)) {
      return std::nullopt;
    }
  }
  return result;
}

void ResultFolder::check_labels(const Result& result) const {
  for (const ScanRow& row : result.scans) {
    const fs::path file = folder_ / kLabels / (row.stem + ".label");
    if (are_labels_of(row, read_labels(file, row.points))) continue;
    throw UsageError(fmt::format(
        "{}: was changed after the run, expected the labels that result.json counts; give another "
        "--out, or --overwrite to replace the results",
        file.string()));
  }
}

void ResultFolder::remove_leftovers() const {
  for (const fs::path& leftover : {place_until_done(folder_), replaced_by(folder_)}) {
    checked(leftover, "removed", [&](std::error_code& error) { fs::remove_all(leftover, error); });
  }
}

std::unique_ptr<Claim> ResultFolder::begin() const {
  auto claim = writers_ == Writers::kOne
                   ? std::make_unique<Claim>(folder_, place_until_done(folder_))
                   : std::make_unique<Claim>(folder_);
  checked(claim->path(), "made",
          [&](std::error_code& error) { fs::create_directories(claim->path(), error); });
  return claim;
}

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
    if (!is_in(resolved(place / "result.json"), baseline)) {
      throw UsageError(place.string() +
                       ": is a link that leads out of the baseline, expected none");
    }
    for (const char* file : kWritten) {
      if (file == std::string_view(kResult) || !is_there(place / file)) continue;
      throw UsageError(fmt::format(
          "{}: is of the run there, and would stay beside other numbers, expected a folder of "
          "accepted results alone",
          (place / file).string()));
    }
  }
}

bool accept_baseline(const ResultSet& run, const fs::path& folder,
                     const std::optional<Acceptance>& why, Others others) {
  const fs::path baseline = resolved(folder);
  const fs::path fresh = partial_of(baseline);
  fs::remove_all(fresh);  // what a killed one left
  const BaselineChange change = change_of(run, baseline, why, others);
  if (change.superseded.empty() && change.written.size() <= 1) {
    for (const auto& [file, bytes] : change.written) commit_file(baseline / file, bytes);
    return !change.written.empty();
  }
  // Several files change at the same moment only with the folder that they are in.
  try {
    make_twin(baseline, fresh);
    const FolderLock lock(fresh);  // goes on holding the baseline under its name
    for (const auto& [file, bytes] : change.written) write_file_atomic(fresh / file, bytes);
    for (const fs::path& file : change.superseded) fs::remove(fresh / file);
    replace_folder(fresh, baseline);
    return true;
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(fresh, ignored);
    throw;
  }
}

ProductRecord::ProductRecord(fs::path folder)
    : folder_(std::move(folder)), hashes_(read_hashes(folder_ / kRecord)) {}

bool ProductRecord::has(const std::string& file) const {
  const auto hash = hashes_.find(file);
  if (hash == hashes_.end() || !is_there(folder_ / file)) return false;
  if (*hash == hash_of_text(read_file(folder_ / file))) return true;
  throw UsageError(fmt::format(
      "{}: was changed after the run, expected what --write made of its labels; remove it, and the "
      "same command makes it again",
      (folder_ / file).string()));
}

void ProductRecord::write(const std::string& file, std::string_view bytes) {
  constexpr std::size_t kUnsaved = 50;
  // A killed run leaves files that are not known yet, with the same bytes.
  const fs::path path = folder_ / file;
  if (!hashes_.contains(file) && is_there(path) && read_file(path) != bytes) {
    throw UsageError(path.string() +
                     ": was not written by mosbench run --write, expected no file of this name");
  }
  write_file_atomic(path, bytes);
  hashes_[file] = hash_of_text(bytes);
  if (++unsaved_ == kUnsaved) save();
}

void ProductRecord::save() {
  unsaved_ = 0;
  write_file_atomic(folder_ / kRecord, json_text({{"files", hashes_}}));
}

}  // namespace mosbench
