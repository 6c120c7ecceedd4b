#pragma once

#include "core/hmm_mos/hmm.hpp"

namespace mosbench::hmm_mos {

/// Voxels that turned from free to occupied or back; becoming known for the first time is no
/// change.
inline BlockMask detect_changes(const BlockStates& before, const BlockStates& after) {
  return (before.free & after.occupied) | (before.occupied & after.free);
}

}  // namespace mosbench::hmm_mos
