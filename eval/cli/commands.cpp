#include "eval/cli/commands.hpp"

#include <fmt/format.h>

#include <array>
#include <new>
#include <system_error>

#include "datasets/text/errors.hpp"
#include "eval/cli/command_line.hpp"

namespace mosbench {

std::span<const Command> commands() {
  static constexpr std::array kCommands = {
      Command{"simulate", "Write a simulated data set with exact truth", add_simulate},
      Command{"run", "Segment sequences and score the result", add_run},
      Command{"profile", "Show where the time of a run goes", add_profile},
      Command{"score", "Score predictions of any method, or a cleaned map", add_score},
      Command{"report", "Write an HTML page that shows results", add_report},
      Command{"render", "Draw scans of a result as pictures or a video", add_render},
      Command{"table", "Print a published table with measured values next to it", add_table},
      Command{"rank", "Rank runs on the same scans, with what differs in them", add_rank},
      Command{"stats", "Show how good a run is, and by what", add_stats, "png"},
      Command{"compare", "Judge a run against another, or show what differs", add_compare, "junit"},
      Command{"info", "Tell what a recording is", add_info},
      Command{"doctor", "Find what is wrong with a data set", add_doctor},
      Command{"odometry", "Find the poses of scans", add_odometry},
      Command{"trajectory", "Score poses against true ones", add_trajectory, "png"},
      Command{"truth", "Make truth of your own: tracks to decide on, and labels", add_truth},
      Command{"map", "Write a map of a drive without what moved", add_map},
      Command{"convert", "Write a data set in another layout", add_convert},
      Command{"list", "List data sets, methods, presets, protocols and more", add_list},
      Command{"help", "Show the help of a command", add_help},
  };
  return kCommands;
}

Failure current_failure() {
  try {
    throw;
  } catch (const UsageError& error) {
    return {kUsage, error.what()};
  } catch (const DataError& error) {
    return {kUnusable, error.what()};
  } catch (const std::filesystem::filesystem_error& error) {
    return {kUnusable, error.what()};
  } catch (const std::system_error& error) {
    if (error.code() != std::errc::resource_unavailable_try_again) {
      return {kInternal, fmt::format("internal fault: {}", error.what())};
    }
    return {kUnusable, "the machine gives no more threads, expected fewer in --threads"};
  } catch (const std::bad_alloc&) {
    return {kUnusable, "the machine gives no more memory, expected smaller input"};
  } catch (const std::exception& error) {
    return {kInternal, fmt::format("internal fault: {}", error.what())};
  }
}

}  // namespace mosbench
