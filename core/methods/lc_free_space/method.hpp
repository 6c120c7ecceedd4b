#pragma once

#include <mosbench/method.hpp>

namespace mosbench::lc_free_space {

/// "lc-free-space": points in space that a volumetric map holds free.
MethodKind method_kind();

}  // namespace mosbench::lc_free_space
