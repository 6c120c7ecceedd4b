#include "eval/truth/track_counts.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/formats/label_file.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/text/errors.hpp"
#include "eval/result/result_scans.hpp"
#include "eval/truth/completion.hpp"
#include "eval/truth/track_edits.hpp"

namespace mosbench {
namespace {

/// Which track has a number, from 1; 0 for those that are decided static, which complete nothing.
struct TrackIndex {
  std::uint32_t index = 0, completing = 0;
};
using TrackIndices = std::map<std::uint32_t, TrackIndex>;

TrackIndices indices_of(const TruthFolder& truth, const std::string& sequence) {
  TrackIndices indices;
  for (std::uint32_t i = 0; i < truth.tracks.size(); ++i) {
    const TruthTrack& track = truth.tracks[i];
    if (track.sequence != sequence) continue;
    const auto decided = truth.decided.find(track.id());
    const bool stands = decided != truth.decided.end() && decided->second == Decided::kStatic;
    indices[track.number] = {i + 1, stands ? 0 : i + 1};
  }
  return indices;
}

void count_scan(const JudgedScan& scan, std::span<const Eigen::Vector3d> positions_m,
                std::span<const std::uint32_t> objects, const TrackIndices& indices,
                TrackCounts& counts) {
  std::vector<std::uint32_t> tracks(objects.size(), 0), completing(objects.size(), 0);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const auto found = indices.find(objects[i]);
    if (found == indices.end()) continue;
    tracks[i] = found->second.index;
    completing[i] = found->second.completing;
  }
  const std::vector<std::uint32_t> completed = completed_by(positions_m, completing);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const double called = is_labelled_moving(scan.outcomes[i]) ? 1 : 0;
    const std::uint32_t track = tracks[i] != 0 ? tracks[i] : completed[i];
    if (track == 0) {
      counts.elsewhere += called;
    } else {
      counts.moving[track - 1] += called;
      counts.all[track - 1] += 1;
    }
  }
}

void count_sequence(const TruthFolder& truth, const Result& run, const Result& result,
                    const std::optional<std::filesystem::path>& data, TrackCounts& counts) {
  const ResultScans scans(result, data);
  if (scans.sequence().size() != run.scans.size()) {
    throw DataError(result.file, fmt::format("is of {} scans", scans.sequence().size()),
                    fmt::format("the {} of {}", run.scans.size(), truth.path.string()));
  }
  const TrackIndices indices = indices_of(truth, run.sequence.text());
  for (std::size_t k = 0; k < run.scans.size(); ++k) {
    const JudgedScan scan = scans.read(k);
    std::vector<Eigen::Vector3d> positions_m;
    for (const Point& point : scan.frame.points) {
      positions_m.push_back(scan.frame.map_from_sensor * position_of(point));
    }
    auto objects = read_labels(object_file(run.folder(), run.scans[k].stem), positions_m.size());
    apply_edits(truth.made, run.sequence.text(), k, positions_m, objects);
    count_scan(scan, positions_m, objects, indices, counts);
  }
}

}  // namespace

TrackCounts counts_of_written(const TruthFolder& truth) {
  TrackCounts counts;
  for (const TruthTrack& track : truth.tracks) {
    const auto decided = truth.decided.find(track.id());
    const bool moves =
        decided == truth.decided.end() ? track.moves : decided->second == Decided::kMoving;
    counts.all.push_back(static_cast<double>(track.points));
    counts.moving.push_back(moves ? counts.all.back() : 0);
  }
  return counts;
}

TrackCounts counts_of_result(const TruthFolder& truth, const ResultSet& result,
                             const std::optional<std::filesystem::path>& data) {
  const std::vector<double> none(truth.tracks.size(), 0);
  TrackCounts counts{none, none};
  for (const Result& run : truth.runs) {
    const auto same = std::ranges::find(result.sequences, run.sequence, &Result::sequence);
    if (same == result.sequences.end()) {
      throw DataError(result.path, "has no sequence " + run.sequence.text(),
                      "the sequences of " + truth.path.string());
    }
    count_sequence(truth, run, *same, data, counts);
  }
  return counts;
}

}  // namespace mosbench
