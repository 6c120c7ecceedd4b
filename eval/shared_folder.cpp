#include "eval/shared_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "datasets/errors.hpp"
#include "eval/json_differences.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

fs::path plain(const fs::path& folder) {
  const fs::path path = fs::weakly_canonical(folder);
  return path.has_filename() ? path : path.parent_path();
}

bool is_in(const fs::path& path, const fs::path& folder) {
  return std::ranges::mismatch(folder, path).in1 == folder.end();
}

/// `root` without the name of the sequence at its end: what holds all sequences, also where a
/// single one's folder was given.
fs::path without_name(fs::path root, fs::path name) {
  while (!name.empty() && root.filename() == name.filename()) {
    root = root.parent_path();
    name = name.parent_path();
  }
  return root;
}

bool same_dataset(const fs::path& a, const std::string& sequence_a, const fs::path& b,
                  const std::string& sequence_b) {
  return is_in(a, b) || is_in(b, a) || without_name(a, sequence_a) == without_name(b, sequence_b);
}

/// Empty when the results can stand beside those of the plan.
std::string other_run(const RunPlan& plan, const nlohmann::ordered_json& rules,
                      const fs::path& file) {
  const nlohmann::ordered_json there = read_result(file).content;
  try {
    const std::string changed = changed_members(there, rules);
    if (!changed.empty() || !there.contains("timing")) return changed;
    const fs::path root = plain(there.at("timing").value("dataset_root", ""));
    const fs::path ours = plain(plan.dataset.root);
    const std::string name = there.at("sequence").get<std::string>();
    if (root.empty() || same_dataset(root, name, ours, plan.dataset.sequences.front()->name())) {
      return "";
    }
    return fmt::format("data set is {} there and {} now", root.string(), ours.string());
  } catch (const nlohmann::ordered_json::exception& error) {
    throw DataError(file, error.what(), "a result.json of mosbench");
  }
}

}  // namespace

void check_shared_folder(const RunPlan& plan, const nlohmann::ordered_json& rules) {
  if (std::error_code error; !fs::is_directory(plan.out, error)) return;
  for (const fs::path& file : find_result_files(plan.out)) {
    const bool planned = std::ranges::any_of(plan.dataset.sequences, [&](const auto& sequence) {
      return plan.out / sequence->name() == file.parent_path();
    });
    const std::string other = planned ? "" : other_run(plan, rules, file);
    if (other.empty()) continue;
    throw UsageError(fmt::format(
        "{}: holds results of another run ({}: {}), expected those of one data set and setting; "
        "give another --out",
        plan.out.string(), file.string(), other));
  }
}

}  // namespace mosbench
