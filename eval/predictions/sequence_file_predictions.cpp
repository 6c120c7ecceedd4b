#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/hdf5/flow_truth.hpp"
#include "datasets/hdf5/hdf5_file.hpp"
#include "datasets/text/text.hpp"
#include "eval/predictions/prediction_files.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

void check_rows(std::size_t rows, const std::vector<std::size_t>& scans, const fs::path& file) {
  if (rows == scans.size()) return;
  throw DataError(file, fmt::format("has {} scans", rows),
                  fmt::format("one for each labelled scan of the sequence, {}", scans.size()));
}

using Labels = std::vector<std::uint32_t>;

/// What one file says of scans.
class ScansOfFile : public Predictions {
 public:
  bool has(std::size_t scan_index) const override { return labels.contains(scan_index); }
  Labels read(std::size_t scan_index) const override { return labels.at(scan_index)(); }
  std::optional<Confusion> counts(std::size_t scan_index) const override {
    const auto found = counted.find(scan_index);
    return found == counted.end() ? std::nullopt : std::optional(found->second);
  }

  std::map<std::size_t, std::function<Labels()>> labels;
  std::map<std::size_t, Confusion> counted;
};

std::function<Labels()> labels_of(IndicesRow row, std::size_t points, const fs::path& file) {
  check_indices(row, points, file);
  return [moving = std::move(row.moving), points] {
    Labels labels(points, kStaticLabel);
    for (const std::uint32_t index : moving) labels.at(index) = kMovingLabel;
    return labels;
  };
}

std::unique_ptr<Predictions> open_rows(const fs::path& file, const Sequence& sequence,
                                       PredictionErrors& errors) {
  check_positions(file, sequence);
  auto scans = std::make_unique<ScansOfFile>();
  for (IndicesRow& row : read_indices(file)) {
    const auto number = static_cast<std::size_t>(row.stamp_ns);
    if (number == 0 || number > sequence.size()) {
      errors.report(DataError(file, row.line, fmt::format("is of scan {}", number),
                              fmt::format("scans 1 to {}", sequence.size())));
      continue;
    }
    scans->labels[number - 1] = labels_of(std::move(row), sequence.point_count(number - 1), file);
  }
  return scans;
}

bool is_not_asked(const Sequence& sequence, std::int64_t stamp_ns) {
  return std::ranges::any_of(sequence.recording().not_asked,
                             [&](const ScanEntry& scan) { return scan.stamp_ns == stamp_ns; });
}

/// Pairs rows by exact stamp where the scans have stamps, otherwise in order.
std::unique_ptr<Predictions> open_indices(const fs::path& file, const Sequence& sequence,
                                          PredictionErrors& errors) {
  const std::vector<std::size_t> scans = scans_with_truth(sequence);
  std::vector<IndicesRow> found = read_indices(file);
  std::map<std::int64_t, std::size_t> by_stamp;
  for (const std::size_t k : scans) {
    if (const auto stamp_ns = sequence.read(k).stamp_ns) by_stamp[*stamp_ns] = k;
  }
  if (by_stamp.empty()) check_rows(found.size(), scans, file);
  auto labelled = std::make_unique<ScansOfFile>();
  for (std::size_t r = 0; r < found.size(); ++r) {
    const auto stamped = by_stamp.find(found[r].stamp_ns);
    if (!by_stamp.empty() && stamped == by_stamp.end()) {
      if (is_not_asked(sequence, found[r].stamp_ns)) continue;
      errors.report(DataError(file, found[r].line, fmt::format("has stamp {}", found[r].stamp_ns),
                              "that of a labelled scan"));
      continue;
    }
    const std::size_t k = by_stamp.empty() ? scans[r] : stamped->second;
    labelled->labels[k] = labels_of(std::move(found[r]), sequence.point_count(k), file);
  }
  return labelled;
}

/// Throws DataError unless the rows of Dynablox's scores.csv are of the labelled scans, in order:
/// all sequences of DOALS have ten, of as many points.
void check_stamps(const std::vector<std::uint64_t>& stamps_ns, const Sequence& sequence,
                  const std::vector<std::size_t>& scans, const fs::path& file) {
  for (std::size_t i = 0; i < std::min(stamps_ns.size(), scans.size()); ++i) {
    const auto expected_ns = sequence.stamp_ns(scans[i]);
    if (!expected_ns) {
      throw DataError(file,
                      fmt::format("cannot be compared with sequence {}, whose scans have no stamps",
                                  sequence.name()),
                      "times.txt beside the scans, or scans named by their time in ns");
    }
    if (std::cmp_equal(stamps_ns[i], *expected_ns)) continue;
    throw DataError(
        file, i + 2, fmt::format("has stamp {}", stamps_ns[i]),
        fmt::format("that of labelled scan {}, {}", sequence.stem(scans[i]), *expected_ns));
  }
  check_rows(stamps_ns.size(), scans, file);
}

