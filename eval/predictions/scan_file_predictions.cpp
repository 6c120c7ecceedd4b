#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/pcd_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/predictions/prediction_files.hpp"
#include "eval/protocols/confusion.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

using Format = PredictionFormat;
using Files = std::map<std::size_t, fs::path>;  // by scan

// Limits that configurations of published methods use.
constexpr std::array kLowest_m = {0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0};
constexpr std::array kHighest_m = {-1.0, 20.0, 25.0, 30.0,  40.0,  50.0,  60.0,
                                   70.0, 75.0, 80.0, 100.0, 120.0, 150.0, 200.0};

/// A scan and the number of labels that a method with a range limit wrote for it.
struct MaskedScan {
  fs::path file;
  std::size_t labels;
  std::vector<Point> points;
};

std::vector<double> ranges_of(const MaskedScan& scan) {
  std::vector<double> ranges_m;
  for (const Point& point : scan.points) ranges_m.push_back(range_m(point, Arithmetic::kDouble));
  std::ranges::sort(ranges_m);
  return ranges_m;
}

/// Returns the first and one past the last position of the sorted ranges within the mask.
std::pair<std::size_t, std::size_t> within(const std::vector<double>& ranges_m,
                                           const RangeGate& mask) {
  const auto first = std::ranges::lower_bound(ranges_m, mask.min_m);
  const auto last =
      mask.max_m <= 0.0 ? ranges_m.end() : std::ranges::upper_bound(ranges_m, mask.max_m);
  return {static_cast<std::size_t>(first - ranges_m.begin()),
          static_cast<std::size_t>(last - ranges_m.begin())};
}

/// Finds the range limits, among the usual ones of methods, that leave as many points of every scan
/// as there are labels. Throws DataError if none does, or if several do that leave different
/// points.
RangeGate find_mask(std::span<const MaskedScan> scans) {
  std::vector<std::vector<double>> sorted;
  for (const MaskedScan& scan : scans) sorted.push_back(ranges_of(scan));
  std::optional<RangeGate> found;
  for (const double min_m : kLowest_m) {
    for (const double max_m : kHighest_m) {
      const RangeGate mask{min_m, max_m};
      bool fits = true;
      bool same_points = true;
      for (std::size_t i = 0; i < scans.size() && fits; ++i) {
        const auto [first, end] = within(sorted[i], mask);
        fits = end >= first && end - first == scans[i].labels;
        same_points = same_points && found && within(sorted[i], *found) == std::pair{first, end};
      }
      if (!fits) continue;
      if (found && !same_points) {
        throw DataError(scans.front().file, "fits several range limits",
                        "--format label-masked:MIN,MAX");
      }
      if (!found) found = mask;
    }
  }
  if (found) return *found;
  throw DataError(
      scans.front().file,
      fmt::format("has {} labels for {} points, and no common range limits leave that many",
                  scans.front().labels, scans.front().points.size()),
      "a label per point, or --format label-masked:MIN,MAX");
}

/// Returns one label per point: those given for the points within `mask`, static for the rest.
std::vector<std::uint32_t> spread_over_scan(std::span<const std::uint32_t> labels,
                                            std::span<const Point> points, const RangeGate& mask,
                                            const fs::path& file) {
  std::vector<std::uint32_t> spread(points.size(), kStaticLabel);
  std::size_t used = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!mask.contains(range_m(points[i], Arithmetic::kDouble))) continue;
    if (used < labels.size()) spread[i] = labels[used];
    ++used;
  }
  if (used == labels.size()) return spread;
  throw DataError(file, fmt::format("has {} labels", labels.size()),
                  fmt::format("one for each of the {} points {}", used, gate_text(mask)));
}

constexpr std::size_t kScansToGuessFrom = 5;

/// Classes of semantic-kitti-mos.yaml: 0 unlabelled, 1 static, 2 moving.
const LabelIdMap kLearningIds = {{0, 0}, {1, 9}, {2, 251}};

