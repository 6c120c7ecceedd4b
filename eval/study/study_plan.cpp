#include "eval/study/study_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iomanip>
#include <map>
#include <sstream>

#include "datasets/disk/files.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/simulator/scene_json.hpp"
#include "datasets/simulator/simulate.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "datasets/text/text.hpp"
#include "eval/engine/run_plan.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/result/reading_json.hpp"
#include "eval/result/version.hpp"
#include "eval/study/study_scoring.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

ordered_json simulation_json(const StudySimulation& simulation) {
  return {{"layout", to_string(simulation.layout)},
          {"scene", hash_of_text(format_scene(load_scene(simulation.scene)))},
          {"scans", simulation.scans},
          {"seed", simulation.seed}};
}

/// Names and sizes of all files, and the bytes of those that are no scans: the same for a copy of
/// the data, and known without reading scans.
std::string content_of(const Sequence& sequence) {
  std::string listing;
  for (const fs::path& file : sequence.files()) {
    listing += fmt::format("{} {}\n", file.filename().string(), size_of(file));
  }
  for (const fs::path& file : sequence.recording().files) listing += hash_of_file(file) + "\n";
  return hash_of_text(listing);
}

/// What a cell has to say of a sequence on disk. One that cannot be opened says why.
ordered_json sequence_json(const StudyData& data, const std::string& name) {
  ordered_json json;
  try {
    Reading reading = data.reading;
    const Dataset dataset =
        open_dataset(data.path, {dataset_kind_option(data.dataset), {name}, reading});
    reading.poses = OwnPoses{};
    json = {{"dataset", to_string(dataset.kind)},
            {"content", content_of(*dataset.sequences.front())},
            {"reading", told_json(reading)}};
  } catch (const std::runtime_error& error) {  // DataError, or UsageError of what it lacks
    json = {{"unreadable", error.what()}};
  }
  return json;
}

/// The bytes of all files that the command of a method of the user names; nothing for other
/// methods.
std::string program_of(const StudyMethod& method) {
  std::string contents;
  if (!is_program(method)) return contents;
  std::istringstream command(method.method.substr(5));
  for (std::string word; !(command >> std::ws).eof();) {
    const char quote = static_cast<char>(command.peek());
    if (quote == '"' || quote == '\'') {
      command >> std::quoted(word, quote);
    } else {
      command >> word;
    }
    std::error_code ignored;
    if (fs::is_regular_file(word, ignored)) contents += hash_of_file(word) + "\n";
  }
  return contents;
}

struct KnownSequence {
  DatasetKind kind;
  std::string name;
  ordered_json identity;
};

/// Throws UsageError for a sequence that the simulation does not write.
std::vector<KnownSequence> simulated_sequences(const StudyData& data) {
  const std::vector<std::string> written =
      simulated_names(data.simulation->layout, load_scene(data.simulation->scene));
  const std::vector<std::string>& names = data.sequences.empty() ? written : data.sequences;
  const ordered_json json = {{"simulated", simulation_json(*data.simulation)},
                             {"reading", told_json(data.reading)}};
  std::vector<KnownSequence> sequences;
  for (const std::string& name : names) {
    if (std::ranges::find(written, name) == written.end()) {
      throw UsageError(fmt::format("{}: simulates no sequence {}, expected {}", data.name,
                                   mosbench::quoted(name), fmt::join(written, ", ")));
    }
    sequences.push_back({data.simulation->layout, name, json});
  }
  return sequences;
}

std::vector<KnownSequence> sequences_of(const StudyData& data) {
  if (data.simulation) return simulated_sequences(data);
  std::vector<KnownSequence> sequences;
  std::optional<DatasetKind> kind;
  const OpenOptions options{dataset_kind_option(data.dataset), data.sequences, data.reading};
  try {
    for (const SequenceFolder& folder : find_sequences(data.path, options, kind)) {
      sequences.push_back({*kind, folder.name, sequence_json(data, folder.name)});
    }
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{}: {}", data.name, error.what()));
  }
  return sequences;
}

