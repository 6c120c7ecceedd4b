#pragma once

#include <mosbench/method.hpp>

namespace mosbench::hmm_mos_plus {

/// "hmm-mos-plus": the paper's method, completed to objects.
MethodKind method_kind();

}  // namespace mosbench::hmm_mos_plus
