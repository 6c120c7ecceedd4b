#pragma once

#include <functional>

namespace mosbench {

/// What a program that calls the commands as functions wants of them.
struct Caller {
  bool quiet = false;                          ///< neither notes nor progress on stderr
  std::function<void()> at_each_scan = [] {};  ///< may throw to end the command
};

/// Returns the caller that a CallerScope names; the mosbench program itself without one.
const Caller& caller();

/// Names the caller of all commands, in all threads, while it lives. One at a time.
class CallerScope {
 public:
  explicit CallerScope(Caller caller);
  ~CallerScope();
  CallerScope(const CallerScope&) = delete;
  CallerScope& operator=(const CallerScope&) = delete;
};

}  // namespace mosbench
