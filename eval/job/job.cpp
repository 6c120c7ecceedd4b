#include "eval/job/job.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <iomanip>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "datasets/disk/files.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/exec/exec_method.hpp"
#include "eval/job/setting_changes.hpp"
#include "eval/job/tuned_preset.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/result/reading_json.hpp"
#include "eval/result/settings_json.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// Where the shell finds a command that is no path; empty where that is a part of the system, which
/// changes with every update.
fs::path found_by_path(const std::string& command) {
  const char* path = std::getenv("PATH");
  if (path == nullptr || command.find('/') != std::string::npos) return command;
  std::istringstream folders(path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (!is_there(fs::path(folder) / command)) continue;
    const bool is_system = folder.starts_with("/usr") || folder.starts_with("/bin");
    return is_system ? fs::path() : fs::path(folder) / command;
  }
  return command;
}

/// Throws UsageError for a limit that the protocol does not know.
void check_range(const RangeGate& range, const Protocol& protocol) {
  if (protocol.range_rule != RangeRule::kNone || range == protocol.default_range) return;
  throw UsageError(fmt::format("--range: protocol {} counts points at every range, expected none",
                               protocol.name));
}

/// Returns the effective settings; where they are refused, why.
ordered_json config_of(const Job& job, DatasetKind kind) {
  try {
    ordered_json config = to_json(settings_of(job, kind));
    if (job.segment.is_program()) config.erase("timeout_s");  // decides no label
    return config;
  } catch (const UsageError& error) {
    return {{"refused", error.what()}};
  }
}

ordered_json rule_json(const Job& job, DatasetKind kind) {
  try {
    return rule_json(rule_of(job, kind), "name");
  } catch (const UsageError&) {
    return nullptr;  // as the settings are refused
  }
}

std::string flag(const char* name, const std::string& value) {
  return fmt::format(" --{} {}", name, shell_word(value));
}

/// The settings that were given by name.
std::vector<SettingChange> changes_of(const OdometryChoice& choice) {
  std::vector<SettingChange> changes;
  for (const Setting& setting : choice.settings.all()) {
    const Setting& usual = *choice.kind->defaults.find(setting.name);
    const bool is_flag = choice.says_deskew && setting.name == "deskew";
    if (setting.value == usual.value || is_flag) continue;
    changes.push_back({std::string(setting.name), setting.value});
  }
  return changes;
}

/// The method with the settings that a study chose.
Segment tuned_segment(const std::filesystem::path& file, const std::optional<std::string>& method) {
  const auto tuned = std::make_shared<const TunedPreset>(read_tuned_preset(file));
  if (method && method_named(*method).title != tuned->method->title) {
    throw UsageError(fmt::format("--preset {}: is of method {}, expected no --method or this one",
                                 file.string(), tuned->method->title));
  }
  return {.method = tuned->method,
          .preset = tuned->base,
          .changes = tuned->settings,
          .tuned = tuned,
          .label = file.stem().string()};
}

Segment segment_before_changes(const JobWords& words) {
  if (!words.preset) return {.method = &method_of(words.method, words.preset)};
  if (is_preset_file(*words.preset)) return tuned_segment(*words.preset, words.method);
  return {.method = &method_of(words.method, words.preset), .preset = &preset_named(*words.preset)};
}

Segment segment_of(const JobWords& words) {
  Segment segment = segment_before_changes(words);
  segment.method = &taking(*segment.method, words.assignments);
  ChangeReader reader(*segment.method);
  if (words.config_file) reader.read_file(*words.config_file);
  reader.read_word("moving", words.moving);
  for (const std::string& assignment : words.assignments) reader.read_assignment(assignment);
  std::ranges::move(reader.take(), std::back_inserter(segment.changes));
  if (words.moving != "now") segment.label += words.moving;
  std::ranges::replace(segment.label, ':', '-');
  return segment;
}

}  // namespace

std::string to_words(const std::vector<SettingChange>& changes) {
  std::string words;
  for (const SettingChange& change : changes) {
    words += fmt::format("{}{}={}", words.empty() ? "" : ",", change.name, to_string(change.value));
  }
  return words;
}

bool Segment::is_program() const { return method->name == kExecKind; }

Preset preset_of(const Job& job, DatasetKind kind) {
  return job.segment.preset != nullptr ? preset_for(*job.segment.preset, kind)
                                       : default_preset(kind);
}

