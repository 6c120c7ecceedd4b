#include "eval/predictions/predictions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>

#include "datasets/disk/files.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/text/text.hpp"
#include "eval/predictions/prediction_files.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

using Format = PredictionFormat;

constexpr std::array kFormats = {
    DescribedFormat{Format::kLabel, "label", ".label", true,
                    "uint32 per point, file named like its scan"},
    DescribedFormat{Format::kLabelByIndex, "label-index", ".label", true,
                    "uint32 per point, file named by the scan's position from 0 (HMM-MOS)"},
    DescribedFormat{Format::kMaskedLabel, "label-masked", ".label", true,
                    "uint32 per point within a range only (MapMOS, 4DMOS), label-masked:MIN,MAX"},
    DescribedFormat{Format::kText, "text", ".txt", true,
                    "a row per point: 0 or 1, or the three numbers of MOE, the second counts"},
    DescribedFormat{Format::kPcd, "pcd", ".pcd", true,
                    "intensity 0 or 1 (KTH) or a label id (ERASOR) per point"},
    DescribedFormat{Format::kCsv, "csv", ".csv", true,
                    "a row per point with a column label (id) or moving (0 or 1)"},
    DescribedFormat{Format::kNpy, "npy", ".npy", true,
                    "a confidence 0 to 1 per point, moving above 0.5 (4DMOS, also in its folders)"},
    DescribedFormat{Format::kRows, "rows", "", false,
                    "scan number from 1, then its moving points: HMM-MOS on DOALS"},
    DescribedFormat{Format::kIndices, "indices", ".csv", false,
                    "stamp in ns, then its moving points: as DOALS's indices.csv"},
    DescribedFormat{
        Format::kDynabloxClouds, "dynablox-clouds", ".csv", false,
        "clouds.csv of Dynablox, a row per point of each labelled scan, dynablox:LEVEL"},
    DescribedFormat{Format::kDynabloxScores, "dynablox-scores", ".csv", false,
                    "scores.csv of Dynablox, its own counts per labelled scan, dynablox:LEVEL"},
    DescribedFormat{Format::kHdf5, "h5", ".h5", false,
                    "dufo of each group of OpenSceneFlow's .h5, 0 or 1 per point; may be DATA"}};

constexpr std::size_t kListedIds = 8;

/// Bits of the smallest and the largest float32 that confidences, classes and ids have: 1e-12 to
/// 65535. A label with such bits would have an instance number above 11,000.
constexpr std::uint32_t kSmallestFloatBits = 0x2B8CBCCC;
constexpr std::uint32_t kLargestFloatBits = 0x477FFF00;
/// Of semantic-kitti-mos.yaml.
constexpr std::uint32_t kLargestId = 259;

bool may_be_float(std::uint32_t word) {
  const std::uint32_t magnitude = word & 0x7FFFFFFFU;
  return magnitude >= kSmallestFloatBits && magnitude <= kLargestFloatBits;
}

/// Returns the id in a label without its instance.
std::uint32_t id_of(std::uint32_t label) { return label & 0xFFFFU; }

bool is_id(std::uint32_t id) { return id > 0 && id <= kLargestId; }

/// Returns the encoding that gives all labels but 0 a meaning, if it is not uint32; else nothing.
std::string other_encoding(const std::vector<std::uint32_t>& labels) {
  bool any = false;
  bool floats = true;
  bool big_endian = true;
  bool small_id = false;
  for (const std::uint32_t label : labels) {
    if (label == 0) continue;
    any = true;
    floats = floats && may_be_float(label);
    const std::uint32_t reversed_id = id_of(__builtin_bswap32(label));
    big_endian = big_endian && is_id(reversed_id) && !is_id(id_of(label));
    // Larger ones could be instances of id 0.
    small_id = small_id || reversed_id < 256;
    if (!floats && !big_endian) return "";
  }
  if (!any) return "";
  if (floats) return "float32";
  return small_id ? "big-endian uint32" : "";
}

/// Writes thousands separators: "1,234,567".
std::string with_commas(std::uint64_t number) {
  std::string digits = fmt::format("{}", number);
  for (std::size_t at = digits.size(); at > 3; at -= 3) digits.insert(at - 3, 1, ',');
  return digits;
}

