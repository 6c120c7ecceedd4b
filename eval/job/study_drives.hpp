#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "eval/job/study_cells.hpp"

// Which cells of a study read the same drive: what tells its scans from others, wherever they lie
// and whatever they are called.

namespace mosbench {

/// Returns "scene 5f3a... seed 7": one drive, whatever its layout and length.
std::string simulated_drive(const std::string& scene_fingerprint, std::uint64_t seed);
/// Returns the same; empty for recorded data.
std::string drive_of(const std::optional<SimulatedOrigin>& origin);

/// Returns "scene 5f3a..." of it; empty for recorded data.
std::string scene_of(const std::string& drive);

/// Returns hashes of up to 16 scans of a sequence on disk: of where their points are, and of how
/// many points they and the next ones have, which noise does not change. Scans are chosen by how
/// many points they have, so that a copy in another layout, or with some scans less, gives the same
/// ones. It cannot know a copy with other numbers of points, as of a layout that leaves out returns
/// that miss, where no scan is chosen of both; nor one from the middle of a drive whose scans have
/// all as many points. Throws DataError.
std::set<std::uint64_t> scan_hashes(const Data& data, const std::string& sequence);

/// Returns whether two drives have a hash in common: they are the same then.
bool share_a_scan(const std::set<std::uint64_t>& first, const std::set<std::uint64_t>& second);

/// Returns whether two cells are of one scene, with other seeds.
bool are_seeds_of_one_scene(const StudyCell& first, const StudyCell& second);

/// Throws UsageError for a tuning that judges on scans that it tunes on; other scans of a drive may
/// be judged.
void check_drives(const Study& study, const std::vector<StudyCell>& cells);

}  // namespace mosbench
