#pragma once

#include <mosbench/method.hpp>

namespace mosbench::dynablox {

/// "dynablox": objects in space that was free for long.
MethodKind method_kind();

}  // namespace mosbench::dynablox
