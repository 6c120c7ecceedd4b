#include "datasets/layouts/unfinished_conversion.hpp"

#include <system_error>

#include "datasets/disk/files.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

fs::path mark_of(const fs::path& root) { return partial_of(root / "convert"); }

void refuse_foreign(const fs::path& root, const std::set<fs::path>& expected) {
  const std::string mark = mark_of(root).filename();
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    const fs::path name = entry.path().lexically_relative(root);
    const std::string file = name.filename();
    const bool is_folder = entry.is_directory() && !entry.is_symlink();
    if (is_folder || file == mark || expected.contains(name)) continue;
    if (file.ends_with(partial_of("").native())) continue;
    throw UsageError(entry.path().string() +
                     ": is no file of this conversion, expected an empty folder in " +
                     option("out"));
  }
}

}  // namespace

UnfinishedConversion::UnfinishedConversion(const fs::path& root, const std::string& statement,
                                           const std::set<fs::path>& expected)
    : root_(root), is_resumed_(is_unfinished_conversion(root)) {
  if (!is_resumed_) {
    refuse_foreign(root, {});
    commit_file(mark_of(root), statement);
  } else if (read_file(mark_of(root)) == statement) {
    refuse_foreign(root, expected);
  } else {
    throw UsageError(root.string() +
                     ": holds an unfinished conversion of other files or to another layout, "
                     "expected an empty folder in " +
                     option("out"));
  }
}

void UnfinishedConversion::finish() const {
  fs::remove(mark_of(root_));
  sync_names_of(root_);
}

void UnfinishedConversion::give_up() const {
  if (is_resumed_) return;
  std::error_code failed;
  const fs::path mark = mark_of(root_);
  for (const auto& entry : fs::directory_iterator(root_, failed)) {
    std::error_code error;
    if (entry.path() != mark) fs::remove_all(entry.path(), error);
    if (error) failed = error;
  }
  // As long as something is left, the mark lets the same conversion go on.
  if (!failed) fs::remove(mark, failed);
}

bool is_unfinished_conversion(const fs::path& root) { return is_there(mark_of(root)); }

}  // namespace mosbench
