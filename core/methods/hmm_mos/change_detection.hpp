#pragma once

#include "core/methods/hmm_mos/hmm.hpp"

namespace mosbench::hmm_mos {

/// Returns P'_chg (paper, III): voxels whose state S went from free to occupied or back; becoming
/// known for the first time is no change.
inline BlockMask detect_changes(const BlockStates& before, const BlockStates& after) {
  return (before.free & after.occupied) | (before.occupied & after.free);
}

}  // namespace mosbench::hmm_mos
