#include "eval/job/study_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "datasets/disk/files.hpp"
#include "datasets/perturb/perturbation.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/simulator/scene.hpp"
#include "datasets/simulator/simulate.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/job/study_drives.hpp"
#include "eval/protocols/protocol.hpp"
#include "eval/result/reading_json.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

ordered_json simulation_json(const Simulation& simulation) {
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

struct KnownSequence {
  DatasetKind kind;
  std::string name;
  ordered_json input = {};  ///< what its key says of it
  std::string drive = {};   ///< see StudyCell, as the rest
  std::string reading = {};
  std::set<std::uint64_t> scans = {};
};

/// What a cell has to say of a sequence on disk. One that cannot be opened says why.
ordered_json sequence_json(const Data& data, KnownSequence& known) {
  const std::string& name = known.name;
  try {
    Reading reading = data.reading;
    const bool refines = std::exchange(reading.refine_poses, false);  // which reads all scans
    const Dataset dataset = open_dataset(data.path, {data.kind, {name}, reading});
    if (reading.pose_file() != nullptr) reading.poses = OwnPoses{};
    reading.refine_poses = refines;
    const auto& simulated = dataset.sequences.front()->simulated();
    known.drive = drive_of(simulated);
    if (simulated) known.reading = simulated->perturb.value_or("") + told_json(reading).dump();
    return {{"dataset", to_string(dataset.kind)},
            {"content", content_of(*dataset.sequences.front())},
            {"reading", told_json(reading)}};
  } catch (const std::runtime_error& error) {  // DataError, or UsageError of what it lacks
    return {{"unreadable", error.what()}};
  }
}

/// Throws UsageError for a sequence that the simulation does not write.
std::vector<KnownSequence> simulated_sequences(const StudyData& data) {
  const Simulation& simulation = *data.data.simulation;
  const std::vector<std::string> written =
      simulated_names(simulation.layout, load_scene(simulation.scene));
  const std::vector<std::string>& wanted = data.data.sequences;
  ordered_json json = {{"simulated", simulation_json(simulation)},
                       {"reading", told_json(data.data.reading)}};
  const std::string drive =
      simulated_drive(fingerprint_of(load_scene(simulation.scene)), simulation.seed);
  std::vector<KnownSequence> sequences;
  for (const std::string& name : wanted.empty() ? written : wanted) {
    if (std::ranges::find(written, name) == written.end()) {
      throw UsageError(fmt::format("{}: simulates no sequence {}, expected {}", data.name,
                                   mosbench::quoted(name), fmt::join(written, ", ")));
    }
    sequences.push_back({simulation.layout, name, json, drive, json["reading"].dump()});
  }
  return sequences;
}

std::vector<KnownSequence> sequences_of(const StudyData& data) {
  if (data.data.simulation) return simulated_sequences(data);
  std::vector<KnownSequence> sequences;
  std::optional<DatasetKind> kind;
  const OpenOptions options{data.data.kind, data.data.sequences, data.data.reading};
  try {
    for (const SequenceFolder& folder : find_sequences(data.data.path, options, kind)) {
      KnownSequence& sequence = sequences.emplace_back(KnownSequence{*kind, folder.name});
      sequence.input = sequence_json(data.data, sequence);
    }
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{}: {}", data.name, error.what()));
  }
  return sequences;
}

/// Lists the cells of one method on one sequence after the other.
class CellLister {
 public:
  CellLister(const Study& study, const std::vector<ProgramFile>* known) : study_(study) {
    for (const StudyMethod& method : study.methods) {
      program_of_[&method] = hash_of_program(files_of_program(*method.segment.method, known));
    }
  }

  void list(const StudyData& data, const KnownSequence& sequence, const StudyMethod& method,
            const std::optional<OdometryChoice>& odometry) {
    StudyCell cell = {.data = &data,
                      .kind = sequence.kind,
                      .sequence = sequence.name,
                      .drive = sequence.drive,
                      .reading = sequence.reading,
                      .scans = sequence.scans,
                      .method = &method,
                      .program = program_of_.at(&method),
                      .odometry = odometry ? std::string(odometry->kind->name) : ""};
    cell.job = {
        .data = data.data, .odometry = odometry, .segment = method.segment, .rule = study_.rule};
    cell.job.data.sequences = {sequence.name};
    if (odometry) cell.job.data.reading.poses = ByOdometry{};
    const ordered_json input = {{"data", sequence.input}, {"sequence", sequence.name}};
    identify(cell, input);
    cell.cost_key = cost_key(identity_);
    add(cell);
    for (const StudyAxis& axis : study_.axes) list_axis(cell, axis, input);
  }

  std::vector<StudyCell> cells;

 private:
  void list_axis(StudyCell cell, const StudyAxis& axis, const ordered_json& input) {
    cell.axis = &axis;
    for (std::size_t i = 0; i < axis.values.size(); ++i) {
      cell.value = axis.values[i];
      cell.job.segment.changes = changes_of(cell.method->segment, axis, i);
      const bool lacks_settings =
          cell.job.segment.changes.size() == cell.method->segment.changes.size();
      if (axis.kind == nullptr && lacks_settings) continue;
      identify(cell, input);
      const bool random = axis.kind != nullptr && axis.kind->is_random;
      for (const std::uint64_t seed : random ? study_.seeds : std::vector<std::uint64_t>{0}) {
        cell.seed = seed;
        if (axis.kind != nullptr) {
          cell.job.data.reading.perturb = parse_perturbation(
              fmt::format("{}={}{},seed={}", axis.name, cell.value, axis.with, seed));
        }
        identity_["perturb"] = perturb_text(cell.job);
        add(cell);
      }
    }
  }

  void identify(const StudyCell& cell, const ordered_json& input) {
    identity_ = identity_of(cell.job, cell.kind, input, cell.program);
  }

  static std::string cost_key(ordered_json identity) {
    for (const char* free : {"protocol", "perturb", "program"}) identity.erase(free);
    return key_of(identity);
  }

  void add(StudyCell& cell) {
    cell.key = key_of(identity_);
    const auto [known, is_new] = known_.emplace(cell.key, cells.size());
    if (is_new || asks_otherwise(cells[known->second], cell)) cells.push_back(cell);
  }

  /// Returns whether two cells with one result are two places in tables: a value may be the usual
  /// one. Data or methods that are the same under two names would be one row too many.
  bool asks_otherwise(const StudyCell& first, const StudyCell& second) const {
    const bool same = first.data == second.data && first.sequence == second.sequence &&
                      first.method == second.method && first.odometry == second.odometry;
    if (same) return first.job.segment.changes != second.job.segment.changes;
    throw UsageError(
        fmt::format("{}: \"{}\" and \"{}\" are the same run, expected data and methods "
                    "that differ in more than the name",
                    study_.file.string(), first.title(), second.title()));
  }

  const Study& study_;
  std::map<const StudyMethod*, std::string> program_of_;
  std::map<std::string, std::size_t> known_;  ///< place in `cells` of each key
  ordered_json identity_;
};

/// The cells that one rule scores.
struct RuledCells {
  ScoreRule rule;
  std::vector<const StudyCell*> cells;
};

std::vector<RuledCells> by_rule(const std::vector<StudyCell>& cells) {
  std::vector<RuledCells> groups;
  for (const StudyCell& cell : cells) {
    try {
      const ScoreRule rule = rule_of(cell.job, cell.kind);
      auto group = std::ranges::find(groups, rule, &RuledCells::rule);
      if (group == groups.end()) group = groups.insert(group, {rule, {}});
      group->cells.push_back(&cell);
    } catch (const UsageError&) {  // its settings are refused when it is computed
    }
  }
  return groups;
}

/// "room-1", or where only some cells of the data have the rule, "room-1, near, max_range_m=9".
std::string subject(const StudyCell& cell, const std::vector<RuledCells>& groups) {
  const auto has_data = [&](const RuledCells& group) {
    return std::ranges::find(group.cells, cell.data, &StudyCell::data) != group.cells.end();
  };
  if (std::ranges::count_if(groups, has_data) == 1) return cell.data->name;
  std::string text = fmt::format("{}, {}", cell.data->name, cell.method->name);
  if (cell.axis != nullptr) text += fmt::format(", {}={}", cell.axis->name, cell.value);
  return text;
}

std::string subjects(const RuledCells& group, const std::vector<RuledCells>& groups) {
  constexpr std::size_t kNamed = 4;
  std::vector<std::string> names;
  for (const StudyCell* cell : group.cells) {
    const std::string name = mosbench::quoted(subject(*cell, groups));
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  const std::size_t more = names.size() - std::min(names.size(), kNamed);
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "),
                     more == 0 ? "" : fmt::format(" and {} more", more));
}

/// The keys that make the rules one.
std::string missing_keys(const Study& study, const std::vector<RuledCells>& groups) {
  const Protocol* first = groups.front().rule.protocol;
  const bool same_protocol = std::ranges::all_of(
      groups, [&](const RuledCells& group) { return group.rule.protocol == first; });
  if (!same_protocol) {
    return fmt::format("give the key \"protocol:\", as `protocol: {}`", first->name);
  }
  const std::string range = "give the key \"range_m:\", as `range_m: [0.5, 20]`";
  return study.rule.protocol != nullptr ? range
                                        : fmt::format("{}, and `protocol: {}`", range, first->name);
}

[[noreturn]] void refuse(const Study& study, const std::vector<RuledCells>& groups) {
  std::string rules;
  for (const RuledCells& group : groups) {
    rules += fmt::format("{}{} by {}", rules.empty() ? "" : "; ", subjects(group, groups),
                         rule_name(group.rule));
  }
  throw UsageError(fmt::format(
      "{}: averages what different rules count: {}, expected the same for all: {}, or make a "
      "study of each",
      study.file.string(), rules, missing_keys(study, groups)));
}

/// Refuses names of no sequence, and sequences that are judged on which settings are chosen.
void check_tuning(const Study& study, const std::vector<StudyCell>& cells) {
  std::vector<std::string> known;
  for (const StudyCell& cell : cells) {
    const std::string label = cell.sequence_label();
    if (std::ranges::find(known, label) == known.end()) known.push_back(label);
    if (!names_sequence(study.tuning->tune_on, cell)) continue;
    if (!names_sequence(study.tuning->judge_on, cell)) continue;
    throw UsageError(
        fmt::format("{}: best_of tunes and judges on sequence \"{}\", expected others in judge_on",
                    study.file.string(), label));
  }
  check_drives(study, cells);
  for (const auto& names : {study.tuning->tune_on, study.tuning->judge_on}) {
    for (const std::string& name : names) {
      const auto is_named = [&](const StudyCell& cell) { return names_sequence({name}, cell); };
      if (std::ranges::any_of(cells, is_named)) continue;
      throw UsageError(fmt::format(
          "{}: best_of names {}, which is no sequence of the study, expected some of {}",
          study.file.string(), mosbench::quoted(name), fmt::join(known, ", ")));
    }
  }
}

}  // namespace

