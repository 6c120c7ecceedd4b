#pragma once

#include <string_view>

namespace mosbench {

/// Prints a line on stderr, `shown` so that no name in it can steer a terminal. Never throws, as
/// nobody may read stderr. Silent for a quiet Caller.
void tell(std::string_view line);

}  // namespace mosbench
