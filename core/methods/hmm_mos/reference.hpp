#pragma once

#include <memory>
#include <mosbench/method.hpp>

#include "core/methods/hmm_mos/config.hpp"

namespace mosbench::hmm_mos {

/// Makes the method that follows the paper's section III step by step: hash maps of single voxels,
/// all pairs, triple loops. Its labels equal those of Pipeline, with which it shares the config and
/// nothing else. Throws std::invalid_argument as `check` does.
std::unique_ptr<Method> make_reference(const Config& config, const RunContext& context = {});

}  // namespace mosbench::hmm_mos
