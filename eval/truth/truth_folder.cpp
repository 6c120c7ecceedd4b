#include "eval/truth/truth_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/result/tell.hpp"
#include "eval/truth/sampled_iou.hpp"

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

std::vector<const TruthTrack*> TruthFolder::contradicted() const {
  std::vector<const TruthTrack*> found;
  for (const TruthTrack& track : tracks) {
    const auto said = decided.find(track.id());
    const Decided against = track.moves ? Decided::kStatic : Decided::kMoving;
    if (said != decided.end() && said->second == against && track.doubt < 0.2) {
      found.push_back(&track);
    }
  }
  return found;
}

void TruthFolder::decide(std::span<const Decision> more) {
  std::vector<Decision> all = read_decisions(path);
  std::ranges::copy(more, std::back_inserter(all));
  std::vector<Decision> before = decisions;
  take(std::move(all));
  try {
    commit_file(decisions_file(path), format_decisions(decisions));
  } catch (...) {
    take(std::move(before));
    throw;
  }
}

const TruthTrack& TruthFolder::make(const std::string& sequence, TrackEdit edit) {
  TruthTrack next{.sequence = sequence, .number = new_number(proposed, decisions, sequence)};
  decide(std::vector<Decision>{{next.id(), Decided::kMade, std::move(edit)}});
  return *std::ranges::find(tracks, next.id(), &TruthTrack::id);
}

/// Changes nothing where it throws.
void TruthFolder::take(std::vector<Decision> all) {
  std::vector<MadeTrack> by_edits = made_by(all, proposed, decisions_file(path));
  tracks = edited(proposed, by_edits, decisions_file(path));
  sort_for_decisions(tracks);
  made = std::move(by_edits);
  decided = last_of_each(all);
  std::erase_if(decided, [&](const auto& said) {
    return std::ranges::find(tracks, said.first, &TruthTrack::id) == tracks.end();
  });
  decisions = std::move(all);
}

std::string left_text(const std::vector<TruthTrack>& undecided) {
  constexpr double kPerDecision_s = 8;
  const auto worthy = static_cast<std::size_t>(std::ranges::count_if(
      undecided, [](const TruthTrack& track) { return track.worth >= kWorthADecision; }));
  return fmt::format("{} left, about {}", counted(worthy, "decision"),
                     duration_text(kPerDecision_s * static_cast<double>(worthy)));
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
  TruthFolder truth;
  truth.path = folder;
  TrackList list = parse_tracks(read_file(file), file);
  truth.proposed = std::move(list.tracks);
  truth.runs = load_result_set(folder).sequences;
  std::map<std::string, std::string> fingerprints;
  for (const Result& run : truth.runs) {
    fingerprints[run.sequence.text()] = run.from.fingerprint;
  }
  if (fingerprints != list.fingerprints) {
    throw DataError(file, "is of other scans than the runs beside it", "those of one propose");
  }
  truth.take(read_decisions(folder));
  return truth;
}

}  // namespace mosbench