Settings settings_of(const Job& job, DatasetKind kind) {
  const MethodKind& method = *job.segment.method;
  Settings settings = settings_of(preset_of(job, kind), method);
  for (const SettingChange& change : job.segment.changes) settings.set(change.name, change.value);
  try {
    method.check(settings);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("configuration: {}", error.what()));
  }
  return settings;
}

ScoreRule rule_of(const Job& job, DatasetKind kind) {
  const Protocol& protocol = job.rule.protocol != nullptr
                                 ? *job.rule.protocol
                                 : protocol_named(preset_of(job, kind).protocol);
  if (job.rule.range) {
    check_range(*job.rule.range, protocol);
    return {&protocol, *job.rule.range};
  }
  // A benchmark with a limit of the distance is scored over the range it was run at; a box is its
  // own.
  if (protocol.range_rule == RangeRule::kNone || protocol.default_range.max_m <= 0 ||
      protocol.range_shape == RangeShape::kBox) {
    return {&protocol, protocol.default_range};
  }
  const Settings settings = settings_of(job, kind);
  const bool known = settings.find(common_settings::kMinRange_m) != nullptr &&
                     settings.find(common_settings::kMaxRange_m) != nullptr;
  return {&protocol, known ? RangeGate{settings.number(common_settings::kMinRange_m),
                                       settings.number(common_settings::kMaxRange_m)}
                           : protocol.default_range};
}

std::string perturb_text(const Job& job) {
  return job.data.reading.perturb ? to_string(*job.data.reading.perturb) : "";
}

ordered_json identity_of(const Job& job, DatasetKind kind, const ordered_json& input,
                         const std::string& files) {
  ordered_json identity = {{"input", input},
                           {"method", std::string(job.segment.method->title)},
                           {"config", config_of(job, kind)},
                           {"protocol", rule_json(job, kind)},
                           {"perturb", perturb_text(job)}};
  if (job.odometry) {
    identity["poses"] = to_json(members_of(statement_of(*job.odometry)));
    if (job.odometry->says_deskew) identity["deskew"] = to_string(job.odometry->deskew);
  }
  if (job.odometry && job.odometry->drop_moving) identity["drop_moving"] = true;
  if (!files.empty()) identity["program"] = files;
  return identity;
}

std::string key_of(const ordered_json& identity) { return hash_of_text(identity.dump()); }

namespace {

/// Returns a word of a comment without the marks around it: "(weights.pt)," is weights.pt.
std::string bare(const std::string& word) {
  const std::size_t first = word.find_first_not_of("#(["), last = word.find_last_not_of(",;:)]");
  return first == word.npos || last == word.npos || last < first
             ? ""
             : word.substr(first, last + 1 - first);
}

/// Whether it is the name of a file, not a word of a sentence: by an extension of two letters.
bool names_file(std::string_view word) {
  if (word.find("://") != word.npos) return false;
  const std::string extension = fs::path(word).extension().string();
  return extension.size() > 2 && std::ranges::all_of(extension.substr(1), [](unsigned char c) {
           return std::isalpha(c) != 0;
         });
}

}  // namespace

std::vector<ProgramFile> files_of_program(const MethodKind& method,
                                          const std::vector<ProgramFile>* known) {
  std::vector<ProgramFile> files;
  if (method.name != kExecKind) return files;
  std::istringstream command{std::string(method.title.substr(std::string_view("exec:").size()))};
  bool in_comment = false;
  for (std::string word; !(command >> std::ws).eof();) {
    const bool is_first = command.tellg() == 0;
    const char quote = static_cast<char>(command.peek());
    if (quote == '"' || quote == '\'') {
      command >> std::quoted(word, quote);
    } else {
      command >> word;
      in_comment = in_comment || word.starts_with('#');
    }
    if (in_comment) word = bare(word);
    fs::path file = is_first ? found_by_path(word) : fs::path(word);
    std::error_code ignored;
    if (known != nullptr && !file.empty() && !fs::exists(file, ignored)) {
      const auto gone =
          std::ranges::find(*known, fs::absolute(file).lexically_normal(), &ProgramFile::path);
      if (gone != known->end()) files.push_back(*gone);
      continue;
    }
    if (in_comment && names_file(word) && !fs::exists(file, ignored)) {
      throw UsageError(fmt::format(
          "--method {}: names {} behind its #, which does not exist, expected files that do",
          method.title, word));
    }
    if (!fs::is_regular_file(file, ignored)) continue;
    files.push_back(
        {fs::absolute(file).lexically_normal(), fs::file_size(file), hash_of_file(file)});
  }
  return files;
}

