#pragma once

#include <string_view>

namespace mosbench {

/// The project's version and, when it was built from a git clone, `git describe` behind a plus.
extern const std::string_view kMosbenchVersion;
/// Name and version of the compiler that built the program.
extern const std::string_view kCompiler;

}  // namespace mosbench