std::string StudyCell::label() const {
  return odometry.empty() ? method->name : fmt::format("{} ({})", method->name, odometry);
}

std::string StudyCell::sequence_label() const { return fmt::format("{} {}", data->name, sequence); }

std::string StudyCell::group_label() const {
  if (drive.empty()) return fmt::format("{} {}", data->group, sequence);
  return fmt::format("{} {} {} {}", scene_of(drive), to_string(kind),
                     simulates_several(kind) ? sequence : "", reading);
}

std::string StudyCell::title() const {
  std::string text = fmt::format("{}, {}", sequence_label(), method->name);
  if (!odometry.empty()) text += fmt::format(", poses by {}", odometry);
  if (axis != nullptr) text += fmt::format(", {}={}", axis->name, value);
  if (seed != 0) text += fmt::format(", seed {}", seed);
  return text;
}

bool names_sequence(const std::vector<std::string>& names, const StudyCell& cell) {
  return std::ranges::any_of(names, [&](const std::string& name) {
    return name == cell.data->name || name == cell.data->group || name == cell.sequence ||
           name == cell.sequence_label() ||
           name == fmt::format("{} {}", cell.data->group, cell.sequence);
  });
}

std::vector<SettingChange> changes_of(const Segment& segment, const StudyAxis& axis,
                                      std::size_t value) {
  std::vector<SettingChange> changes = segment.changes;
  if (axis.kind != nullptr) return changes;
  for (const SettingChange& change : axis.changes[value]) {
    if (segment.method->defaults.find(change.name) != nullptr) changes.push_back(change);
  }
  return changes;
}

std::vector<StudyCell> cells_of(const Study& study, const std::vector<ProgramFile>* known) {
  CellLister lister(study, known);
  for (const StudyData& data : study.data) {
    for (KnownSequence& sequence : sequences_of(data)) {
      const bool is_read = !sequence.input.contains("unreadable");
      if (study.tuning && !data.data.simulation && is_read) {
        sequence.scans = scan_hashes(data.data, sequence.name);
      }
      for (const StudyMethod& method : study.methods) {
        for (const auto& odometry : study.odometries) {
          lister.list(data, sequence, method, odometry);
        }
      }
    }
  }
  if (study.tuning) check_tuning(study, lister.cells);
  return std::move(lister.cells);
}

std::string simulation_key(const Simulation& simulation) {
  return hash_of_text(simulation_json(simulation).dump()).substr(0, 16);
}

std::optional<ScoreRule> shared_rule(const Study& study, const std::vector<StudyCell>& cells) {
  const std::vector<RuledCells> groups = by_rule(cells);
  if (groups.empty()) return std::nullopt;
  if (groups.size() > 1) refuse(study, groups);
  return groups.front().rule;
}

}  // namespace mosbench
