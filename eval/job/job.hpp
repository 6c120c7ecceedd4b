#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mosbench/method.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/protocols/protocol.hpp"
#include "eval/result/result.hpp"

namespace mosbench {

/// Data that are simulated when they are needed.
struct Simulation {
  DatasetKind layout = DatasetKind::kSemanticKitti;
  std::string scene;  ///< a name, or the path of a file
  std::size_t scans = 0;
  std::uint64_t seed = 1;
};

/// Which sequences, and how they are read.
struct Data {
  std::filesystem::path path;
  std::optional<DatasetKind> kind = std::nullopt;  ///< recognised when not set
  std::vector<std::string> sequences = {};         ///< all when empty
  Reading reading = {};
  std::optional<Simulation> simulation = std::nullopt;  ///< makes the data; then `path` is unused
};

/// A setting and the value that was given to it.
struct SettingChange {
  std::string name;
  SettingValue value;

  bool operator==(const SettingChange&) const = default;
  auto operator<=>(const SettingChange&) const = default;
};

/// "a=1,b=2", as --set takes it.
std::string to_words(const std::vector<SettingChange>& changes);

struct TunedPreset;

/// A method, and what was said about its settings.
struct Segment {
  const MethodKind* method = nullptr;
  const Preset* preset = nullptr;           ///< null: the usual one of the data set
  std::vector<SettingChange> changes = {};  ///< of the preset's values; the last one of a name wins
  std::shared_ptr<const TunedPreset> tuned = nullptr;  ///< holds the preset and first changes
  std::string label = {};  ///< what the name of a folder of results should also say

  bool is_program() const;  ///< of the user, in a process of its own
};

/// What was said about scoring; the rest is the preset's.
struct RuleChoice {
  const Protocol* protocol = nullptr;
  std::optional<RangeGate> range = std::nullopt;
};

/// A question to be answered: what to read, how to find poses, segment and score. Nothing in it is
/// text that is still to be parsed.
struct Job {
  Data data = {};
  std::optional<OdometryChoice> odometry = std::nullopt;  ///< finds the poses; nothing: the data's
  Segment segment = {};
  RuleChoice rule = {};
};

/// Returns the preset of a job on data of this kind, the named or the usual one.
Preset preset_of(const Job& job, DatasetKind kind);

/// Returns the effective settings of the method: defaults < preset < changes. Throws UsageError
/// where they contradict each other.
Settings settings_of(const Job& job, DatasetKind kind);

/// Returns the rule by which labels on data of this kind are scored. Throws UsageError as
/// `settings_of` where the rule depends on settings.
ScoreRule rule_of(const Job& job, DatasetKind kind);

/// Says how a job's scans are disturbed, in the words of --perturb; empty for not at all.
std::string perturb_text(const Job& job);

/// Returns what decides the result of a job on one sequence, but the program: effective values,
/// whatever words were used. `input` stands for the sequence as it is before the job reads it,
/// `files` are the `program_files` of the method.
nlohmann::ordered_json identity_of(const Job& job, DatasetKind kind,
                                   const nlohmann::ordered_json& input, const std::string& files);

/// Returns the hash of an identity, 32 hexadecimal digits.
std::string key_of(const nlohmann::ordered_json& identity);

/// Returns the files that the command of a program of the user names, also behind a # that ends it
/// for the shell, and the command itself where it is found by PATH and is no part of the system.
/// Those that are gone are as they were `known`; without it, throws UsageError for one behind a #.
std::vector<ProgramFile> files_of_program(const MethodKind& method,
                                          const std::vector<ProgramFile>* known = nullptr);
/// Returns a hash of them; empty where there are none.
std::string hash_of_program(const std::vector<ProgramFile>& files);

/// Returns the command line that asks for a job, for a shell: "mosbench run DATA ...".
std::string to_words(const Job& job);
/// The part of it that says which sequences and how they are read.
std::string to_words(const Data& data);

/// Which data the user named, as typed.
struct DataWords {
  std::filesystem::path input = {};
  std::string dataset = "auto";
  std::vector<std::string> sequences = {};
  Reading reading = {};
};

/// What the user asked of `mosbench run`, as typed.
struct JobWords : DataWords {
  std::optional<std::string> method, preset, protocol, range;
  std::string moving = "now";  ///< or "ever" or "ever:SECONDS"
  std::optional<std::filesystem::path> config_file;
  OdometryOptions odometry;  ///< poses are found by it when a kind is named
  std::vector<std::string> assignments;
};

/// Parse them. Throw UsageError.
Data data_of(const DataWords& words);
Job job_of(const JobWords& words);

/// Opens the data. Throws UsageError and DataError.
Dataset open_dataset(const DataWords& words);

/// Returns what "KEY=VALUE" of --set says to a method. Throws UsageError.
SettingChange change_of(const std::string& assignment, const MethodKind& method);

/// "auto" is nothing. Throws UsageError for a name that is no data set kind.
std::optional<DatasetKind> dataset_kind_option(const std::string& name);

/// "MIN,MAX" in metres, MAX -1 for no limit. Throws UsageError.
RangeGate parsed_range(const std::string& text);
/// Returns the protocol with that range, or its own. Throws UsageError also for a limit that the
/// protocol does not know.
ScoreRule rule_of(const Protocol& protocol, const std::optional<std::string>& range);
/// The same by the protocol's name; without one, by that of the data set's usual preset.
ScoreRule rule_of(const std::optional<std::string>& protocol,
                  const std::optional<std::string>& range, DatasetKind kind);

}  // namespace mosbench
