#pragma once

#include <optional>
#include <string>
#include <vector>

namespace mosbench {

/// How a program ended.
struct EngineEnd {
  int exit_code = 0;              ///< 128 + signal when a signal ended it
  std::optional<int> stopped_by;  ///< the signal that this process got meanwhile
};

/// Starts a program in a process group of its own and waits for it; its stdout goes to stderr,
/// which is for progress. A signal that would end this process ends the group in its place: as
/// Ctrl-C does, and by force what is left of it seconds later. Throws DataError where it cannot be
/// started.
EngineEnd run_in_group(const std::vector<std::string>& words);

}  // namespace mosbench