/// KTH writes 0 or 1 as intensity, ERASOR the label's number.
std::uint32_t label_of_intensity(float intensity, const fs::path& file) {
  if (intensity == 1.0F) return kMovingLabel;
  if (intensity == 0.0F) return kStaticLabel;
  if (intensity > 1.0F && intensity < 4294967040.0F && intensity == std::floor(intensity)) {
    return static_cast<std::uint32_t>(intensity);
  }
  throw DataError(file, fmt::format("has intensity {}", intensity), "0, 1 or a label id");
}

std::vector<std::uint32_t> read_pcd_labels(const fs::path& file, std::size_t point_count) {
  std::vector<std::uint32_t> labels;
  for (const Point& point : read_pcd(file)) {
    labels.push_back(label_of_intensity(point.intensity, file));
  }
  if (labels.size() == point_count) return labels;
  throw DataError(file, fmt::format("has {} points", labels.size()),
                  fmt::format("those of its scan, {}", point_count));
}

/// Reads the labels of a file of any length.
std::vector<std::uint32_t> read_any_labels(const fs::path& file) {
  const std::string bytes = read_file(file);
  return parse_labels(bytes, bytes.size() / sizeof(std::uint32_t), file);
}

class ScanFiles : public Predictions {
 public:
  ScanFiles(const Sequence& sequence, Format format, Files files)
      : sequence_(sequence), format_(format), files_(std::move(files)) {}

  bool has(std::size_t scan_index) const override { return files_.contains(scan_index); }

  std::vector<std::uint32_t> read(std::size_t scan_index) const override {
    if (has_confidences()) return labels(scan_index, confidences(scan_index));
    const fs::path& file = files_.at(scan_index);
    return mapped(read_stored(file, scan_index), file);
  }

  std::vector<std::uint32_t> labels(std::size_t scan_index,
                                    std::span<const double> confidences) const override {
    if (!has_confidences()) return read(scan_index);
    return mapped(labels_of_confidences(confidences), files_.at(scan_index));
  }

  std::vector<double> confidences(std::size_t scan_index) const override {
    if (!has_confidences()) return {};
    return read_npy_confidences(files_.at(scan_index), sequence_.point_count(scan_index));
  }

  std::span<const PredictedId> ids() const override { return ids_; }
  const Files& files() const { return files_; }
  void set_ids(std::vector<PredictedId> ids) { ids_ = std::move(ids); }
  void set_npy_kind(NumpyKind kind) { npy_kind_ = kind; }
  bool has_ids() const {
    return describe(format_).extension == ".label" || (is_npy() && !has_confidences());
  }
  void set_mask(const RangeGate& mask) { mask_ = mask; }
  void set_id_map(const LabelIdMap& map) { id_map_ = map; }

 private:
  bool is_npy() const { return format_ == Format::kNpy; }
  bool has_confidences() const { return is_npy() && npy_kind_ != NumpyKind::kIntegers; }

  std::vector<std::uint32_t> read_stored(const fs::path& file, std::size_t scan_index) const {
    const std::size_t points = sequence_.point_count(scan_index);
    switch (format_) {
      case Format::kText:
        return parse_point_text(read_file(file), points, file);
      case Format::kCsv:
        return parse_point_csv(read_file(file), points, file);
      case Format::kPcd:
        return read_pcd_labels(file, points);
      case Format::kNpy:
        return read_npy_labels(file, points);
      case Format::kMaskedLabel:
        return spread_over_scan(read_any_labels(file), sequence_.read(scan_index).points, mask_,
                                file);
      default:
        return read_labels(file, points);
    }
  }

  std::vector<std::uint32_t> mapped(std::vector<std::uint32_t> labels, const fs::path& file) const {
    if (id_map_.empty()) return labels;
    for (std::uint32_t& label : labels) {
      const auto found = id_map_.find(static_cast<std::uint16_t>(label & 0xFFFFU));
      if (found == id_map_.end()) {
        throw DataError(file, fmt::format("has id {}", label & 0xFFFFU),
                        "one that the id map maps");
      }
      label = found->second;
    }
    return labels;
  }