/// Returns "0 (8,640 points), 251 (12 points)", of more than eight ids those of most points.
std::string ids_text(std::span<const PredictedId> ids) {
  std::vector<PredictedId> listed(ids.begin(), ids.end());
  std::ranges::stable_sort(listed, std::ranges::greater(), &PredictedId::points);
  listed.resize(std::min(listed.size(), kListedIds));
  std::ranges::sort(listed, std::ranges::less(), &PredictedId::id);
  std::string text;
  for (const PredictedId& id : listed) {
    text +=
        fmt::format("{}{} ({} points)", text.empty() ? "" : ", ", id.id, with_commas(id.points));
  }
  if (ids.size() > listed.size()) text += fmt::format(" and {} more", ids.size() - listed.size());
  return text;
}

/// Returns "251 to 259" of the ids that count as moving.
std::string moving_ids(const Protocol& protocol) {
  std::string text;
  for (const IdRange& range : protocol.prediction.ranges) {
    if (range.becomes != TruthClass::kMoving) continue;
    text += text.empty() ? "" : ", ";
    text += range.first == range.last ? fmt::format("{}", range.first)
                                      : fmt::format("{} to {}", range.first, range.last);
  }
  return text;
}

DataError no_rows(const PredictionPlace& place, const std::string& first, const std::string& last) {
  const std::string scans = first == last ? "scan " + first : "scans " + first + " to " + last;
  return {place.path, "has no row for " + scans, "a row for every scan with truth"};
}

DataError no_files(const std::filesystem::path& first, const std::filesystem::path& last) {
  const std::string wrong = first == last ? "is not there"
                                          : fmt::format("is not there, nor what follows up to {}",
                                                        last.filename().string());
  return {first, wrong, "a prediction for every scan with truth"};
}

/// Returns the stems of wanted scans without prediction and reports each stretch of them.
std::vector<std::string> missing_scans(const Predictions& labels, const PredictionPlace& place,
                                       const Sequence& sequence,
                                       const std::vector<std::size_t>& wanted,
                                       PredictionErrors& errors) {
  const DescribedFormat& format = describe(place.format);
  const auto stem = [&](std::size_t i) { return sequence.stem(wanted[i]); };
  const auto file = [&](std::size_t i) {
    const bool by_position = place.format == PredictionFormat::kLabelByIndex;
    const std::string name = by_position ? fmt::format("{:06d}", wanted[i]) : stem(i);
    return place.path / (name + std::string(format.extension));
  };
  // A file that exists was bad, which has been reported.
  const auto is_unreported = [&](std::size_t i) {
    return !labels.has(wanted[i]) && !(format.per_scan && is_there(file(i)));
  };
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (!is_unreported(i)) continue;
    const std::size_t first = i;
    while (i + 1 < wanted.size() && is_unreported(i + 1)) ++i;
    errors.report(format.per_scan ? no_files(file(first), file(i))
                                  : no_rows(place, stem(first), stem(i)));
  }
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (!labels.has(wanted[i])) missing.push_back(stem(i));
  }
  return missing;
}

/// Labels with a given mask are read as cut by range even if no file is shorter than its scan.
PredictionFormat settle_format(PredictionFormat found, const PredictionOptions& options) {
  if (!options.mask || found == PredictionFormat::kMaskedLabel) return found;
  if (found == PredictionFormat::kLabel && !options.format) return PredictionFormat::kMaskedLabel;
  throw UsageError(fmt::format("--format {}: a range is not for format {}, expected none",
                               describe(PredictionFormat::kMaskedLabel).name,
                               describe(found).name));
}

}  // namespace

std::span<const DescribedFormat> prediction_formats() { return kFormats; }

const DescribedFormat& describe(PredictionFormat format) {
  return *std::ranges::find(kFormats, format, &DescribedFormat::format);
}

PredictionFormat prediction_format_named(std::string_view name) {
  const auto found = std::ranges::find(kFormats, name, &DescribedFormat::name);
  if (found != kFormats.end()) return found->format;
  std::string names;
  for (const DescribedFormat& format : kFormats) {
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  }
  throw UsageError(fmt::format("--format: '{}' is not known, expected one of {}", name, names));
}

std::string_view to_string(DynabloxLevel level) {
  constexpr std::string_view kNames[] = {"point", "cluster", "object"};
  return kNames[static_cast<std::size_t>(level)];
}