/// Lists the cells of one method on one sequence.
class CellLister {
 public:
  CellLister(const Study& study, std::vector<StudyCell>& cells) : study_(study), cells_(cells) {
    for (const StudyMethod& method : study.methods) program_of_[&method] = program_of(method);
  }

  void list(StudyCell cell, const ordered_json& sequence) {
    cell.axis = nullptr;
    cell.seed = 0;
    cell.assignments = cell.method->assignments;
    cell.cost_key = hash_of_text(ordered_json{
        {"data", sequence},
        {"method", cell.method->method},
        {"preset", cell.method->preset.value_or("")},
        {"odometry", cell.odometry},
        {"set",
         cell.method->assignments}}.dump());
    add(cell, sequence);
    for (const StudyAxis& axis : study_.axes) {
      cell.axis = &axis;
      for (std::size_t i = 0; i < axis.values.size(); ++i) {
        cell.value = axis.values[i];
        cell.assignments = assignments_of(*cell.method, axis, i);
        const bool lacks_settings = cell.assignments.size() == cell.method->assignments.size();
        if (axis.kind == nullptr && lacks_settings) continue;
        const bool random = axis.kind != nullptr && axis.kind->is_random;
        cell.seed = 0;
        if (!random) add(cell, sequence);
        for (const std::uint64_t seed : study_.seeds) {
          cell.seed = seed;
          if (random) add(cell, sequence);
        }
      }
    }
  }

 private:
  void add(StudyCell cell, const ordered_json& sequence) {
    const std::string& program = program_of_.at(cell.method);
    cell.identity = {{"format", 1},
                     {"data", sequence},
                     {"sequence", cell.sequence},
                     {"method", cell.method->method},
                     {"preset", cell.method->preset.value_or("")},
                     {"set", cell.assignments},
                     {"odometry", cell.odometry},
                     {"perturb", cell.perturb() ? to_string(*cell.perturb()) : ""},
                     {"protocol", study_.protocol.value_or("")},
                     {"range", study_.range.value_or("")}};
    if (!program.empty()) cell.identity["program"] = program;
    cell.key = hash_of_text(cell.identity.dump());
    const auto [known, is_new] = known_.emplace(cell.key, cells_.size());
    if (!is_new) return check_same_row(cells_[known->second], cell);
    cells_.push_back(std::move(cell));
  }

  /// A value that is listed twice is one cell; data or methods that are the same under two names
  /// would leave one of them without any.
  void check_same_row(const StudyCell& first, const StudyCell& second) const {
    const bool same = first.data == second.data && first.sequence == second.sequence &&
                      first.method == second.method && first.odometry == second.odometry;
    if (same) return;
    throw UsageError(
        fmt::format("{}: \"{}\" and \"{}\" are the same run, expected data and methods "
                    "that differ in more than the name",
                    study_.file.string(), first.title(), second.title()));
  }

  const Study& study_;
  std::vector<StudyCell>& cells_;
  std::map<const StudyMethod*, std::string> program_of_;
  std::map<std::string, std::size_t> known_;  ///< place in `cells_` of each key
};

/// Whether a record has the members that tables read. Throws a JSON exception where one is missing.
bool is_whole(const ordered_json& record, bool failed) {
  if (!record.at("version").is_string()) return false;
  if (failed) return record.at("failure").is_string();
  const ordered_json& summary = record.at("summary");
  const bool scored = summary.is_object() || summary.is_null();
  const bool listed = std::ranges::all_of(record.at("worst"), [](const ordered_json& scan) {
    return scan.at("stem").is_string() && scan.at("iou").is_number();
  });
  return scored && listed && record.at("simulated").is_boolean() && record.at("timing").is_object();
}

/// What a file says of a cell; nothing where it is missing, damaged or of another cell, which is
/// then computed again.
std::optional<ordered_json> record_in(const fs::path& file, const std::string& key, bool failed) {
  if (!is_there(file)) return std::nullopt;
  try {
    ordered_json record = parse_json(read_file(file), file);
    if (record.at("key") == key && is_whole(record, failed)) return record;
  } catch (const DataError&) {
  } catch (const nlohmann::json::exception&) {
  }
  return std::nullopt;
}