std::string hash_of_program(const std::vector<ProgramFile>& files) {
  std::string contents;
  for (const ProgramFile& file : files) contents += file.hash + "\n";
  return contents.empty() ? contents : hash_of_text(contents);
}

std::string to_words(const Data& data) {
  std::string words = shell_word(data.path.string());
  if (data.kind) words += flag("dataset", std::string(to_string(*data.kind)));
  if (!data.sequences.empty()) {
    words += flag("sequences", fmt::format("{}", fmt::join(data.sequences, ",")));
  }
  return words + told_flags(data.reading);
}

std::string to_words(const Job& job) {
  std::string words = "mosbench run " + to_words(job.data);
  const bool is_program = job.segment.is_program();
  words += flag("method",
                std::string(is_program ? job.segment.method->title : job.segment.method->name));
  const std::shared_ptr<const TunedPreset>& tuned = job.segment.tuned;
  if (tuned) {
    words += flag("preset", tuned->file.string());
  } else if (job.segment.preset != nullptr) {
    words += flag("preset", std::string(job.segment.preset->name));
  }
  if (job.odometry) {
    std::string odometry(job.odometry->kind->name);
    const std::string changes = to_words(changes_of(*job.odometry));
    if (!changes.empty()) odometry += "," + changes;
    if (job.odometry->drop_moving) odometry += ",drop_moving=on";
    words += flag("odometry", odometry);
  }
  if (job.rule.protocol != nullptr) words += flag("protocol", std::string(job.rule.protocol->name));
  if (job.rule.range) {
    words += flag("range", fmt::format("{},{}", job.rule.range->min_m, job.rule.range->max_m));
  }
  const auto of_preset = static_cast<std::ptrdiff_t>(tuned ? tuned->settings.size() : 0);
  const std::string changes = to_words(std::vector<SettingChange>(
      job.segment.changes.begin() + of_preset, job.segment.changes.end()));
  return changes.empty() ? words : words + flag("set", changes);
}

Data data_of(const DataWords& words) {
  return {.path = words.input,
          .kind = dataset_kind_option(words.dataset),
          .sequences = words.sequences,
          .reading = words.reading};
}

Dataset open_dataset(const DataWords& words) {
  return open_dataset(words.input,
                      {dataset_kind_option(words.dataset), words.sequences, words.reading},
                      progress_over_sequences("refine poses of"));
}

Job job_of(const JobWords& words) {
  Job job;
  job.segment = segment_of(words);
  job.odometry = named_odometry(words.odometry, words.reading);
  job.data = data_of(words);
  if (job.odometry) job.data.reading.poses = ByOdometry{};
  if (words.protocol) job.rule.protocol = &protocol_named(*words.protocol);
  if (words.range) job.rule.range = parsed_range(*words.range);
  return job;
}

SettingChange change_of(const std::string& assignment, const MethodKind& method) {
  ChangeReader reader(method);
  reader.read_assignment(assignment);
  const std::vector<SettingChange> changes = reader.take();
  if (changes.size() == 1) return changes.front();
  throw UsageError(
      fmt::format("--set {}: stands for {}, expected one setting", assignment, to_words(changes)));
}

std::optional<DatasetKind> dataset_kind_option(const std::string& name) {
  if (name == "auto") return std::nullopt;
  if (const std::optional<DatasetKind> kind = dataset_kind_from_string(name)) return kind;
  throw UsageError(
      fmt::format("--dataset: '{}' is not known, expected auto, {}", name, dataset_kind_names()));
}

RangeGate parsed_range(const std::string& text) {
  RangeGate range;
  int used = 0;
  const int fields = std::sscanf(text.c_str(), "%lf,%lf%n", &range.min_m, &range.max_m, &used);
  const bool whole = fields == 2 && static_cast<std::size_t>(used) == text.size();
  if (whole && range.min_m >= 0.0 && (range.max_m > range.min_m || range.max_m == -1.0)) {
    return range;
  }
  throw UsageError(fmt::format(
      "--range: '{}' is no range, expected MIN,MAX in metres with 0 <= MIN < MAX (MAX -1: none)",
      text));
}

ScoreRule rule_of(const Protocol& protocol, const std::optional<std::string>& range) {
  if (!range) return {&protocol, protocol.default_range};
  const RangeGate asked = parsed_range(*range);
  check_range(asked, protocol);
  return {&protocol, asked};
}

ScoreRule rule_of(const std::optional<std::string>& protocol,
                  const std::optional<std::string>& range, DatasetKind kind) {
  return rule_of(protocol_named(protocol.value_or(std::string(default_preset(kind).protocol))),
                 range);
}

}  // namespace mosbench
