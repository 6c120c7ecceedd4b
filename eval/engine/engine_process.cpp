#include "eval/engine/engine_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::array kStops = {SIGHUP, SIGINT, SIGTERM};

/// Keeps the signals that end this process, and ends of children, waiting to be asked for. Those
/// that whoever started it ignores stay ignored.
class HeldSignals {
 public:
  HeldSignals() {
    sigemptyset(&held_);
    sigaddset(&held_, SIGCHLD);
    for (const int stop : kStops) {
      struct sigaction action {};
      if (sigaction(stop, nullptr, &action) == 0 && action.sa_handler != SIG_IGN) {
        sigaddset(&held_, stop);
      }
    }
    pthread_sigmask(SIG_BLOCK, &held_, &before_);
  }
  ~HeldSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;

  const sigset_t& before() const { return before_; }
  /// Returns the next signal; 0 where none comes for a tenth of a second.
  int next() const {
    constexpr timespec kLook{0, 100'000'000};
    return std::max(0, sigtimedwait(&held_, nullptr, &kLook));
  }

 private:
  sigset_t held_{}, before_{};
};

/// How a program is started: alone in its group, with signals as they were.
class SpawnRules {
 public:
  explicit SpawnRules(const HeldSignals& signals) {
    posix_spawn_file_actions_init(&files_);
    posix_spawn_file_actions_adddup2(&files_, STDERR_FILENO, STDOUT_FILENO);
    // A group that is not the terminal's would be stopped by reading from it.
    posix_spawn_file_actions_addopen(&files_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    sigset_t stops;
    sigemptyset(&stops);
    for (const int stop : kStops) sigaddset(&stops, stop);
    posix_spawnattr_init(&attributes_);
    posix_spawnattr_setpgroup(&attributes_, 0);
    posix_spawnattr_setsigdefault(&attributes_, &stops);
    posix_spawnattr_setsigmask(&attributes_, &signals.before());
    posix_spawnattr_setflags(
        &attributes_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  }
  ~SpawnRules() {
    posix_spawn_file_actions_destroy(&files_);
    posix_spawnattr_destroy(&attributes_);
  }
  SpawnRules(const SpawnRules&) = delete;
  SpawnRules& operator=(const SpawnRules&) = delete;

  pid_t start(const std::vector<std::string>& words) const {
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    pid_t child = 0;
    const int error =
        posix_spawnp(&child, arguments[0], &files_, &attributes_, arguments.data(), environ);
    if (error == 0) return child;
    throw DataError(words.front(), fmt::format("cannot be started ({})", std::strerror(error)),
                    "Snakemake 7 (Debian: snakemake)");
  }

 private:
  posix_spawn_file_actions_t files_{};
  posix_spawnattr_t attributes_{};
};

/// Waits until no process of a group is left, and kills what is left at the deadline.
void clear_group(pid_t group, Clock::time_point deadline) {
  constexpr std::chrono::milliseconds kLook{20};
  while (kill(-group, 0) == 0 && Clock::now() < deadline) std::this_thread::sleep_for(kLook);
  kill(-group, SIGKILL);
}

}  // namespace

EngineEnd run_in_group(const std::vector<std::string>& words) {
  constexpr std::chrono::seconds kGrace{20};
  const HeldSignals signals;
  const pid_t child = SpawnRules(signals).start(words);
  EngineEnd end;
  Clock::time_point deadline = Clock::time_point::max();
  int status = 0;
  for (pid_t ended = 0; ended != child; ended = waitpid(child, &status, WNOHANG)) {
    const int caught = signals.next();
    if (caught != 0 && caught != SIGCHLD && !end.stopped_by) {
      end.stopped_by = caught;
      deadline = Clock::now() + kGrace;
      kill(-child, SIGINT);
    }
    if (Clock::now() >= deadline) kill(-child, SIGKILL);
  }
  if (end.stopped_by) clear_group(child, deadline);
  end.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return end;
}

}  // namespace mosbench
