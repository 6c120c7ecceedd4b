#pragma once

#include <CLI/CLI.hpp>
#include <concepts>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "eval/job/job.hpp"

// Flags that several commands have, and what adds one.

namespace mosbench {

/// Group of the flags that say how data are read.
inline constexpr const char* kReadingGroup = "Reading";
/// Group of flags that few people need; like those of the group Reading they stand in --help-all.
inline constexpr const char* kRareGroup = "Rarely needed";

/// Adds a flag or an argument as help shows it, "--data DIR" or "WHAT". What is filled must
/// outlive the parsing; of a function that takes the text a copy is kept.
template <typename Target>
CLI::Option* add(CLI::App& command, const std::string& shown, Target& target,
                 const std::string& meaning) {
  const std::size_t blank = shown.find(' ');
  const std::string name = shown.substr(0, blank);
  CLI::Option* option = nullptr;
  if constexpr (std::invocable<Target&, const std::string&>) {
    option = command.add_option_function<std::string>(name, target, meaning);
  } else {
    option = command.add_option(name, target, meaning);
  }
  return blank == shown.npos ? option : option->type_name(shown.substr(blank + 1));
}

/// Checks that a flag is a number in this range: CLI::Range lets nan pass.
CLI::Validator number_in(double lowest, double highest);

/// Adds a flag that takes a list, "a,b", in one argument.
CLI::Option* add_list(CLI::App& command, const std::string& shown, std::vector<std::string>& target,
                      const std::string& meaning);

/// Adds what every command that reads sequences takes: DATA (or another `name`), --dataset,
/// --sequences and the flags of the group Reading, --poses among them.
void add_dataset_flags(CLI::App& command, DataWords& words, const char* name = "DATA");
/// Adds the same without --poses.
void add_scan_dataset_flags(CLI::App& command, DataWords& words, const char* name = "DATA");
/// Adds --dataset alone.
CLI::Option* add_dataset_kind_flag(CLI::App& command, std::string& dataset);

/// Adds the arguments that say what is segmented and how: those of `add_dataset_flags`, --method,
/// --preset, --set and --threads.
void add_method_flags(CLI::App& command, JobWords& words, unsigned& threads);

/// Adds --odometry KIND[:PRESET][,KEY=VALUE,...], which says how poses are found. Of what it does
/// `description` says the first half.
void add_odometry_flag(CLI::App& command, OdometryOptions& odometry,
                       const std::string& description);

/// Adds --threads; without it, `threads` stays as it is.
void add_threads_flag(CLI::App& command, unsigned& threads);
/// Adds --allow-stale, for tables of results, see `refuse_stale`.
void add_stale_flag(CLI::App& command, bool& allow_stale);

/// Returns the name of a type whose values are `names`, as CLI11 names those that it checks: help
/// and completion list them.
std::string type_of_names(const std::vector<std::string_view>& names);

/// Returns the pairs of "key=value,key=value"; the value of lidars may have commas itself. Throws
/// UsageError naming the flag.
std::vector<std::pair<std::string, std::string>> key_values(std::string_view flag,
                                                            const std::string& text);

/// Words an option as a flag, for `word_options_by`: "--pose-frame lidar".
std::string flag_words(std::string_view name, std::string_view value);

/// Returns those of the arguments and flags that were given to `command` and are wanted, a blank in
/// front of each word.
std::string given_words(const CLI::App& command,
                        const std::function<bool(const CLI::Option&)>& wanted);

/// Throws as `check_output` for the file that a command's answer goes to, by the format that it was
/// asked for: before its work.
void check_answer_file(const CLI::App& command, const std::filesystem::path& file);

/// Returns what flags of the group Reading say, without a command. Throws UsageError.
Reading reading_of(std::vector<std::string> flags);

}  // namespace mosbench