PlannedCell look_up(StudyCell cell, const fs::path& out) {
  const auto result = record_in(record_file(out, cell.key), cell.key, false);
  if (result && result->at("version") == std::string(kMosbenchVersion)) {
    return {std::move(cell), CellState::kDone, *result};
  }
  if (const auto failure = record_in(failure_file(out, cell.key), cell.key, true)) {
    return {std::move(cell), CellState::kFailed, *failure};
  }
  if (result) return {std::move(cell), CellState::kOtherVersion, *result};
  return {std::move(cell), CellState::kMissing, nullptr};
}

}  // namespace

std::optional<Perturbation> StudyCell::perturb() const {
  if (axis == nullptr || axis->kind == nullptr) return std::nullopt;
  return parse_perturbation(fmt::format("{}={}{},seed={}", axis->name, value, axis->with, seed));
}

std::string StudyCell::label() const {
  return odometry.empty() ? method->name : fmt::format("{} ({})", method->name, odometry);
}

std::string StudyCell::sequence_label() const { return fmt::format("{} {}", data->name, sequence); }

std::string StudyCell::group_label() const { return fmt::format("{} {}", data->group, sequence); }

bool is_program(const StudyMethod& method) { return method.method.starts_with("exec:"); }

bool has_setting(const StudyMethod& method, const std::string& name) {
  return method_named(method.method).defaults.find(name) != nullptr;
}

std::vector<std::string> assignments_of(const StudyMethod& method, const StudyAxis& axis,
                                        std::size_t value) {
  std::vector<std::string> assignments = method.assignments;
  if (axis.kind != nullptr) return assignments;
  for (const StudyAssignment& one : axis.assignments[value]) {
    if (!has_setting(method, one.setting)) continue;
    assignments.push_back(fmt::format("{}={}", one.setting, one.value));
  }
  return assignments;
}

std::string StudyCell::title() const {
  std::string text = fmt::format("{}, {}", sequence_label(), method->name);
  if (!odometry.empty()) text += fmt::format(", poses by {}", odometry);
  if (axis != nullptr) text += fmt::format(", {}={}", axis->name, value);
  if (seed != 0) text += fmt::format(", seed {}", seed);
  return text;
}

StudyPlan plan_study(const Study& study, const fs::path& out,
                     const std::vector<std::string>& only) {
  StudyPlan plan{&study, out, {}, std::nullopt};
  std::vector<StudyCell> cells;
  CellLister lister(study, cells);
  for (const StudyData& data : study.data) {
    for (const KnownSequence& sequence : sequences_of(data)) {
      for (const StudyMethod& method : study.methods) {
        for (const std::string& odometry : study.odometries) {
          StudyCell cell;
          cell.data = &data;
          cell.kind = sequence.kind;
          cell.sequence = sequence.name;
          cell.method = &method;
          cell.odometry = odometry;
          lister.list(std::move(cell), sequence.identity);
        }
      }
    }
  }
  plan.rule = shared_rule(study, cells);
  for (StudyCell& cell : cells) {
    const bool wanted = only.empty() || std::ranges::find(only, cell.key) != only.end();
    if (wanted) plan.cells.push_back(look_up(std::move(cell), out));
  }
  return plan;
}

std::string_view to_string(CellState state) {
  static constexpr std::array<std::string_view, 4> kStates = {"missing", "failed", "other version",
                                                              "done"};
  return kStates[static_cast<std::size_t>(state)];
}

std::optional<double> number_in(const ordered_json& record, const std::string& part,
                                std::string_view what) {
  const auto found = record.find(part);
  if (found == record.end() || !found->is_object()) return std::nullopt;
  const auto value = found->find(std::string(what));
  if (value == found->end() || !value->is_number()) return std::nullopt;
  return value->get<double>();
}

fs::path record_file(const fs::path& out, const std::string& key) {
  return out / "cells" / (key + ".json");
}

fs::path failure_file(const fs::path& out, const std::string& key) {
  return out / "cells" / (key + ".failure.json");
}

fs::path simulated_folder(const fs::path& out, const StudyData& data) {
  return out / "data" / hash_of_text(simulation_json(*data.simulation).dump()).substr(0, 16);
}

}  // namespace mosbench
