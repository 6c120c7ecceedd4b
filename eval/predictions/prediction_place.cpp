#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <system_error>

#include "datasets/disk/folder_listing.hpp"
#include "datasets/hdf5/hdf5_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/predictions/prediction_files.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

using Format = PredictionFormat;

/// No sequence has as many scans, and as many ns (10 ms) no two scans are apart.
constexpr std::uint64_t kMostScans = 10'000'000;

std::vector<fs::path> candidate_folders(const fs::path& root, const std::string& name,
                                        bool only_sequence) {
  std::vector<fs::path> folders = {root / name / "predictions", root / name / "labels", root / name,
                                   root / "sequences" / name / "predictions"};
  // 4DMOS's confidences.
  for (const fs::path& parent : {root / "confidences", root}) folders.push_back(parent / name);
  if (only_sequence) {
    folders.insert(folders.end(), {root / "predictions", root / "labels", root});
  }
  return folders;
}

/// Lists the files of `folder` with this extension, without hidden ones, sorted; empty when the
/// folder cannot be read.
std::vector<fs::path> files_with_extension(const fs::path& folder, std::string_view extension) {
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (it->path().extension() == extension && !name.starts_with('.')) files.push_back(it->path());
  }
  std::ranges::sort(files);
  return files;
}

std::string first_line(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string line(4096, '\0');
  stream.read(line.data(), static_cast<std::streamsize>(line.size()));
  line.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, stream.gcount())));
  return line.substr(0, line.find('\n'));
}

/// Returns the number that each line begins with; stops at the first line that does not.
std::vector<std::uint64_t> first_numbers(const fs::path& file) {
  std::vector<std::uint64_t> numbers;
  std::ifstream stream(file, std::ios::binary);
  for (std::string line; std::getline(stream, line);) {
    const auto number = parse_unsigned(trim(std::string_view(line).substr(0, line.find(','))));
    if (!number) break;
    numbers.push_back(*number);
  }
  return numbers;
}

/// Recognises the format of a file for a whole sequence; nullopt for others, such as a README.
/// Rows begin with scan numbers from 1, indices with stamps in ns, which may begin at 0.
std::optional<Format> format_of_file(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return std::nullopt;  // a FIFO may never have a line
  if (is_hdf5_file(file)) return Format::kHdf5;
  const std::string line = first_line(file);
  if (line.starts_with("CloudNo")) return Format::kDynabloxClouds;
  if (line.find("EvaluatedPoints") != std::string::npos) return Format::kDynabloxScores;
  const std::vector<std::uint64_t> numbers = first_numbers(file);
  if (numbers.empty()) return std::nullopt;
  const bool are_stamps = std::ranges::any_of(
      numbers, [](std::uint64_t number) { return number == 0 || number > kMostScans; });
  return are_stamps ? Format::kIndices : Format::kRows;
}

/// Recognises the format of a file that the user named; reading it reports what is wrong with it.
Format format_of_named(const fs::path& file) {
  return format_of_file(file).value_or(Format::kRows);
}

std::set<std::string> stems_of(const Sequence& sequence) {
  std::set<std::string> stems;
  for (std::size_t k = 0; k < sequence.size(); ++k) stems.insert(sequence.stem(k));
  return stems;
}

/// Whether files are named by position: none is named like a scan, and every position is there.
bool are_positions(const std::vector<fs::path>& files, const Sequence& sequence) {
  const std::set<std::string> stems = stems_of(sequence);
  std::set<std::uint64_t> positions;
  for (const fs::path& file : files) {
    const auto position = parse_unsigned(file.stem().string());
    if (stems.contains(file.stem().string()) || !position || *position >= sequence.size()) {
      return false;
    }
    positions.insert(*position);
  }
  return positions.size() == sequence.size();
}

/// Whether labels were written for points within a range only: most files are shorter than their
/// scans, none is longer.
bool are_masked(const std::vector<fs::path>& files, const Sequence& sequence) {
  std::set<std::string> names;
  for (const fs::path& file : files) names.insert(file.filename().string());
  std::size_t paired = 0;
  std::size_t shorter = 0;
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    if (!names.contains(sequence.stem(k) + ".label")) continue;
    std::error_code error;
    const auto bytes =
        fs::file_size(files.front().parent_path() / (sequence.stem(k) + ".label"), error);
    const std::uintmax_t full_bytes = sequence.point_count(k) * sizeof(std::uint32_t);
    if (error || bytes > full_bytes || bytes % sizeof(std::uint32_t) != 0) return false;
    ++paired;
    shorter += bytes < full_bytes ? 1 : 0;
  }
  return shorter >= 2 && 2 * shorter > paired;
}

Format label_format(const std::vector<fs::path>& files, const Sequence& sequence) {
  if (are_positions(files, sequence)) return Format::kLabelByIndex;
  return are_masked(files, sequence) ? Format::kMaskedLabel : Format::kLabel;
}

bool names_a_scan(const std::vector<fs::path>& files, const Sequence& sequence) {
  const std::set<std::string> stems = stems_of(sequence);
  return std::ranges::any_of(
      files, [&](const fs::path& file) { return stems.contains(file.stem().string()); });
}

/// Finds the one file for a whole sequence in a folder: one with a name of Dynablox's, of the
/// wanted format if there is one; otherwise the only table.
std::optional<fs::path> table_in(const fs::path& folder, std::optional<Format> wanted) {
  for (const char* name : {"clouds.csv", "scores.csv"}) {
    const fs::path file = folder / name;
    if (fs::is_regular_file(file) && (!wanted || format_of_file(file) == *wanted)) return file;
  }
  std::vector<fs::path> tables = files_with_extension(folder, ".txt");
  for (const fs::path& table : files_with_extension(folder, ".csv")) tables.push_back(table);
  if (!wanted || tables.size() > 1) {
    std::erase_if(tables, [](const fs::path& table) { return !format_of_file(table); });
  }
  if (tables.size() != 1) return std::nullopt;
  return tables.front();
}

