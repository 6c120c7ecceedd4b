#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "datasets/sequence/reading.hpp"

namespace mosbench {

/// Group of the flags that say how data are read.
inline constexpr const char* kReadingGroup = "Reading";

/// Words an option as a flag, for `word_options_by`: "--pose-frame lidar".
std::string flag_words(std::string_view name, std::string_view value);

/// Adds what every command that reads sequences takes: DATA (or another `name`), --dataset,
/// --sequences and the flags of the group Reading. What they fill must outlive the parsing.
void add_dataset_flags(CLI::App& command, std::filesystem::path& input, std::string& dataset,
                       std::vector<std::string>& sequences, Reading& reading,
                       const char* name = "DATA");

/// Adds the same without --poses.
void add_scan_dataset_flags(CLI::App& command, std::filesystem::path& input, std::string& dataset,
                            std::vector<std::string>& sequences, Reading& reading,
                            const char* name = "DATA");

/// Returns whether an option of any command is one of these.
bool chooses_scans(const CLI::Option& option);

/// Returns what flags of the group Reading say, without a command. Throws UsageError.
Reading reading_of(std::vector<std::string> flags);

/// Returns the names of these flags and the keys of --read, in the words of Python: "pose_frame".
std::vector<std::string> reading_names();

/// The keys of --read with their values and meanings, for --help-all.
std::string read_keys_text();

/// Returns the pairs of "key=value,key=value". Throws UsageError naming the flag.
std::vector<std::pair<std::string, std::string>> key_values(std::string_view flag,
                                                            const std::string& text);

/// Adds --perturb; `description` ends before where the
/// kinds are listed.
CLI::Option* add_perturb_flag(CLI::App& command, std::optional<Perturbation>& perturb,
                              const std::string& description);

/// Adds --dataset alone.
void add_dataset_kind_flag(CLI::App& command, std::string& dataset);

/// Adds --threads; without it, `threads` stays as it is.
void add_threads_flag(CLI::App& command, unsigned& threads);

}  // namespace mosbench
