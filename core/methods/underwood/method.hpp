#pragma once

#include <mosbench/method.hpp>

namespace mosbench::underwood {

/// "underwood": explicit change detection between two scans.
MethodKind method_kind();

}  // namespace mosbench::underwood
