#pragma once

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"

namespace mosbench {

/// How one data set lies on disk: one row per DatasetKind.
struct Catalogue {
  DatasetKind kind;
  const char* layout;  ///< what an error says was expected
  /// The sequences below a root, or the one of a sequence folder; empty when this is neither.
  std::vector<SequenceFolder> (*list)(const std::filesystem::path& path);
  std::unique_ptr<Sequence> (*open)(const SequenceFolder& sequence, const ReadingOptions& options);
  /// Splits of the opened sequences; `folders` runs parallel to `sequences`. May add remarks.
  std::vector<Split> (*splits)(const std::vector<SequenceFolder>& folders,
                               const std::vector<std::unique_ptr<Sequence>>& sequences,
                               std::vector<std::string>& remarks);
  /// Why an untold path is taken for this data set, or nothing when it is not.
  std::optional<std::string> (*recognise)(const std::filesystem::path& path);
};

const Catalogue& doals_catalogue();
const Catalogue& helimos_catalogue();
const Catalogue& sipailou_catalogue();
const Catalogue& semantickitti_catalogue();
const Catalogue& apollo_catalogue();
const Catalogue& moe_catalogue();
const Catalogue& kth_catalogue();
const Catalogue& mdetector_catalogue();

/// The path from the root, without "." and ".." and a slash at the end.
std::filesystem::path without_slash(const std::filesystem::path& path);

/// The last name of a path, also of "." and of one that ends with a slash.
std::string folder_name(const std::filesystem::path& path);

/// The first of the names in the whole path that has one of `words` in it, in any case; nothing
/// when none has. `words` are in lower case.
std::optional<std::string> folder_with_word(const std::filesystem::path& path,
                                            std::initializer_list<const char*> words);

/// The folder in which a sequence folder lies.
std::filesystem::path parent_folder(const std::filesystem::path& path);

/// Splits that consist of whole sequences given by name; those without any sequence are left out.
struct NamedSplit {
  const char* name;
  std::vector<std::string> sequences;
};
std::vector<Split> splits_of_names(const std::vector<NamedSplit>& named,
                                   const std::vector<SequenceFolder>& folders);

}  // namespace mosbench
