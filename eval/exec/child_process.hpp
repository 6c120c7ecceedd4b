#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <string_view>

#include "datasets/disk/partial_file.hpp"

namespace mosbench {

/// A shell command with its stdin and stdout in our hands, in a process group of its own. The group
/// is killed when this object goes, and also when this process ends in any other way. SIGPIPE must
/// be ignored.
class ChildProcess {
 public:
  using Deadline = std::chrono::steady_clock::time_point;

  /// Throws std::system_error.
  explicit ChildProcess(const std::string& command);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Writes `outgoing` while it reads, until everything is written and the inbox holds `bytes`
  /// bytes. Returns early when the command closes its stdout, at the deadline, and when the inbox
  /// holds more than `most_bytes`. Returns how many bytes were not written.
  std::size_t exchange(std::string_view outgoing, std::size_t bytes, std::size_t most_bytes,
                       Deadline deadline);

  /// What was read and not taken.
  const std::string& inbox() const { return inbox_; }
  /// Removes the first bytes of the inbox and returns them.
  std::string take(std::size_t bytes);
  /// Whether the command closed its stdout.
  bool is_closed() const { return closed_; }

  /// Closes the command's stdin and waits until it ends, closes its stdout, or writes more.
  void end(Deadline deadline);
  /// Waits for the end: "ended with exit code 3", "was ended by signal 11"; empty when the command
  /// still runs at the deadline.
  std::string how_it_ended(Deadline deadline);

 private:
  void write_some(std::string_view& outgoing);
  void read_some();

  pid_t child_ = -1, guard_ = -1;
  FileDescriptor to_child_, from_child_, lifeline_;
  std::string inbox_;
  bool closed_ = false, deaf_ = false;  ///< it closed its stdout, its stdin
};

/// What commands of ChildProcess cost, with the processes that they waited for.
struct CommandCost {
  double most_memory_mib = 0.0;  ///< at least what this process held when it started the command
  double cpu_s = 0.0;
};
/// Returns the cost of those that ended since the last call.
CommandCost take_cost_of_commands();

}  // namespace mosbench
