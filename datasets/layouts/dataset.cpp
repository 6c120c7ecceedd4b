#include "datasets/layouts/dataset.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "datasets/files/errors.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/layouts/simulated_origin.hpp"

namespace mosbench {
namespace {

const Layout& recognise(const std::filesystem::path& path, std::vector<std::string>& remarks) {
  if (const auto origin = simulated_origin(path)) {
    remarks.push_back("recognised as " + std::string(to_string(origin->layout)) +
                      ": it is simulated in this layout");
    return layout_of(origin->layout);
  }
  for (const Evidence evidence : {Evidence::kFolders, Evidence::kName, Evidence::kNone}) {
    for (const Layout* layout : layouts()) {
      if (layout->evidence != evidence) continue;
      if (const auto why = layout->recognise(path)) {
        remarks.push_back("recognised as " + std::string(layout->name) + ": " + *why);
        return *layout;
      }
    }
  }
  throw DataError(
      path, "holds no sequence",
      "a data set or one sequence folder (velodyne/ or binFiles/ with scans, poses.txt)");
}

std::string joined(const std::vector<SequenceFolder>& folders) {
  std::string names;
  for (const SequenceFolder& folder : folders) names += (names.empty() ? "" : ", ") + folder.name;
  return names;
}

/// Returns the folders whose name or alias is in `names`, in the data set's order; all when `names`
/// is empty.
std::vector<SequenceFolder> keep_named(std::vector<SequenceFolder> folders,
                                       const std::vector<std::string>& names) {
  if (names.empty()) return folders;
  const auto has_name = [](const SequenceFolder& folder, const std::string& name) {
    return !name.empty() && (folder.name == name || folder.alias == name);
  };
  for (const std::string& name : names) {
    if (std::ranges::any_of(folders, [&](const auto& folder) { return has_name(folder, name); })) {
      continue;
    }
    throw UsageError("no sequence \"" + name + "\", expected one of " + joined(folders));
  }
  std::erase_if(folders, [&](const SequenceFolder& folder) {
    return std::ranges::none_of(names, [&](const auto& name) { return has_name(folder, name); });
  });
  return folders;
}

struct ListedSequences {
  const Layout& layout;
  std::vector<SequenceFolder> folders;
};

ListedSequences list_sequences(const std::filesystem::path& path, const OpenOptions& options,
                               std::vector<std::string>& remarks) {
  std::error_code error;
  const std::filesystem::directory_iterator listing(path, error);
  if (error) {
    throw DataError(path, "is no folder that can be listed (" + error.message() + ")",
                    "a data set's root or one sequence folder");
  }
  const Layout& layout = options.kind ? layout_of(*options.kind) : recognise(path, remarks);
  auto found = layout.list(path);
  if (found.empty()) throw DataError(path, "holds no sequence", std::string(layout.expected));
  return {layout, keep_named(std::move(found), options.sequences)};
}

}  // namespace

std::vector<SequenceFolder> find_sequences(const std::filesystem::path& path,
                                           const OpenOptions& options,
                                           std::optional<DatasetKind>& kind) {
  std::vector<std::string> ignored;
  ListedSequences listed = list_sequences(path, options, ignored);
  kind = listed.layout.kind;
  return std::move(listed.folders);
}

Dataset open_dataset(const std::filesystem::path& path, const OpenOptions& options) {
  Dataset dataset;
  const auto [layout, folders] = list_sequences(path, options, dataset.remarks);
  dataset.kind = layout.kind;
  dataset.root = path;
  if (options.reading.poses && folders.size() != 1) {
    throw UsageError("--poses is for one sequence, not for " + joined(folders) +
                     ", expected one name in --sequences");
  }
  for (const SequenceFolder& folder : folders) {
    dataset.sequences.push_back(layout.open(folder, options.reading));
  }
  if (layout.splits != nullptr) {
    dataset.splits = layout.splits(folders, dataset.sequences, dataset.remarks);
  }
  return dataset;
}

}  // namespace mosbench
