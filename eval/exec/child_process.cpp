#include "eval/exec/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <mutex>
#include <thread>
#include <utility>

namespace mosbench {
namespace {

using Clock = std::chrono::steady_clock;

struct Pipe {
  FileDescriptor read_end, write_end;
};

Pipe make_pipe() {
  std::array<int, 2> ends{};
  require_success(pipe2(ends.data(), O_CLOEXEC) == 0);
  // A number of a standard stream would be lost when another end is put there.
  for (int& end : ends) {
    if (end > STDERR_FILENO) continue;
    const int higher = fcntl(end, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    close(end);
    require_success(higher >= 0);
    end = higher;
  }
  return {FileDescriptor(ends[0]), FileDescriptor(ends[1])};
}

/// False once the other end is closed without a word.
bool reads_word(int end) {
  char word = 0;
  ssize_t read_bytes = -1;
  do {
    read_bytes = read(end, &word, 1);
  } while (read_bytes < 0 && errno == EINTR);
  return read_bytes > 0;
}

void write_word(const FileDescriptor& end) {
  while (write(end.number(), "x", 1) < 0 && errno == EINTR) {
  }
}

void make_nonblocking(const FileDescriptor& file) {
  require_success(fcntl(file.number(), F_SETFL, O_NONBLOCK) == 0);
}

/// Waits for a word that its guard is there, then becomes the command; ends if nobody is left to
/// say it. Calls only what is allowed after a fork of a process with threads.
[[noreturn]] void become(const char* command, int stdin_end, int stdout_end, const Pipe& start) {
  setpgid(0, 0);
  close(start.write_end.number());
  if (!reads_word(start.read_end.number())) _exit(127);
  dup2(stdin_end, STDIN_FILENO);
  dup2(stdout_end, STDOUT_FILENO);
  for (const int ignored : {SIGPIPE, SIGXFSZ}) signal(ignored, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
  execl("/bin/sh", "sh", "-c", command, nullptr);
  _exit(127);
}

/// Kills the group, and its first process even where that left it.
void kill_all(pid_t group) {
  kill(-group, SIGKILL);
  kill(group, SIGKILL);
}

/// Waits until the lifeline is closed without a word, because the process that holds it died, and
/// kills the group then. Same restriction.
[[noreturn]] void guard(pid_t group, int lifeline) {
  setpgid(0, 0);
  for (const int ignored : {SIGHUP, SIGINT, SIGTERM}) signal(ignored, SIG_IGN);
  dup2(lifeline, STDIN_FILENO);
  close_range(STDIN_FILENO + 1, ~0U, 0);
  if (!reads_word(STDIN_FILENO)) kill_all(group);
  _exit(0);
}

std::mutex ended_mutex;
CommandCost ended_commands;

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

void reap(pid_t process) {
  while (waitpid(process, nullptr, 0) < 0 && errno == EINTR) {
  }
}

/// The system's own maximum, of all children, would count earlier commands and guards, too.
void reap_and_measure(pid_t process) {
  rusage usage{};
  while (wait4(process, nullptr, 0, &usage) < 0) {
    if (errno != EINTR) return;
  }
  constexpr double kKibOfMib = 1024;
  const std::lock_guard lock(ended_mutex);
  ended_commands.most_memory_mib =
      std::max(ended_commands.most_memory_mib, static_cast<double>(usage.ru_maxrss) / kKibOfMib);
  ended_commands.cpu_s += seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
}

int left_ms(ChildProcess::Deadline deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
  return static_cast<int>(std::clamp<long long>(left, 0, 1'000'000'000));
}

}  // namespace

ChildProcess::ChildProcess(const std::string& command) {
  Pipe in = make_pipe(), out = make_pipe(), start = make_pipe(), lifeline = make_pipe();
  make_nonblocking(in.write_end);
  make_nonblocking(out.read_end);
  child_ = fork();
  require_success(child_ >= 0);
  if (child_ == 0) become(command.c_str(), in.read_end.number(), out.write_end.number(), start);
  setpgid(child_, child_);  // whoever comes first, it or the child
  guard_ = fork();
  if (guard_ == 0) guard(child_, lifeline.read_end.number());
  write_word(start.write_end);
  to_child_ = std::move(in.write_end);
  from_child_ = std::move(out.read_end);
  lifeline_ = std::move(lifeline.write_end);
}

ChildProcess::~ChildProcess() {
  // The number of the group stays taken as long as the child is not reaped.
  kill_all(child_);
  if (guard_ > 0) {
    write_word(lifeline_);
    reap(guard_);
  }
  reap_and_measure(child_);
}

void ChildProcess::write_some(std::string_view& outgoing) {
  const ssize_t written = write(to_child_.number(), outgoing.data(), outgoing.size());
  if (written >= 0) {
    outgoing.remove_prefix(static_cast<std::size_t>(written));
  } else if (errno == EPIPE) {
    deaf_ = true;
  } else {
    require_success(errno == EAGAIN || errno == EINTR);
  }
}

void ChildProcess::read_some() {
  std::array<char, 1 << 16> buffer;
  const ssize_t read_bytes = read(from_child_.number(), buffer.data(), buffer.size());
  if (read_bytes > 0) {
    inbox_.append(buffer.data(), static_cast<std::size_t>(read_bytes));
  } else if (read_bytes == 0) {
    closed_ = true;
  } else {
    require_success(errno == EAGAIN || errno == EINTR);
  }
}

std::size_t ChildProcess::exchange(std::string_view outgoing, std::size_t bytes,
                                   std::size_t most_bytes, Deadline deadline) {
  const auto writes = [&] { return !outgoing.empty() && !deaf_; };
  while (!closed_ && inbox_.size() <= most_bytes && (writes() || inbox_.size() < bytes)) {
    std::array<pollfd, 2> files = {
        {{from_child_.number(), POLLIN, 0}, {writes() ? to_child_.number() : -1, POLLOUT, 0}}};
    const int ready = poll(files.data(), files.size(), left_ms(deadline));
    require_success(ready >= 0 || errno == EINTR);
    if (ready == 0) break;
    if (ready < 0) continue;
    if (files[1].revents != 0) write_some(outgoing);
    if (files[0].revents != 0) read_some();
  }
  return outgoing.size();
}

std::string ChildProcess::take(std::size_t bytes) {
  std::string taken = inbox_.substr(0, bytes);
  inbox_.erase(0, bytes);
  return taken;
}

void ChildProcess::end(Deadline deadline) {
  constexpr std::chrono::milliseconds kLook{20};
  to_child_ = FileDescriptor();
  const std::size_t before = inbox_.size();
  for (bool has_ended = false; !closed_ && !has_ended && Clock::now() < deadline;) {
    // A process that the command leaves behind holds its stdout open.
    has_ended = !how_it_ended(Clock::now()).empty();
    exchange({}, before + 1, before, std::min(deadline, Clock::now() + kLook));
    if (inbox_.size() > before) return;
  }
}

std::string ChildProcess::how_it_ended(Deadline deadline) {
  constexpr std::chrono::milliseconds kLook{2};
  for (;;) {
    siginfo_t info{};
    // Not reaped: the group may still hold processes of the command.
    const int waited = waitid(P_PID, static_cast<id_t>(child_), &info, WEXITED | WNOHANG | WNOWAIT);
    require_success(waited == 0 || errno == EINTR);
    if (waited == 0 && info.si_pid == child_) {
      return info.si_code == CLD_EXITED ? fmt::format("ended with exit code {}", info.si_status)
                                        : fmt::format("was ended by signal {}", info.si_status);
    }
    if (Clock::now() >= deadline) return "";
    std::this_thread::sleep_for(kLook);
  }
}

CommandCost take_cost_of_commands() {
  const std::lock_guard lock(ended_mutex);
  return std::exchange(ended_commands, {});
}

}  // namespace mosbench