  const Sequence& sequence_;
  Format format_;
  Files files_;
  NumpyKind npy_kind_ = NumpyKind::kReals;
  RangeGate mask_;
  LabelIdMap id_map_;
  std::vector<PredictedId> ids_;
};

/// Returns the scan that a file is named after, or nothing.
class ScanOfFile {
 public:
  ScanOfFile(const Sequence& sequence, Format format)
      : by_position_(format == Format::kLabelByIndex) {
    for (std::size_t k = 0; k < sequence.size(); ++k) scans_[name_of(sequence.stem(k), k)] = k;
  }
  std::optional<std::size_t> operator()(const std::string& stem) const {
    const auto found = scans_.find(name_of(stem, stem_number(stem)));
    if (found == scans_.end()) return std::nullopt;
    return found->second;
  }

 private:
  /// Names by position may have any number of zeros in front: 0, 000000.
  std::string name_of(const std::string& stem, std::optional<std::uint64_t> number) const {
    return by_position_ && number ? fmt::format("{}", *number) : stem;
  }
  bool by_position_;
  std::map<std::string, std::size_t> scans_;
};

/// Returns " (it fits scan 000000, 10 earlier)" for the nearest scan of that many bytes of labels
/// within 10 scans; empty when there is none.
std::string fitting_scan(const Sequence& sequence, std::size_t scan_index, std::uintmax_t bytes) {
  for (std::size_t n = 1; n <= 10; ++n) {
    for (const bool later : {false, true}) {
      if (later ? scan_index + n >= sequence.size() : scan_index < n) continue;
      const std::size_t other = later ? scan_index + n : scan_index - n;
      if (sequence.point_count(other) * sizeof(std::uint32_t) != bytes) continue;
      return fmt::format(" (it fits scan {}, {} {})", sequence.stem(other), n,
                         later ? "later" : "earlier");
    }
  }
  return "";
}

bool has_right_size(const fs::path& file, Format format, const Sequence& sequence,
                    std::size_t scan_index, PredictionErrors& errors) {
  if (format != Format::kLabel && format != Format::kLabelByIndex) return true;
  const std::uintmax_t bytes = size_of(file);
  try {
    check_label_size(bytes, sequence.point_count(scan_index), file);
    return true;
  } catch (const DataError& error) {
    errors.report(DataError(error.what() + fitting_scan(sequence, scan_index, bytes)));
    return false;
  }
}

Files pair(const PredictionPlace& place, const Sequence& sequence, PredictionErrors& errors) {
  if (place.format == Format::kLabelByIndex) check_positions(place.path, sequence);
  const ScanOfFile scan_of(sequence, place.format);
  Files files;
  for (const auto& [name, file] : prediction_files(place)) {
    const std::string stem = shown_in_line(name);
    const std::optional<std::size_t> scan = scan_of(stem);
    if (!scan && is_left_out(sequence.recording(), stem)) continue;
    if (!scan) {
      errors.report(DataError(file, "belongs to no scan of sequence " + sequence.name(),
                              "only labels named like its scans"));
    } else if (files.contains(*scan)) {
      errors.report(DataError(file, "is of the same scan as " + files.at(*scan).string(),
                              "one file per scan"));
    } else if (has_right_size(file, place.format, sequence, *scan, errors)) {
      files[*scan] = file;
    }
  }
  return files;
}

std::vector<std::size_t> sample_of(const std::vector<std::size_t>& wanted, const Files& files) {
  std::vector<std::size_t> sample;
  for (const std::size_t k : wanted) {
    if (files.contains(k)) sample.push_back(k);
  }
  // From the middle of the sequence, where motion is most likely.
  if (sample.size() > kScansToGuessFrom) {
    sample.erase(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(
                                                      (sample.size() - kScansToGuessFrom) / 2));
    sample.resize(kScansToGuessFrom);
  }
  return sample;
}

RangeGate mask_of_sample(const Files& files, const Sequence& sequence,
                         const std::vector<std::size_t>& sample) {
  std::vector<MaskedScan> scans;
  for (const std::size_t k : sample) {
    scans.push_back(
        {files.at(k), size_of(files.at(k)) / sizeof(std::uint32_t), sequence.read(k).points});
  }
  return find_mask(scans);
}

