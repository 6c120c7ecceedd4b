#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "eval/protocols/protocol.hpp"

namespace mosbench {

/// Whether the split picks scans within sequences.
bool picks_scans(const Split& split);

/// Returns the split that the protocol's published numbers are over; null when the data set lacks
/// it.
const Split* benchmark_split(const Protocol& protocol, const std::vector<Split>& splits);

/// Returns the same split if it picks scans within sequences (HeLiMOS test): a number over a whole
/// sequence would then not be the protocol's.
const Split* benchmark_scans(const Protocol& protocol, const std::vector<Split>& splits);

/// Returns the stems of the sequence at `position` that belong to the split: nullopt for all of
/// them, an empty set when the sequence is not part of it.
std::optional<std::set<std::string>> stems_in_split(const Split& split, std::size_t position);

/// Stems by name for the splits that pick scans of the sequence at `position`.
std::map<std::string, std::set<std::string>> picked_stems(const Dataset& dataset,
                                                          std::size_t position);

}  // namespace mosbench
