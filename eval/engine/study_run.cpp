#include "eval/engine/study_run.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <set>
#include <thread>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/result/machine.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {

// Embedded by CMakeLists.txt: the files of scripts/cluster.
std::string_view snakefile_asset();
std::string_view local_profile_asset();
std::string_view slurm_profile_asset();
std::string_view slurm_status_asset();

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

using Clock = std::chrono::steady_clock;

/// How a program ended.
struct EngineEnd {
  int exit_code = 0;              ///< 128 + signal when a signal ended it
  std::optional<int> stopped_by;  ///< the signal that this process got meanwhile
};

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

/// Starts a program alone in its group, with signals as they were.
pid_t start(const std::vector<std::string>& words, const HeldSignals& signals) {
  posix_spawn_file_actions_t files{};
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, STDERR_FILENO, STDOUT_FILENO);
  // A group that is not the terminal's would be stopped by reading from it.
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  sigset_t stops;
  sigemptyset(&stops);
  for (const int stop : kStops) sigaddset(&stops, stop);
  posix_spawnattr_t attributes{};
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setsigdefault(&attributes, &stops);
  posix_spawnattr_setsigmask(&attributes, &signals.before());
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int error =
      posix_spawnp(&child, arguments[0], &files, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  if (error == 0) return child;
  throw DataError(words.front(), fmt::format("cannot be started ({})", std::strerror(error)),
                  "Snakemake 7 (Debian: snakemake)");
}

constexpr double kGroup_s = 120;          // starting a job of a cluster takes seconds
constexpr std::size_t kMostInGroup = 50;  // a killed job loses at most one cell, but waits again

struct Group {
  std::vector<const PlannedCell*> cells;
  double seconds = 0, memory_mib = 0;
  bool known = true;
};

/// Cells of unknown cost stay alone.
std::vector<Group> groups_of(const StudyWork& work, const CostModel& costs, double group_s) {
  std::vector<Group> groups;
  for (const PlannedCell* planned : work.cells) {
    const auto seconds = costs.seconds(planned->cell), mib = costs.memory_mib(planned->cell);
    const bool joins = !groups.empty() && seconds && groups.back().known &&
                       groups.back().cells.size() < kMostInGroup &&
                       groups.back().seconds + *seconds <= group_s &&
                       groups.back().cells.back()->cell.data == planned->cell.data;
    if (!joins) groups.emplace_back();
    Group& group = groups.back();
    group.cells.push_back(planned);
    group.seconds += seconds.value_or(0);
    group.memory_mib = std::max(group.memory_mib, mib.value_or(0));
    group.known = group.known && seconds && mib;
  }
  return groups;
}

/// Three times the expected time and one and a half times the memory, as maps grow.
ordered_json group_json(const Group& group, std::size_t number) {
  constexpr double kUnknown_mib = 4000, kUnknownMinutes = 240;
  const double mib = group.known ? std::max(500.0, 1.5 * group.memory_mib) : kUnknown_mib;
  const double minutes = group.known ? 2 + 3 * group.seconds / 60 : kUnknownMinutes;
  ordered_json json = {{"id", fmt::format("{:05}", number)},
                       {"mem_mb", std::lround(std::ceil(mib))},
                       {"minutes", std::lround(std::ceil(minutes))},
                       {"keys", ordered_json::array()}};
  for (const PlannedCell* planned : group.cells) json["keys"].push_back(planned->cell.key);
  return json;
}

/// Writes what Snakemake reads to OUT/workflow, and returns the folder of the profile.
fs::path write_workflow(const fs::path& out, const ordered_json& plan, const std::string& profile) {
  const fs::path folder = out / "workflow";
  write_file_atomic(folder / "plan.json", json_text(plan));
  write_file_atomic(folder / "Snakefile", snakefile_asset());
  write_file_atomic(folder / "local/config.yaml", local_profile_asset());
  write_file_atomic(folder / "slurm/config.yaml", slurm_profile_asset());
  write_file_atomic(folder / "slurm_status.sh", slurm_status_asset());
  std::error_code ignored;
  fs::permissions(folder / "slurm_status.sh", fs::perms(0755), ignored);
  if (profile == "local" || profile == "slurm") return folder / profile;
  if (is_there(fs::path(profile) / "config.yaml")) return fs::absolute(profile);
  throw UsageError(fmt::format(
      "--profile: {} is no profile, expected local, slurm or a folder with config.yaml", profile));
}

