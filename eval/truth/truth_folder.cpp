#include "eval/truth/truth_folder.hpp"

#include <algorithm>
#include <iterator>
#include <set>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace fs = std::filesystem;

fs::path tracks_file(const fs::path& folder) { return folder / "tracks.json"; }
fs::path decisions_file(const fs::path& folder) { return folder / "decisions.json"; }

std::vector<TruthTrack> TruthFolder::undecided() const {
  std::vector<TruthTrack> left;
  std::ranges::copy_if(tracks, std::back_inserter(left),
                       [&](const TruthTrack& track) { return !decided.contains(track.id()); });
  return left;
}

std::vector<Decision> read_decisions(const fs::path& folder) {
  const fs::path file = decisions_file(folder);
  if (!is_there(file)) return {};
  return parse_decisions(read_file(file), file);
}

TruthFolder open_truth(const fs::path& folder) {
  const fs::path file = tracks_file(folder);
  if (!is_there(file)) {
    throw DataError(folder, "has no tracks.json", "a folder that `mosbench truth propose` wrote");
  }
  TruthFolder truth{folder, {}, {}, read_decisions(folder), {}};
  TrackList list = parse_tracks(read_file(file), file);
  truth.tracks = std::move(list.tracks);
  truth.runs = load_result_set(folder).sequences;
  std::map<std::string, std::string> fingerprints;
  for (const Result& run : truth.runs) {
    fingerprints[run.sequence.text()] = run.from.fingerprint;
  }
  if (fingerprints != list.fingerprints) {
    throw DataError(file, "is of other scans than the runs beside it", "those of one propose");
  }
  std::set<std::string> known;
  for (const TruthTrack& track : truth.tracks) known.insert(track.id());
  for (const Decision& decision : truth.decisions) {
    if (known.contains(decision.track)) continue;
    throw DataError(decisions_file(folder), "decides on \"" + decision.track + '"',
                    "a track of tracks.json");
  }
  truth.decided = last_of_each(truth.decisions);
  return truth;
}

}  // namespace mosbench
