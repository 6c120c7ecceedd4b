#include "eval/prediction_files.hpp"

#include <algorithm>
#include <set>
#include <system_error>

#include "datasets/errors.hpp"
#include "datasets/label_file.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

bool is_label_file(const fs::path& path) { return path.extension() == ".label"; }

std::vector<fs::path> label_files(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (is_label_file(it->path())) files.push_back(it->path());
  }
  std::ranges::sort(files);
  return files;
}

std::vector<fs::path> candidates(const fs::path& root, const Sequence& sequence,
                                 bool only_sequence) {
  const std::string name = sequence.name();
  std::vector<fs::path> folders = {root / name / "predictions", root / name / "labels",
                                   root / "sequences" / name / "predictions"};
  if (only_sequence) {
    folders.insert(folders.end(), {root / "predictions", root / "labels", root});
  }
  return folders;
}

bool is_truth_folder(const fs::path& folder, const Sequence& sequence) {
  return std::ranges::any_of(sequence.files(), [&](const fs::path& file) {
    std::error_code error;
    return is_label_file(file) && fs::equivalent(file.parent_path(), folder, error);
  });
}

}  // namespace

void PredictionFolder::check(const Sequence& sequence,
                             const std::vector<std::size_t>& wanted) const {
  std::set<std::string> stems;
  for (std::size_t k = 0; k < sequence.size(); ++k) stems.insert(sequence.stem(k));
  for (const fs::path& found : label_files(folder_)) {
    if (!stems.contains(found.stem().string())) {
      throw DataError(found, "belongs to no scan of sequence " + sequence.name(),
                      "only labels named like its scans");
    }
  }
  for (const std::size_t k : wanted) {
    std::error_code error;
    const fs::path expected = file(sequence.stem(k));
    const std::uintmax_t size_bytes = fs::file_size(expected, error);
    if (error) {
      throw DataError(expected, "cannot be read (" + error.message() + ")",
                      "a prediction for every scan with truth");
    }
    check_label_size(size_bytes, sequence.point_count(k), expected);
  }
}

std::vector<std::uint32_t> PredictionFolder::read(const std::string& stem,
                                                  std::size_t point_count) const {
  return read_labels(file(stem), point_count);
}

PredictionFolder find_predictions(const fs::path& root, const Sequence& sequence,
                                  bool only_sequence) {
  for (const fs::path& folder : candidates(root, sequence, only_sequence)) {
    if (label_files(folder).empty()) continue;
    if (is_truth_folder(folder, sequence)) {
      throw DataError(folder, "holds the truth of sequence " + sequence.name(),
                      "a folder of predictions");
    }
    return PredictionFolder(folder);
  }
  throw DataError(root, "no predictions for sequence " + sequence.name(),
                  "label files in <sequence>/predictions or <sequence>/labels");
}

}  // namespace mosbench