std::vector<PredictedId> ids_of_wanted(const Files& files, const std::vector<std::size_t>& wanted) {
  std::vector<fs::path> wanted_files;
  for (const std::size_t k : wanted) {
    if (const auto file = files.find(k); file != files.end()) wanted_files.push_back(file->second);
  }
  return ids_in(wanted_files);
}

/// Returns what the arrays of all wanted scans hold. Throws DataError naming the first one that
/// holds something else than those before.
NumpyKind shared_kind(const Files& files, const std::vector<std::size_t>& wanted) {
  constexpr std::array kWords = {"booleans", "integers", "reals"};
  const auto words = [&](NumpyKind kind) { return kWords.at(static_cast<std::size_t>(kind)); };
  std::optional<NumpyKind> shared;
  for (const std::size_t k : wanted) {
    const auto file = files.find(k);
    if (file == files.end()) continue;
    const NumpyKind kind = read_npy_kind(file->second);
    if (!shared) shared = kind;
    if (kind == *shared) continue;
    throw DataError(file->second,
                    fmt::format("holds {}, and those before {}", words(kind), words(*shared)),
                    "label ids in all files (integers), or confidences (reals)");
  }
  return shared.value_or(NumpyKind::kReals);
}

/// Returns the id map when the files hold class numbers instead of label ids. Ids 0 and 1 alone may
/// be flags, or the classes of a network that found nothing moving: nobody guesses which.
std::optional<LabelIdMap> guess_id_map(const std::vector<PredictedId>& ids,
                                       const fs::path& folder) {
  if (ids.empty() || ids.back().id > 2 || ids.back().id == 0) return std::nullopt;
  if (ids.back().id == 2) return kLearningIds;
  throw DataError(folder, "holds no other ids than 0 and 1",
                  "label ids, or `mosbench score --id-map` with their meaning (0:9,1:251)");
}

/// Throws DataError for the first id that the map does not name.
void check_mapped(const std::vector<PredictedId>& ids, const LabelIdMap& map) {
  std::vector<std::string> known;
  for (const auto& [from, to] : map) known.push_back(fmt::format("{}", from));
  for (const PredictedId& id : ids) {
    if (map.contains(id.id)) continue;
    throw DataError(id.first_file,
                    fmt::format("holds id {} ({} points in all files)", id.id, id.points),
                    "only ids that the id map names: " + fmt::format("{}", fmt::join(known, ", ")));
  }
}

}  // namespace

std::unique_ptr<Predictions> open_scan_files(const PredictionPlace& place, const Sequence& sequence,
                                             const std::vector<std::size_t>& wanted,
                                             const PredictionOptions& options,
                                             PredictionErrors& errors,
                                             std::vector<std::string>& remarks) {
  auto labels = std::make_unique<ScanFiles>(sequence, place.format, pair(place, sequence, errors));
  const std::vector<std::size_t> sample = sample_of(wanted, labels->files());
  if (sample.empty()) return labels;
  if (place.format == Format::kMaskedLabel) {
    const RangeGate mask =
        options.mask ? *options.mask : mask_of_sample(labels->files(), sequence, sample);
    labels->set_mask(mask);
    remarks.push_back("labels are for points " + gate_text(mask) + " only; all others are static");
  }
  if (place.format == Format::kNpy) labels->set_npy_kind(shared_kind(labels->files(), wanted));
  const bool has_ids = labels->has_ids();
  std::vector<PredictedId> ids;
  if (has_ids) ids = ids_of_wanted(labels->files(), wanted);
  if (options.id_map) {
    check_mapped(ids, *options.id_map);
    labels->set_id_map(*options.id_map);
  } else if (has_ids) {
    if (const auto guessed = guess_id_map(ids, place.path)) {
      labels->set_id_map(*guessed);
      remarks.push_back("ids 0, 1 and 2 taken for a network's classes: " + id_map_text(*guessed));
    }
  }
  labels->set_ids(std::move(ids));
  return labels;
}

}  // namespace mosbench
