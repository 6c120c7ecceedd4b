#include "eval/truth/truth_labels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "datasets/disk/claim.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/layouts/kitti_sequence.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/result/tell.hpp"
#include "eval/truth/completion.hpp"
#include "eval/truth/truth_scan.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

using nlohmann::ordered_json;

constexpr std::uint32_t kUnsureLabel = 0;

struct TrackLabel {
  Decided label = Decided::kStatic;
  bool is_by_hand = false;
};
using LabelsByNumber = std::map<std::uint32_t, TrackLabel>;

LabelsByNumber labels_of_tracks(const TruthFolder& truth, const std::string& sequence) {
  LabelsByNumber labels;
  for (const TruthTrack& track : truth.tracks) {
    if (track.sequence != sequence) continue;
    const auto decided = truth.decided.find(track.id());
    const Decided guess = track.moves ? Decided::kMoving : Decided::kStatic;
    labels[track.number] = decided == truth.decided.end() ? TrackLabel{guess, false}
                                                          : TrackLabel{decided->second, true};
  }
  return labels;
}

std::uint32_t id_of(Decided label) {
  if (label == Decided::kUnsure) return kUnsureLabel;
  return label == Decided::kMoving ? kMovingLabel : kStaticLabel;
}

/// Returns the labels of a scan, and counts them.
std::vector<std::uint32_t> labels_of_scan(const TruthScan& scan, const LabelsByNumber& tracks,
                                          TruthShares& shares) {
  const std::vector<std::uint32_t>& objects = scan.objects;
  std::vector<std::uint32_t> labels(objects.size(), kStaticLabel);
  std::vector<std::uint32_t> part(objects.size(), 0);  // of objects that are completed, from 1
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (objects[i] == 0) continue;
    const auto [label, is_by_hand] = tracks.at(objects[i]);
    labels[i] = id_of(label);
    if (label != Decided::kStatic) part[i] = 1 + labels[i];
    ++(is_by_hand ? shares.by_hand : shares.guessed);
  }
  const std::vector<std::uint32_t> completed = completed_by(scan.positions_m, part);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (objects[i] == 0 && completed[i] != 0) {
      labels[i] = completed[i] - 1;
      ++shares.completed;
    }
  }
  shares.points += labels.size();
  shares.moving += static_cast<std::size_t>(std::ranges::count(labels, kMovingLabel));
  shares.unsure += static_cast<std::size_t>(std::ranges::count(labels, kUnsureLabel));
  return labels;
}

/// Objects are read again from files that lie beside decisions for long.
void check_objects(std::span<const std::uint32_t> objects, const LabelsByNumber& tracks,
                   const fs::path& file) {
  const auto other = std::ranges::find_if(
      objects, [&](std::uint32_t number) { return number != 0 && !tracks.contains(number); });
  if (other == objects.end()) return;
  throw DataError(file, fmt::format("has object {}", *other), "the tracks of tracks.json");
}

std::string note_text(const TruthFolder& truth, const TruthShares& shares) {
  std::size_t decisions = 0;
  ordered_json tracks = ordered_json::array();
  for (const auto& [number, track] : labels_of_tracks(truth, shares.sequence)) {
    if (!track.is_by_hand) continue;
    ++decisions;
    tracks.push_back(
        {{"track", number}, {"decided", kDecidedNames[static_cast<std::size_t>(track.label)]}});
  }
  const double unsure = 100.0 * static_cast<double>(shares.unsure) /
                        static_cast<double>(std::max<std::size_t>(shares.points, 1));
  return json_text(
      {{"format", 1},
       {"doubt", fmt::format("truth: {}, {:.1f} % unsure", counted(decisions, "decision"), unsure)},
       {"points",
        {{"all", shares.points},
         {"moving", shares.moving},
         {"unsure", shares.unsure},
         {"by_hand", shares.by_hand},
         {"completed", shares.completed},
         {"not_looked_at", shares.guessed}}},
       {"decided", std::move(tracks)}});
}

TruthShares write_sequence(const TruthFolder& truth, const Result& run,
                           const std::optional<fs::path>& data, const fs::path& out) {
  const fs::path folder = out / run.sequence.folder() / "labels";
  if (is_there(folder) && !is_there(folder / kTruthNote)) {
    throw UsageError(folder.string() +
                     ": holds labels that `mosbench truth` did not write, expected another --out");
  }
  const ResultScans scans(run, data);
  const LabelsByNumber tracks = labels_of_tracks(truth, run.sequence.text());
  TruthShares shares{.sequence = run.sequence.text(), .scans = run.scans.size()};
  Claim claim(folder);
  Progress progress(run.sequence.text(), run.scans.size());
  for (std::size_t k = 0; k < run.scans.size(); ++k) {
    const std::string& stem = run.scans[k].stem;
    const TruthScan scan = read_truth_scan(scans, truth.made, k);
    check_objects(scan.objects, tracks, object_file(run.folder(), stem));
    write_labels(claim.path() / (stem + ".label"), labels_of_scan(scan, tracks, shares));
    progress.advance();
  }
  write_file_atomic(claim.path() / kTruthNote, note_text(truth, shares));
  claim.put();
  return shares;
}

}  // namespace

std::vector<TruthShares> write_truth(const TruthFolder& truth, const std::optional<fs::path>& data,
                                     const fs::path& out) {
  std::vector<TruthShares> written;
  for (const Result& run : truth.runs) {
    written.push_back(write_sequence(truth, run, data, out));
  }
  return written;
}

}  // namespace mosbench