DynabloxLevel dynablox_level_named(std::string_view name) {
  for (const DynabloxLevel level :
       {DynabloxLevel::kPoint, DynabloxLevel::kCluster, DynabloxLevel::kObject}) {
    if (name == to_string(level)) return level;
  }
  throw UsageError(
      fmt::format("--format dynablox: '{}' is not known, expected point, cluster or object", name));
}

namespace {

std::vector<std::uint32_t> read_raw_ids(const fs::path& file) {
  const std::string bytes = read_file(file);
  return parse_labels(bytes, bytes.size() / sizeof(std::uint32_t), file);
}

}  // namespace

std::vector<PredictedId> ids_in(std::span<const fs::path> files) {
  std::vector<std::uint64_t> points(65536, 0);
  std::vector<const fs::path*> first_file(points.size(), nullptr);
  for (const fs::path& file : files) {
    const auto labels = file.extension() == ".npy" ? read_npy_ids(file) : read_raw_ids(file);
    if (const std::string encoding = other_encoding(labels); !encoding.empty()) {
      throw DataError(file, "holds " + encoding, "a little-endian uint32 label id per point");
    }
    for (const std::uint32_t label : labels) {
      const std::size_t id = label & 0xFFFFU;
      if (points[id]++ == 0) first_file[id] = &file;
    }
  }
  std::vector<PredictedId> ids;
  for (std::size_t id = 0; id < points.size(); ++id) {
    if (points[id] > 0)
      ids.push_back({static_cast<std::uint16_t>(id), points[id], *first_file[id]});
  }
  return ids;
}

std::string strange_share(std::uint64_t moving, std::uint64_t points,
                          std::span<const PredictedId> ids, const Protocol& protocol) {
  if (points == 0 || (moving > 0 && 2 * moving <= points)) return "";
  std::string text =
      moving == 0 ? "no point is predicted moving"
                  : fmt::format("{:.1f} % of the points are predicted moving",
                                100.0 * static_cast<double>(moving) / static_cast<double>(points));
  if (ids.empty()) return text;
  return text + fmt::format("; the files hold ids {}; under protocol {} ids {} are moving",
                            ids_text(ids), protocol.name, moving_ids(protocol));
}

std::string id_map_text(const LabelIdMap& map) {
  std::string text;
  for (const auto& [from, to] : map) {
    text += fmt::format("{}{}:{}", text.empty() ? "" : ",", from, to);
  }
  return text;
}

LabelIdMap parse_id_map(const std::string& text) {
  LabelIdMap map;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::string_view pair = rest.substr(0, rest.find(','));
    const std::size_t colon = pair.find(':');
    const auto from = parse_unsigned(trim(pair.substr(0, colon)));
    const auto to = colon == std::string_view::npos ? std::nullopt
                                                    : parse_unsigned(trim(pair.substr(colon + 1)));
    if (!from || !to || *from > 0xFFFF || *to > 0xFFFF) break;
    map[static_cast<std::uint16_t>(*from)] = static_cast<std::uint16_t>(*to);
    if (pair.size() == rest.size()) return map;
    rest.remove_prefix(pair.size() + 1);
  }
  throw UsageError(fmt::format(
      "--id-map: '{}' is no map of ids, expected FROM:TO,... such as 0:0,1:9,2:251", text));
}

DataError OpenedPredictions::with_format(const DataError& error) const {
  return DataError(fmt::format("{} (read in format {}{})", error.what(), describe(format).name,
                               guessed ? ", recognised; --format overrides" : ""));
}

OpenedPredictions open_predictions(const std::filesystem::path& root, const Sequence& sequence,
                                   const std::vector<std::size_t>& wanted, bool only_sequence,
                                   const PredictionOptions& options) {
  PredictionPlace place = find_predictions(root, sequence, only_sequence, options.format);
  place.format = settle_format(place.format, options);
  PredictionErrors errors(options.allow_missing);
  OpenedPredictions opened{nullptr, place.format, !options.format, place.path, {}, {}};
  try {
    opened.labels = describe(place.format).per_scan
                        ? open_scan_files(place, sequence, wanted, options, errors, opened.remarks)
                        : open_sequence_file(place, sequence, options, errors);
    opened.missing = missing_scans(*opened.labels, place, sequence, wanted, errors);
  } catch (const DataError& error) {
    throw opened.with_format(error);
  }
  opened.remarks.insert(opened.remarks.end(), errors.texts().begin(), errors.texts().end());
  return opened;
}

}  // namespace mosbench