/// Starts a program in a process group of its own and waits for it; its stdout goes to stderr,
/// which is for progress. A signal that would end this process ends the group in its place: as
/// Ctrl-C does, and by force what is left of it seconds later. Throws DataError where it cannot be
/// started.
EngineEnd run_in_group(const std::vector<std::string>& words) {
  constexpr std::chrono::seconds kGrace{20};
  const HeldSignals signals;
  const pid_t child = start(words, signals);
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
  constexpr std::chrono::milliseconds kLook{20};
  while (end.stopped_by && kill(-child, 0) == 0 && Clock::now() < deadline) {
    std::this_thread::sleep_for(kLook);
  }
  if (end.stopped_by) kill(-child, SIGKILL);  // what is left of the group
  end.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return end;
}

}  // namespace

StudyWork work_of(const StudyPlan& plan, const CostModel& costs) {
  StudyWork work;
  double seconds = 0;
  bool known = true;
  std::set<std::string> keys;
  for (const PlannedCell& planned : plan.cells) {
    if (planned.state == CellState::kDone || !keys.insert(planned.cell.key).second) continue;
    work.cells.push_back(&planned);
    const auto expected_s = costs.seconds(planned.cell);
    known = known && expected_s.has_value();
    seconds += expected_s.value_or(0);
  }
  if (known) work.cpu_s = seconds;
  return work;
}

void run_here(const StudyPlan& plan, unsigned threads) {
  clear_study(plan.out);
  const StudyWork work = work_of(plan, {});
  keep_freed_memory();
  for (std::size_t i = 0; i < work.cells.size(); ++i) {
    tell(fmt::format("cell {} of {}: {}", i + 1, work.cells.size(), work.cells[i]->cell.title()));
    compute_cell(*work.cells[i], plan.out, threads);
  }
}

int run_engine(const StudyPlan& plan, const CostModel& costs, const EngineOptions& options) {
  const fs::path out = fs::absolute(plan.out);
  const StudyWork work = work_of(plan, costs);
  clear_study(plan.out);
  if (work.cells.empty()) return 0;
  std::set<const StudyData*> made;
  for (const PlannedCell* planned : work.cells) {
    if (made.insert(planned->cell.data).second) made_data(plan.out, planned->cell.data->data);
  }
  // A program's command may name files from where it is typed. Other nodes need not have that
  // folder for anything else.
  const bool has_program = std::ranges::any_of(
      plan.study->methods, [](const StudyMethod& method) { return method.segment.is_program(); });
  const bool local = options.profile == "local";
  const double even_s = work.cpu_s.value_or(0) / 64;  // so that cores end together
  const auto groups = groups_of(work, costs, local ? std::min(kGroup_s, even_s) : kGroup_s);
  ordered_json json = {{"program", options.program.string()},
                       {"folder", (has_program ? fs::current_path() : out).string()},
                       {"study", fs::absolute(plan.study->file).string()},
                       {"out", out.string()},
                       {"threads", options.threads},
                       {"groups", ordered_json::array()}};
  for (const Group& group : groups) {
    json["groups"].push_back(group_json(group, json["groups"].size()));
  }
  const fs::path profile = write_workflow(out, json, options.profile);
  std::error_code ignored;
  fs::remove_all(out / "groups", ignored);  // of an earlier plan
  tell(fmt::format("{} in {} by Snakemake, in {}", counted(work.cells.size(), "cell"),
                   counted(groups.size(), "job"), plan.out.string()));
  const EngineEnd end = run_in_group({"snakemake", "--snakefile", out / "workflow/Snakefile",
                                      "--directory", out, "--profile", profile});
  if (end.stopped_by) {
    clear_study(plan.out);
    raise(*end.stopped_by);  // ends this process, as it would have without us
  }
  return end.exit_code;
}

}  // namespace mosbench
