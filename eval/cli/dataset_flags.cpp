#include "eval/cli/dataset_flags.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <sstream>

#include "datasets/perturb/perturbation.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/cli/help_text.hpp"
#include "eval/job/job_words.hpp"
#include "eval/result/reading_json.hpp"

namespace mosbench {
namespace {

std::string flag_of(std::string_view name) {
  std::string flag = "--" + std::string(name);
  std::ranges::replace(flag, '_', '-');
  return flag;
}

const ReadingField& field_named(std::string_view name) {
  return *std::ranges::find(reading_fields(), name, &ReadingField::name);
}

std::vector<std::string_view> read_keys() {
  std::vector<std::string_view> names;
  for (const ReadingField& field : reading_fields()) {
    if (field.is_rare) names.push_back(field.name);
  }
  return names;
}

/// Takes "pose_frame=camera,bin_columns=5". Throws UsageError naming the key.
void take_read_keys(Reading& reading, const std::string& text) {
  for (const auto& [key, value] : key_values("--read", text)) {
    const std::vector<std::string_view> names = read_keys();
    if (std::ranges::find(names, key) == names.end()) {
      throw UsageError(fmt::format("--read {}: is not known, expected one of {} (nearest: {})", key,
                                   fmt::join(names, ", "), nearest_name(key, names)));
    }
    try {
      set_field(reading, key, value);
    } catch (const UsageError&) {
      throw UsageError(fmt::format("--read {}: '{}' is not legal, expected {}", key, value,
                                   field_named(key).legal));
    }
  }
}

/// Adds a field of Reading as a flag that fills it.
CLI::Option* add_field(CLI::App& command, const ReadingField& field, Reading& reading) {
  CLI::Option* flag = command.add_option_function<std::string>(
      flag_of(field.name),
      [&reading, name = field.name](const std::string& text) { set_field(reading, name, text); },
      field.meaning);
  if (!field.type.empty()) flag->type_name(field.type);
  if (!field.choices.empty()) flag->check(CLI::IsMember(field.choices));
  return flag;
}

void add_reading_flags(CLI::App& command, Reading& reading) {
  for (const ReadingField& field : reading_fields()) {
    if (field.is_rare || field.name == "poses") continue;
    add_field(command, field, reading)->group(kReadingGroup);
  }
  command
      .add_option_function<std::vector<std::string>>(
          "--read",
          [&reading](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) take_read_keys(reading, text);
          },
          "What is rarely to be said about the files; the keys stand below")
      ->type_name("KEY=VALUE,...")
      ->allow_extra_args(false)
      ->group(kReadingGroup);
}

void add_poses_flag(CLI::App& command, Reading& reading) {
  add_field(command, field_named("poses"), reading);
}

}  // namespace

std::string flag_words(std::string_view name, std::string_view value) {
  return flag_of(name) + (value.empty() ? "" : " ") + std::string(value);
}

void add_dataset_flags(CLI::App& command, std::filesystem::path& input, std::string& dataset,
                       std::vector<std::string>& sequences, Reading& reading, const char* name) {
  add_scan_dataset_flags(command, input, dataset, sequences, reading, name);
  add_poses_flag(command, reading);
}

void add_scan_dataset_flags(CLI::App& command, std::filesystem::path& input, std::string& dataset,
                            std::vector<std::string>& sequences, Reading& reading,
                            const char* name) {
  command
      .add_option(
          name, input,
          std::string_view(name) == "RUN"
              ? "Folder that `mosbench run` or `mosbench score` "
                "wrote, or a result.json"
              : "Root of a data set, one sequence folder, a bag, a scan, or a folder of them")
      ->type_name("DIR")
      ->required();
  add_dataset_kind_flag(command, dataset);
  command.add_option("--sequences", sequences, "Only these sequences, a,b (default: all)")
      ->type_name("NAMES")
      ->delimiter(',')
      ->allow_extra_args(false);
  add_reading_flags(command, reading);
}

CLI::Option* add_perturb_flag(CLI::App& command, std::optional<Perturbation>& perturb,
                              const std::string& description) {
  return command
      .add_option_function<std::string>(
          "--perturb", [&](const std::string& text) { perturb = parse_perturbation(text); },
          description + ", in this order, see `mosbench list perturbations`")
      ->type_name("KIND=STRENGTH,...,seed=N");
}

bool chooses_scans(const CLI::Option& option) {
  std::filesystem::path input;
  std::string dataset;
  std::vector<std::string> sequences;
  Reading reading;
  CLI::App command;
  add_scan_dataset_flags(command, input, dataset, sequences, reading);
  return command.get_option_no_throw(option.get_name()) != nullptr;
}

std::vector<std::pair<std::string, std::string>> key_values(std::string_view flag,
                                                            const std::string& text) {
  std::vector<std::pair<std::string, std::string>> pairs;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw UsageError(fmt::format("{}: '{}' has no value, expected key=value", flag, part));
    }
    pairs.emplace_back(part.substr(0, equals), part.substr(equals + 1));
  }
  return pairs;
}

std::vector<std::string> reading_names() {
  std::vector<std::string> names;
  for (const ReadingField& field : reading_fields()) names.push_back(field.name);
  return names;
}

std::string read_keys_text() {
  std::string text = "Keys of --read:\n";
  for (const ReadingField& field : reading_fields()) {
    if (!field.is_rare) continue;
    std::string meaning = field.meaning;
    meaning[0] = static_cast<char>(std::tolower(meaning[0]));
    if (!field.usual.empty()) meaning += fmt::format(" (default: {})", field.usual);
    text += help_row(field.name, fmt::format("{}; {}", field.legal, meaning));
  }
  return text;
}

Reading reading_of(std::vector<std::string> flags) {
  Reading reading;
  CLI::App command;
  add_reading_flags(command, reading);
  add_poses_flag(command, reading);
  std::ranges::reverse(flags);  // as CLI11 expects them
  try {
    command.parse(std::move(flags));
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  return reading;
}

void add_dataset_kind_flag(CLI::App& command, std::string& dataset) {
  command.add_option("--dataset", dataset, "Layout of DATA, see `mosbench list datasets`")
      ->type_name("DATASET")
      ->capture_default_str();
}

void add_threads_flag(CLI::App& command, unsigned& threads) {
  command.add_option("--threads", threads, "Threads; results do not depend on it (default: all)")
      ->check(CLI::Range(1U, 1024U));
}

}  // namespace mosbench
