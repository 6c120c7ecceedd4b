#include "eval/engine/shared_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <system_error>
#include <vector>

#include "datasets/disk/folder_relation.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/text/errors.hpp"
#include "eval/result/json_differences.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/result_json.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

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

/// Nothing when the file is no result of ours.
std::optional<Result> result_in(const fs::path& file) {
  try {
    return read_result(file);
  } catch (const DataError&) {
    return std::nullopt;
  }
}

/// Empty when the results can stand beside those of the plan.
std::string other_run(const RunPlan& plan, const nlohmann::ordered_json& rules,
                      const fs::path& file) {
  const std::optional<Result> there = result_in(file);
  if (!there) return "";
  const std::string changed = changed_members(identity_json(*there), rules);
  if (!changed.empty() || !there->places || !there->places->dataset_root) return changed;
  const fs::path& root = *there->places->dataset_root;
  const fs::path& ours = plan.dataset.root;
  const std::string our_name = plan.dataset.sequences.front()->name();
  if (same_dataset(without_slash(root), there->sequence, without_slash(ours), our_name) ||
      same_dataset(resolved(root), there->sequence, resolved(ours), our_name)) {
    return "";
  }
  return fmt::format("data set is {} there and {} now", root.string(),
                     without_slash(ours).string());
}

}  // namespace

void check_shared_folder(const RunPlan& plan, const nlohmann::ordered_json& rules) {
  if (std::error_code error; !fs::is_directory(plan.out, error)) return;
  // Sequences lie there or in scenes. Deeper ones are not looked for: it may be a home.
  constexpr int kDeepest = 2;
  for (const fs::path& file :
       find_result_files(plan.out, fs::directory_options::skip_permission_denied, kDeepest)) {
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
