#pragma once

#include <mosbench/method.hpp>

namespace mosbench::hmm_mos {

/// "hmm-mos": the pipeline behind the interface of all methods.
MethodKind method_kind();
/// "hmm-mos-reference": the same labels by the obvious code of reference.hpp, hundreds of times
/// slower.
MethodKind reference_kind();

}  // namespace mosbench::hmm_mos
