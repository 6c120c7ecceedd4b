#include "eval/truth/truth_labels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>

#include "datasets/disk/claim.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/label_formats.hpp"
#include "datasets/layouts/kitti_sequence.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/protocols/protocol.hpp"
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

fs::path corrected_file(const fs::path& folder, const std::string& stem) {
  for (const std::string_view extension : kLabelExtensions) {
    if (fs::path file = folder / (stem + std::string(extension)); is_there(file)) return file;
  }
  throw DataError(folder, "has no labels of scan " + stem, "a file of them for each scan");
}

/// Returns what somebody says of each point of a scan. Unsure says nothing: labels of others have
/// its id wherever nobody looked.
std::vector<Decided> corrected_scan(const ResultScans& scans, std::size_t k,
                                    const fs::path& folder) {
  static const LabelTable classes(protocol_named("mapmos").truth);
  const Frame frame = scans.sequence().read(k);
  const fs::path file = corrected_file(folder, frame.stem);
  if (tells_points(file)) check_same_points(file, frame.points, "scan " + frame.stem);
  std::vector<Decided> said;
  for (const std::uint32_t label : read_any_labels(file, frame.points.size())) {
    const TruthClass is = classes[label];
    said.push_back(is == TruthClass::kIgnored  ? Decided::kUnsure
                   : is == TruthClass::kMoving ? Decided::kMoving
                                               : Decided::kStatic);
  }
  return said;
}

/// Calls `accept` with each scan and what somebody says of its points.
template <typename Accept>
void for_corrected(const TruthFolder& truth, const ResultScans& scans, const fs::path& corrected,
                   Accept&& accept) {
  const fs::path folder = corrected / scans.result().sequence.folder() / "labels";
  for (std::size_t k = 0; k < scans.rows().size(); ++k) {
    accept(read_truth_scan(scans, truth.made, k), corrected_scan(scans, k, folder));
  }
}

/// Returns the decisions that most points of a track ask for.
std::vector<Decision> decisions_by(const TruthFolder& truth, const ResultScans& scans,
                                   const fs::path& corrected) {
  std::map<std::uint32_t, std::map<Decided, std::size_t>> points;
  for_corrected(truth, scans, corrected,
                [&](const TruthScan& scan, const std::vector<Decided>& said) {
                  for (std::size_t i = 0; i < said.size(); ++i) ++points[scan.objects[i]][said[i]];
                });
  const LabelsByNumber before = labels_of_tracks(truth, scans.result().sequence.text());
  std::vector<Decision> decisions;
  for (const TruthTrack& track : truth.tracks) {
    if (track.sequence != scans.result().sequence.text()) continue;
    const Decided now = before.at(track.number).label;
    for (const auto& [decided, count] : points[track.number]) {
      if (decided == Decided::kUnsure || decided == now) continue;
      if (2 * count > track.points) decisions.push_back({track.id(), decided});
    }
  }
  return decisions;
}

}  // namespace

TruthImport import_truth(TruthFolder& truth, const std::optional<fs::path>& data,
                         const fs::path& corrected) {
  TruthImport imported;
  std::vector<std::unique_ptr<ResultScans>> opened;
  std::vector<Decision> decisions;
  for (const Result& run : truth.runs) {
    opened.push_back(std::make_unique<ResultScans>(run, data));
    std::ranges::move(decisions_by(truth, *opened.back(), corrected),
                      std::back_inserter(decisions));
  }
  if (!decisions.empty()) truth.decide(decisions);
  imported.decisions = decisions.size();
  for (const auto& scans : opened) {
    const LabelsByNumber tracks = labels_of_tracks(truth, scans->result().sequence.text());
    TruthShares shares;
    for_corrected(truth, *scans, corrected,
                  [&](const TruthScan& scan, const std::vector<Decided>& said) {
                    const auto labels = labels_of_scan(scan, tracks, shares);
                    for (std::size_t i = 0; i < said.size(); ++i) {
                      const bool is_said = said[i] != Decided::kUnsure;
                      if (is_said && labels[i] != id_of(said[i])) ++imported.still_differ;
                    }
                  });
    imported.points += shares.points;
  }
  return imported;
}

std::vector<TruthShares> write_truth(const TruthFolder& truth, const std::optional<fs::path>& data,
                                     const fs::path& out) {
  std::vector<TruthShares> written;
  for (const Result& run : truth.runs) {
    written.push_back(write_sequence(truth, run, data, out));
  }
  return written;
}

}  // namespace mosbench
