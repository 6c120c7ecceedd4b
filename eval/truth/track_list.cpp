#include "eval/truth/track_list.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "datasets/disk/files.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/result/result_scans.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

constexpr const char* kMoving = "moving";
constexpr const char* kStatic = "static";

/// What the files of a scan add to its tracks.
void add_scan(const Result& run, std::size_t scan_index,
              std::map<std::uint32_t, TruthTrack>& tracks) {
  const ScanRow& row = run.scans[scan_index];
  const auto objects = read_labels(object_file(run.folder(), row.stem), row.points);
  const auto labels = read_labels(run.folder() / "labels" / (row.stem + ".label"), row.points);
  const std::filesystem::path file = dynamic_score_file(run.folder(), row.stem);
  const auto scores =
      parse_dynamic_scores(read_file(file), row.points, ScoreNumbers::kFloat32, file);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (objects[i] == 0) continue;
    TruthTrack& track = tracks[objects[i]];
    if (track.points++ == 0) track.first_scan = scan_index;
    if (track.scans == 0 || track.last_scan < scan_index) ++track.scans;
    track.last_scan = scan_index;
    track.moves = labels[i] == kMovingLabel;
    const double through = std::clamp<double>(scores[i], 0, 1);
    track.doubt = track.moves ? 1 - through : through;
  }
}

std::size_t count_in(const ordered_json& json, const char* name) {
  const ordered_json& number = json.at(name);
  if (!number.is_number_unsigned()) throw std::invalid_argument(name);
  return number.get<std::size_t>();
}

double share_in(const ordered_json& json, const char* name) {
  const double share = json.at(name).get<double>();
  if (!(share >= 0 && share <= 1)) throw std::invalid_argument(name);
  return share;
}

/// Returns a number of 0 to 1, never 0.
double chance_of(const std::string& text) {
  const auto number = std::stoul(hash_of_text(text).substr(0, 12), nullptr, 16);
  return (static_cast<double>(number) + 1) / static_cast<double>(1ULL << 48);
}

TruthTrack track_from(const ordered_json& json) {
  TruthTrack track;
  track.sequence = json.at("sequence").get<std::string>();
  const std::size_t number = count_in(json, "number");
  track.number = static_cast<std::uint32_t>(number);
  track.first_scan = count_in(json, "first_scan");
  track.last_scan = count_in(json, "last_scan");
  track.scans = count_in(json, "scans");
  track.points = count_in(json, "points");
  const std::string guess = json.at("guess").get<std::string>();
  track.moves = guess == kMoving;
  if (!track.moves && guess != kStatic) throw std::invalid_argument("guess");
  if (number == 0 || number != track.number) throw std::invalid_argument("number");
  track.doubt = share_in(json, "doubt");
  track.worth = share_in(json, "worth");
  return track;
}

}  // namespace

TrackList list_tracks(const std::vector<Result>& runs) {
  TrackList list;
  double moving_points = 0;
  for (const Result& run : runs) {
    list.fingerprints[run.sequence.text()] = run.from.fingerprint;
    std::map<std::uint32_t, TruthTrack> tracks;
    for (std::size_t k = 0; k < run.scans.size(); ++k) add_scan(run, k, tracks);
    for (auto& [number, track] : tracks) {
      track.sequence = run.sequence.text();
      track.number = number;
      if (track.moves) moving_points += static_cast<double>(track.points);
      list.tracks.push_back(std::move(track));
    }
  }
  for (TruthTrack& track : list.tracks) {
    const double lost = static_cast<double>(track.points) / std::max(1.0, moving_points);
    track.worth = std::min(1.0, lost * track.doubt * track.doubt);
  }
  std::ranges::stable_sort(list.tracks, std::ranges::greater{}, &TruthTrack::worth);
  return list;
}

TrackList parse_tracks(std::string_view text, const std::filesystem::path& file) {
  const ordered_json json = parse_json(text, file);
  const char* expected = "the file as `mosbench truth propose` wrote it";
  TrackList list;
  std::set<std::string> ids;
  try {
    if (count_in(json, "format") != 1) throw std::invalid_argument("format");
    for (const auto& [sequence, fingerprint] : json.at("fingerprints").items()) {
      list.fingerprints[sequence] = fingerprint.get<std::string>();
    }
    for (const ordered_json& member : json.at("tracks")) {
      TruthTrack& track = list.tracks.emplace_back(track_from(member));
      const auto of = list.fingerprints.find(track.sequence);
      if (of == list.fingerprints.end()) throw std::invalid_argument("sequence");
      track.chance = chance_of(of->second + track.id());
      if (!ids.insert(track.id()).second) throw std::invalid_argument("tracks");
    }
  } catch (const ordered_json::exception& error) {
    throw DataError(file, sentence_of(error), expected);
  } catch (const std::invalid_argument& error) {
    throw DataError(file, std::string("has a wrong \"") + error.what() + '"', expected);
  }
  return list;
}

std::string format_tracks(const TrackList& list) {
  ordered_json json = {{"format", 1}, {"fingerprints", list.fingerprints}};
  json["tracks"] = ordered_json::array();
  for (const TruthTrack& track : list.tracks) {
    json["tracks"].push_back({{"sequence", track.sequence},
                              {"number", track.number},
                              {"first_scan", track.first_scan},
                              {"last_scan", track.last_scan},
                              {"scans", track.scans},
                              {"points", track.points},
                              {"guess", track.moves ? kMoving : kStatic},
                              {"doubt", track.doubt},
                              {"worth", track.worth}});
  }
  return json_text(json);
}

}  // namespace mosbench
