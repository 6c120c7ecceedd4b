#pragma once

#include <mosbench/method.hpp>

namespace mosbench::dufomap {

/// "dufomap": points in space that was void in some scan.
MethodKind method_kind();

}  // namespace mosbench::dufomap
