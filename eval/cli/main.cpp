#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/files/errors.hpp"
#include "eval/cli/commands.hpp"
#include "mosbench_version.hpp"

namespace {

enum ExitCode { kOk = 0, kUsage = 2, kUnusableFiles = 3, kInternal = 70 };

constexpr const char* kFooter = R"(Examples:
  mosbench simulate --layout semantickitti --scene street --scans 40 --seed 1 --out sim
  mosbench run sim --out results/runs/sim
  mosbench score sim --predictions results/runs/sim --protocol semantickitti-mos
  mosbench report results/runs/sim -o report.html
  mosbench render results/runs/sim --scan 20 -o scan.png
  mosbench list protocols

Exit codes: 0 ok, 1 comparison failed, 2 wrong usage or configuration, 3 unusable files,
70 a fault of mosbench itself.
Each command has its own --help with examples.)";

bool looks_like_assignment(std::string_view argument) {
  const std::size_t equals = argument.find('=');
  if (equals == std::string_view::npos || equals == 0) return false;
  return std::ranges::all_of(argument.substr(0, equals),
                             [](char c) { return c == '_' || (c >= 'a' && c <= 'z'); });
}

/// `--set a=1 b=2 DATA` as `--set a=1 --set b=2 DATA`: the parser would take DATA for an
/// assignment.
std::vector<std::string> repeat_set_flag(const std::vector<std::string>& arguments) {
  std::vector<std::string> repeated;
  bool after_assignment = false;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const bool follows_flag = i > 0 && arguments[i - 1] == "--set";
    const bool assignment = looks_like_assignment(arguments[i]);
    if (after_assignment && assignment && !follows_flag) repeated.emplace_back("--set");
    after_assignment = assignment && (follows_flag || after_assignment);
    repeated.push_back(arguments[i]);
  }
  return repeated;
}

/// A file opened later must not become stdout or stderr by taking a number that was left free.
void occupy_standard_streams() {
  if (fcntl(STDOUT_FILENO, F_GETFD) == -1) {
    throw mosbench::DataError("stdout", "is closed", "somewhere to write the answer");
  }
  for (const int stream : {STDIN_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) == -1) open("/dev/null", O_RDWR);
  }
}

void print(const std::string& text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (written && std::fflush(stdout) == 0) return;
  throw mosbench::DataError("stdout", fmt::format("cannot be written ({})", std::strerror(errno)),
                            "somewhere to write the answer");
}

int fail(int exit_code, std::string_view message) {
  std::fputs(fmt::format("mosbench: {}\n", message).c_str(), stderr);
  return exit_code;
}

std::string answer_to(std::vector<std::string> arguments) {
  std::string answer;
  CLI::App app(
      "Moving object segmentation in LiDAR scans: segments sequences with HMM-MOS and "
      "scores labels by each benchmark's own rules.",
      "mosbench");
  app.set_version_flag("--version", fmt::format("mosbench {} ({})", mosbench::kMosbenchVersion,
                                                mosbench::kCompiler));
  app.footer(kFooter);
  app.require_subcommand(1);
  mosbench::add_simulate_command(app, answer);
  mosbench::add_run_command(app, answer);
  mosbench::add_profile_command(app, answer);
  mosbench::add_score_command(app, answer);
  mosbench::add_report_command(app, answer);
  mosbench::add_render_command(app, answer);
  mosbench::add_table_command(app, answer);
  mosbench::add_reproduce_command(app, answer);
  mosbench::add_breakdown_command(app, answer);
  mosbench::add_diff_command(app, answer);
  mosbench::add_compare_command(app, answer);
  mosbench::add_bless_command(app, answer);
  mosbench::add_stats_command(app, answer);
  mosbench::add_odometry_command(app, answer);
  mosbench::add_trajectory_command(app, answer);
  mosbench::add_convert_command(app, answer);
  mosbench::add_doctor_command(app, answer);
  mosbench::add_list_command(app, answer);
  const auto is_first = [&](const CLI::App* command) {
    return command->check_name(arguments.front());
  };
  if (!arguments.empty() && !arguments.front().starts_with('-') &&
      std::ranges::none_of(app.get_subcommands(nullptr), is_first)) {
    throw mosbench::UsageError(
        fmt::format("'{}' is not a command; see mosbench --help", arguments.front()));
  }
  try {
    std::ranges::reverse(arguments);  // as CLI11 expects them
    app.parse(std::move(arguments));
    return answer;
  } catch (const CLI::CallForVersion& version) {
    return std::string(version.what()) + '\n';
  } catch (const CLI::CallForHelp&) {
    const auto chosen = app.get_subcommands();
    return chosen.empty() ? app.help() : chosen.front()->help();
  } catch (const CLI::ParseError& error) {
    const auto chosen = app.get_subcommands();
    throw mosbench::UsageError(fmt::format("{}; see mosbench {}--help", error.what(),
                                           chosen.empty() ? "" : chosen.front()->get_name() + " "));
  }
}

/// Prints the answer; a bad one is an answer, too.
int answer(std::vector<std::string> arguments) {
  try {
    print(answer_to(std::move(arguments)));
    return kOk;
  } catch (const mosbench::Finding& finding) {
    print(finding.what());
    return finding.exit_code;
  }
}

}  // namespace

int main(int argc, char** argv) {
  // A full disk, a file size limit or a reader that went away then show as failed writes.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  try {
    occupy_standard_streams();
    return answer(repeat_set_flag({argv + 1, argv + argc}));
  } catch (const mosbench::UsageError& error) {
    return fail(kUsage, error.what());
  } catch (const mosbench::DataError& error) {
    return fail(kUnusableFiles, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(kUnusableFiles, error.what());
  } catch (const std::exception& error) {
    return fail(kInternal, fmt::format("internal fault: {}", error.what()));
  }
}
