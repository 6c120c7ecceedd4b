#include "eval/truth/track_edits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/truth/completion.hpp"

namespace mosbench {
namespace {

constexpr double kGround_m = 0.1;

/// The track of an id without points; number 0 where it is none.
TruthTrack track_named(const std::string& id) {
  const std::size_t slash = std::min(id.rfind('/'), id.size());
  TruthTrack track{.sequence = id.substr(0, slash)};
  const auto number = parse_unsigned(std::string_view(id).substr(std::min(slash + 1, id.size())));
  track.number = static_cast<std::uint32_t>(number.value_or(0));
  return track.id() == id ? track : TruthTrack{};
}

/// Whether a vertical line through the point meets the polygon's area, by the even-odd rule.
bool is_inside(std::span<const Eigen::Vector2d> corners_m, const Eigen::Vector3d& point_m) {
  bool is_in = corners_m.empty();
  for (std::size_t i = 0; i < corners_m.size(); ++i) {
    const Eigen::Vector2d &a = corners_m[i], &b = corners_m[(i + 1) % corners_m.size()];
    if ((a.y() > point_m.y()) == (b.y() > point_m.y())) continue;
    const double across_m = a.x() + (point_m.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (point_m.x() < across_m) is_in = !is_in;
  }
  return is_in;
}

/// Moves points, and what a decision on them is worth, from a track. Returns the worth.
double take_points(const TrackEdit& edit, std::size_t points, TruthTrack& from) {
  const double worth = from.worth * static_cast<double>(points) / static_cast<double>(from.points);
  from.worth -= worth;
  from.points -= points;
  if (edit.corners_m.empty() && edit.last_scan >= from.last_scan && edit.first_scan > 0) {
    from.last_scan = std::max(from.first_scan, edit.first_scan - 1);
  }
  return worth;
}

double worth_of_paint(std::size_t points, std::span<const TruthTrack> tracks) {
  double moving_points = static_cast<double>(points);
  for (const TruthTrack& track : tracks) {
    if (track.moves) moving_points += static_cast<double>(track.points);
  }
  return static_cast<double>(points) / std::max(1.0, moving_points);
}

void add_made(const MadeTrack& made, std::vector<TruthTrack>& tracks,
              const std::filesystem::path& file) {
  TruthTrack track{.sequence = made.sequence,
                   .number = made.number,
                   .first_scan = made.edit.first_scan,
                   .last_scan = made.edit.last_scan,
                   .scans = made.edit.last_scan - made.edit.first_scan + 1,
                   .doubt = 0.5};
  std::size_t most = 0;
  for (const auto& [number, points] : made.edit.takes) {
    track.points += points;
    if (number == 0) {
      track.worth += worth_of_paint(points, tracks);
      continue;
    }
    const auto from = std::ranges::find_if(tracks, [&](const TruthTrack& other) {
      return other.sequence == made.sequence && other.number == number;
    });
    if (from == tracks.end() || points == 0 || from->points < points) {
      throw DataError(
          file, fmt::format("{} takes {} of {}", track.id(), counted(points, "point"), number),
          "a track with as many");
    }
    track.worth += take_points(made.edit, points, *from);
    if (points > most) {
      most = points;
      track.moves = from->moves;
      track.doubt = from->doubt;
    }
  }
  tracks.push_back(track);
}

}  // namespace

std::uint32_t new_number(std::span<const TruthTrack> proposed, std::span<const Decision> decisions,
                         const std::string& sequence) {
  std::uint32_t last = 0;
  const auto see = [&](const TruthTrack& track) {
    if (track.sequence == sequence) last = std::max(last, track.number);
  };
  std::ranges::for_each(proposed, see);
  for (const Decision& decision : decisions) see(track_named(decision.track));
  return last + 1;
}

std::vector<MadeTrack> made_by(std::span<const Decision> decisions,
                               std::span<const TruthTrack> proposed,
                               const std::filesystem::path& file) {
  std::set<std::string> known, sequences;
  for (const TruthTrack& track : proposed) {
    known.insert(track.id());
    sequences.insert(track.sequence);
  }
  std::vector<MadeTrack> made;
  for (const auto& [id, decided, edit] : decisions) {
    const TruthTrack track = track_named(id);
    if (decided == Decided::kMade) {
      if (track.number == 0 || !sequences.contains(track.sequence) || !known.insert(id).second) {
        throw DataError(file, "makes \"" + id + '"', "a new number in a sequence of tracks.json");
      }
      made.push_back({track.sequence, track.number, edit});
    } else if (!known.contains(id)) {
      throw DataError(file, "decides on \"" + id + '"',
                      "a track of tracks.json, or one made before");
    } else if (decided == Decided::kUnmade) {
      if (made.empty() || made.back().sequence != track.sequence ||
          made.back().number != track.number) {
        throw DataError(file, "unmakes \"" + id + '"', "the last track that was made");
      }
      made.pop_back();
      known.erase(id);
    }
  }
  return made;
}

std::vector<TruthTrack> edited(std::vector<TruthTrack> tracks, std::span<const MadeTrack> made,
                               const std::filesystem::path& file) {
  for (const MadeTrack& track : made) add_made(track, tracks, file);
  std::erase_if(tracks, [](const TruthTrack& track) { return track.points == 0; });
  std::ranges::stable_sort(tracks, std::ranges::greater{}, &TruthTrack::worth);
  return tracks;
}

void apply_edits(std::span<const MadeTrack> made, const std::string& sequence,
                 std::size_t scan_index, std::span<const Eigen::Vector3d> positions_map_m,
                 std::span<std::uint32_t> objects) {
  for (const auto& [of_sequence, number, edit] : made) {
    if (of_sequence != sequence) continue;
    if (scan_index < edit.first_scan || scan_index > edit.last_scan) continue;
    const std::vector<double> heights =
        edit.takes.contains(0) ? heights_m(positions_map_m) : std::vector<double>{};
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (!edit.takes.contains(objects[i]) || !is_inside(edit.corners_m, positions_map_m[i]))
        continue;
      if (objects[i] == 0 && !(heights[i] >= kGround_m)) continue;
      objects[i] = number;
    }
  }
}

}  // namespace mosbench