/// Recognises predictions in files per scan.
std::optional<Format> format_per_scan(const fs::path& folder, const Sequence& sequence) {
  if (const auto labels = files_with_extension(folder, ".label"); !labels.empty()) {
    return label_format(labels, sequence);
  }
  if (!prediction_files({folder, Format::kNpy}).empty()) return Format::kNpy;
  for (const Format format : {Format::kPcd, Format::kText, Format::kCsv}) {
    const auto files = files_with_extension(folder, describe(format).extension);
    if (names_a_scan(files, sequence)) return format;
  }
  return std::nullopt;
}

/// Finds the predictions of the sequence in a folder, if there are any. Without a format it is
/// recognised.
std::optional<PredictionPlace> find_in(const fs::path& folder, const Sequence& sequence,
                                       std::optional<Format> format) {
  if (!format) {
    const auto found = format_per_scan(folder, sequence);
    if (found) return PredictionPlace{folder, *found};
  } else if (describe(*format).per_scan) {
    if (prediction_files({folder, *format}).empty()) return std::nullopt;
    return PredictionPlace{folder, *format};
  }
  const auto table = table_in(folder, format);
  if (!table) return std::nullopt;
  return PredictionPlace{*table, format ? *format : format_of_named(*table)};
}

bool is_truth(const fs::path& path, const Sequence& sequence) {
  return std::ranges::any_of(sequence.files(), [&](const fs::path& file) {
    std::error_code error;
    if (fs::equivalent(file, path, error)) return true;
    return file.extension() == ".label" && fs::equivalent(file.parent_path(), path, error);
  });
}

/// Recognises the predictions of the sequence below `root`; `only_sequence`, or in `root` itself.
std::optional<PredictionPlace> look_below(const fs::path& root, const Sequence& sequence,
                                          bool only_sequence, std::optional<Format> format) {
  for (const fs::path& folder : candidate_folders(root, sequence.name(), only_sequence)) {
    if (const auto found = find_in(folder, sequence, format)) return found;
  }
  return std::nullopt;
}

/// Lists the folders in `root` with predictions of the sequence, as `run --method all` makes them.
std::vector<std::string> runs_below(const fs::path& root, const Sequence& sequence,
                                    std::optional<Format> format) {
  std::vector<std::string> runs;
  if (!fs::is_directory(root)) return runs;
  for (const fs::path& folder : list_folders(root)) {
    const auto found = look_below(folder, sequence, false, format);
    if (found && !is_truth(found->path, sequence)) runs.push_back(folder.string());
  }
  return runs;
}

DataError nothing_found(const fs::path& root, const Sequence& sequence,
                        std::optional<Format> format) {
  const std::string wrong = "no predictions for sequence " + sequence.name();
  const std::vector<std::string> runs = runs_below(root, sequence, format);
  if (!runs.empty()) {
    return {root, wrong, fmt::format("a folder that holds some: {}", fmt::join(runs, ", "))};
  }
  return {root, wrong,
          "label files in <sequence>/predictions or <sequence>/labels, or another format that "
          "`mosbench list formats` shows"};
}

}  // namespace

void check_positions(const fs::path& path, const Sequence& sequence) {
  const Recording& recording = sequence.recording();
  const std::size_t left_out = recording.left_out.size() + recording.not_asked.size();
  if (left_out == 0) return;
  throw DataError(path,
                  fmt::format("names scans by their position, and {} of sequence {} are left out",
                              left_out, sequence.name()),
                  "files named like the scans, or all scans to be read");
}

std::vector<NamedFile> prediction_files(const PredictionPlace& place) {
  std::vector<NamedFile> files;
  const std::string_view extension = describe(place.format).extension;
  for (const fs::path& file : files_with_extension(place.path, extension)) {
    files.push_back({file.stem().string(), file});
  }
  if (place.format != Format::kNpy || !files.empty()) return files;
  for (const fs::path& folder : list_folders(place.path)) {
    const std::string scan = folder.filename().string();
    for (const fs::path& file : files_with_extension(folder, extension)) {
      if (file.filename().string().starts_with(scan + "_dt_")) files.push_back({scan, file});
    }
  }
  return files;
}

PredictionPlace find_predictions(const fs::path& root, const Sequence& sequence, bool only_sequence,
                                 std::optional<PredictionFormat> format) {
  std::optional<PredictionPlace> found;
  std::error_code error;
  if (!fs::exists(root, error)) {
    throw DataError(root, "does not exist", "a folder or file of predictions");
  }
  for (const char* extension : {".txt", ".csv", ".h5"}) {
    const fs::path file = root / (sequence.name() + extension);
    if (!found && fs::is_regular_file(file, error)) {
      found = PredictionPlace{file, format.value_or(format_of_named(file))};
    }
  }
  if (only_sequence && fs::is_regular_file(root, error)) {
    found = PredictionPlace{root, format.value_or(format_of_named(root))};
  }
  if (!found) found = look_below(root, sequence, only_sequence, format);
  if (!found) throw nothing_found(root, sequence, format);
  // An .h5 file may hold both.
  if (found->format != Format::kHdf5 && is_truth(found->path, sequence)) {
    throw DataError(found->path, "holds the truth of sequence " + sequence.name(),
                    "a folder of predictions");
  }
  return *found;
}

}  // namespace mosbench
