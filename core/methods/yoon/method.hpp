#pragma once

#include <mosbench/method.hpp>

namespace mosbench::yoon {

/// "yoon": our reading of a method without published code.
MethodKind method_kind();

}  // namespace mosbench::yoon
