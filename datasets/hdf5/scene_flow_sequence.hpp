#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Opens the scans of an .h5 file of OpenSceneFlow, a group each, by stamp. A scan is labelled when
/// it has a flow to the next one, from which truth is computed by speed; or `mos_label`. Throws
/// DataError.
std::unique_ptr<Sequence> open_scene_flow_file(std::string name, const std::filesystem::path& file,
                                               const Reading& asked);

/// Returns the names of the scans of a file that have eval_mask, sorted as text: those that
/// Argoverse 2's benchmark evaluates.
std::vector<std::string> evaluated_scans(const std::filesystem::path& file);

}  // namespace mosbench
