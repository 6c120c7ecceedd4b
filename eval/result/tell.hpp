#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

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

/// Prints a line on stderr, `shown` so that no name in it can steer a terminal. Never throws, as
/// nobody may read stderr. Silent for a quiet Caller.
void tell(std::string_view line);

/// Tells on stderr how far a sequence is: one rewritten line on a terminal, a plain line every few
/// seconds elsewhere.
class Progress {
 public:
  Progress(const std::string& title, std::size_t scans);
  /// Ends the terminal line so that whatever follows starts on its own.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// To be called after each scan.
  void advance();

 private:
  using Clock = std::chrono::steady_clock;
  void print(Clock::time_point now);

  std::string title_;
  std::size_t scans_;
  std::size_t done_ = 0;
  bool terminal_;
  bool line_open_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point printed_ = start_;
};

/// Returns what tells on stderr how far the sequences are, one after the other, that something is
/// done to.
std::function<void(const std::string& sequence, std::size_t done, std::size_t scans)>
progress_over_sequences(std::string title);

/// "41 s", "3 min 05 s" or "2 h 07 min".
std::string duration_text(double seconds_s);

}  // namespace mosbench