std::unique_ptr<Predictions> open_clouds(const fs::path& file, const Sequence& sequence,
                                         DynabloxLevel level) {
  const std::vector<std::size_t> scans = scans_with_truth(sequence);
  auto parsed = parse_dynablox_clouds(read_file(file), level, file);
  check_rows(parsed.size(), scans, file);
  // Dynablox writes a row there for every cloud here, which has no stamp itself.
  const fs::path scores = fs::path(file).replace_filename("scores.csv");
  if (!is_there(scores)) {
    throw DataError(scores, "does not exist", "the stamps of the clouds in clouds.csv");
  }
  check_stamps(parse_dynablox_stamps_ns(read_file(scores), scores), sequence, scans, scores);
  auto clouds = std::make_unique<ScansOfFile>();
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (parsed[i].size() != sequence.point_count(scans[i])) {
      throw DataError(file, fmt::format("has {} points in cloud {}", parsed[i].size(), i),
                      fmt::format("those of scan {}, {}", sequence.stem(scans[i]),
                                  sequence.point_count(scans[i])));
    }
    clouds->labels[scans[i]] = [labels = std::move(parsed[i])] { return labels; };
  }
  return clouds;
}

std::unique_ptr<Predictions> open_scores(const fs::path& file, const Sequence& sequence,
                                         DynabloxLevel level) {
  const std::vector<std::size_t> scans = scans_with_truth(sequence);
  const std::string text = read_file(file);
  const auto scores = parse_dynablox_counts(text, level, file);
  check_stamps(parse_dynablox_stamps_ns(text, file), sequence, scans, file);
  auto counts = std::make_unique<ScansOfFile>();
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (scores[i].total_points != sequence.point_count(scans[i])) {
      throw DataError(file, i + 2, fmt::format("is of {} points", scores[i].total_points),
                      fmt::format("those of scan {}, {}", sequence.stem(scans[i]),
                                  sequence.point_count(scans[i])));
    }
    counts->counted[scans[i]] = scores[i].counts;
    counts->labels[scans[i]] = [file]() -> Labels {
      throw DataError(file, "holds counts, no labels", "labels, which this command needs");
    };
  }
  return counts;
}

Labels read_dufo(const Hdf5File& file, const Hdf5Group& group) {
  Labels labels;
  for (const std::int64_t moves : file.integers(group, group.arrays.front())) {
    if (moves != 0 && moves != 1) {
      throw DataError(
          file.path(),
          fmt::format("{} of group {} holds {}", group.arrays.front().name, group.name, moves),
          "0 (static) or 1 (moving)");
    }
    labels.push_back(moves == 1 ? kMovingLabel : kStaticLabel);
  }
  return labels;
}

std::unique_ptr<Predictions> open_dufo(const fs::path& path, const Sequence& sequence,
                                       PredictionErrors& errors) {
  constexpr std::array kNames = {scene_flow::kDufo, scene_flow::kOlderDufo};
  const auto file = std::make_shared<Hdf5File>(path, kNames);
  std::map<std::string, std::size_t> scans;
  for (std::size_t k = 0; k < sequence.size(); ++k) scans[sequence.stem(k)] = k;
  auto labelled = std::make_unique<ScansOfFile>();
  for (const Hdf5Group& group : file->groups()) {
    if (group.arrays.empty() || is_left_out(sequence.recording(), group.name)) continue;
    const auto scan = scans.find(group.name);
    if (scan == scans.end()) {
      errors.report(DataError(path, "group " + shown_in_line(group.name) + " is of no scan",
                              "groups named as those of sequence " + sequence.name()));
      continue;
    }
    const std::size_t points = sequence.point_count(scan->second);
    if (const std::size_t values = count_of(group.arrays.front()); values != points) {
      throw DataError(path,
                      fmt::format("{} of group {} has {} values", group.arrays.front().name,
                                  group.name, values),
                      fmt::format("one per point of the scan, {}", points));
    }
    labelled->labels[scan->second] = [file, &group] { return read_dufo(*file, group); };
  }
  return labelled;
}

}  // namespace

std::unique_ptr<Predictions> open_sequence_file(const PredictionPlace& place,
                                                const Sequence& sequence,
                                                const PredictionOptions& options,
                                                PredictionErrors& errors) {
  switch (place.format) {
    case PredictionFormat::kIndices:
      return open_indices(place.path, sequence, errors);
    case PredictionFormat::kDynabloxClouds:
      return open_clouds(place.path, sequence, options.level);
    case PredictionFormat::kDynabloxScores:
      return open_scores(place.path, sequence, options.level);
    case PredictionFormat::kHdf5:
      return open_dufo(place.path, sequence, errors);
    default:
      return open_rows(place.path, sequence, errors);
  }
}

}  // namespace mosbench
