#include "eval/store/result_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <system_error>
#include <vector>

#include "datasets/disk/claim.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/text/errors.hpp"
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
                                 "moving",    "static.ply", "static.pcd",      "products.json"};

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
    has_result = has_result || path.filename() == kResult;
    if (std::ranges::find(kWritten, path.filename()) == kWritten.end()) {
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
  const std::array<ScanFiles, 3> kinds = {{{kLabels, ".label", 4, true},
                                           {"scores", ".score", 4, point_files.scores},
                                           {"reasons", ".reason", 1, point_files.reasons}}};
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

}  // namespace mosbench
