#include "eval/study/tuning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/job/study_drives.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

/// "DIR/hmm-mos (kiss).preset.json" without blanks and brackets.
fs::path preset_file(const fs::path& out, std::string label) {
  std::erase_if(label, [](char c) { return c == '(' || c == ')'; });
  std::ranges::replace_if(
      label, [](char c) { return c == ' ' || c == '/' || c == ':'; }, '-');
  return out / (label + ".preset.json");
}

/// Labels may differ in what a file's name cannot hold.
void name_apart(std::vector<StudyChoice>& choices) {
  std::map<fs::path, int> known;
  for (StudyChoice& choice : choices) {
    if (!choice.preset) continue;
    fs::path& file = choice.preset->file;
    const int same = ++known[file];
    if (same > 1) file.replace_filename(fmt::format("{}-{}", same, file.filename().string()));
  }
}

/// Chooses the settings of one row.
class Chooser {
 public:
  Chooser(const StudyPlan& plan, const DoneCells& cells, const StudyAxis& grid,
          const std::string& label)
      : plan_(plan), cells_(cells), grid_(grid), tuning_(*plan.study->tuning) {
    choice_.label = label;
  }

  StudyChoice run() {
    std::optional<std::size_t> best;
    std::optional<double> best_value;
    std::size_t missing = 0;
    std::set<std::vector<SettingChange>> known;
    for (std::size_t i = 0; i < grid_.values.size(); ++i) {
      const WantedCell wanted = is_at_value(choice_.label, grid_, i);
      const Part part = part_of(wanted, tuning_.tune_on);
      // A method that lacks a setting has the same run at several combinations.
      if (part.cells == 0 || !known.insert(part.changes).second) continue;
      ++choice_.candidates;
      missing += part.missing;
      const auto value = part.missing > 0 ? std::nullopt : value_of(part);
      if (part.missing == 0 && !value) ++choice_.passed_over;
      if (!value || (best_value && *value <= *best_value)) continue;
      best = i;
      best_value = value;
    }
    choice_.base = numbers_of(is_plain_of(choice_.label));
    if (missing > 0) {
      choice_.why_none =
          counted(missing, "cell of tune_on is missing", "cells of tune_on are missing");
    } else if (!best) {
      choice_.why_none = "no settings of the grid have the metric on tune_on";
    } else {
      choice_.chosen = numbers_of(is_at_value(choice_.label, grid_, *best));
      choice_.preset = preset_of_value(*best);
    }
    return std::move(choice_);
  }

 private:
  struct Part {
    std::size_t cells = 0, missing = 0;
    bool failed = false;
    std::vector<SettingChange> changes = {};
    StudyMetrics metrics = {};
  };

  /// What is known of wanted cells on some of the sequences.
  Part part_of(const WantedCell& wanted, const std::vector<std::string>& names) const {
    Part part;
    const auto is_part = [&](const StudyCell& cell) {
      return names_sequence(names, cell) && wanted(cell);
    };
    for (const PlannedCell& planned : plan_.cells) {
      if (!is_part(planned.cell)) continue;
      ++part.cells;
      part.changes = planned.cell.job.segment.changes;
      part.failed = part.failed || planned.state == CellState::kFailed;
      part.missing += planned.state != CellState::kFailed && planned.state != CellState::kDone;
    }
    if (part.missing == 0 && !part.failed && part.cells > 0) part.metrics = cells_.metrics(is_part);
    return part;
  }

  std::optional<double> value_of(const Part& part) const {
    for (std::size_t i = 0; i < kBriefMetrics.size(); ++i) {
      if (kBriefMetrics[i] == tuning_.metric) return part.metrics[i].value;
    }
    return std::nullopt;
  }

  TunedAndJudged numbers_of(const WantedCell& wanted) const {
    const auto whole = [&](const std::vector<std::string>& names) {
      const Part part = part_of(wanted, names);
      const bool is_whole = part.cells > 0 && part.missing == 0 && !part.failed;
      return is_whole ? std::optional(part.metrics) : std::nullopt;
    };
    return {whole(tuning_.tune_on), whole(tuning_.judge_on)};
  }

  TunedPreset preset_of_value(std::size_t value) const {
    TunedPreset preset;
    preset.file = preset_file(plan_.out, choice_.label);
    preset.metric = row_of(tuning_.metric).key;
    preset.study = plan_.study->name;
    std::set<std::string_view> bases;
    const WantedCell wanted = is_at_value(choice_.label, grid_, value);
    for (const DoneCell& each : cells_.done) {
      const StudyCell& cell = each.cell;
      if (!wanted(cell) || !names_sequence(tuning_.tune_on, cell)) continue;
      preset.method = cell.job.segment.method;
      preset.settings = cell.job.segment.changes;
      bases.insert(mosbench::preset_of(cell.job, cell.kind).name);
      preset.tuned_on.push_back({cell.sequence_label(), std::string(to_string(cell.kind)),
                                 cell.sequence, each.numbers.simulation, each.numbers.fingerprint,
                                 cell.scans});
    }
    if (bases.size() == 1) preset.base = &preset_named(*bases.begin());
    return preset;
  }

  const StudyPlan& plan_;
  const DoneCells& cells_;
  const StudyAxis& grid_;
  const StudyTuning& tuning_;
  StudyChoice choice_;
};

/// A study replaces what it tuned before, and nothing else.
void refuse_foreign(const fs::path& file) {
  try {
    if (parse_json(read_file(file), file).contains("tuned_on")) return;
  } catch (const DataError&) {  // refused below
  }
  throw UsageError(file.string() +
                   ": is there and no preset of a study, expected no file of this name");
}

}  // namespace

std::vector<StudyChoice> choices_of(const StudyPlan& plan, const DoneCells& cells) {
  const StudyAxis& grid = *std::ranges::find_if(plan.study->axes, &StudyAxis::is_grid);
  std::vector<StudyChoice> choices;
  for (const std::string& label : cells.labels) {
    StudyChoice choice = Chooser(plan, cells, grid, label).run();
    if (choice.candidates > 0) choices.push_back(std::move(choice));
  }
  name_apart(choices);
  return choices;
}

std::string doubt_about_judging(const StudyPlan& plan) {
  if (!plan.study->tuning) return "";
  const auto& [metric, tune_on, judge_on] = *plan.study->tuning;
  for (const PlannedCell& one : plan.cells) {
    if (!names_sequence(tune_on, one.cell)) continue;
    for (const PlannedCell& other : plan.cells) {
      const bool is_judged = names_sequence(judge_on, other.cell);
      if (!is_judged || !are_seeds_of_one_scene(one.cell, other.cell)) continue;
      return fmt::format("best_of judges on \"{}\", another seed of the scene of \"{}\"",
                         other.cell.sequence_label(), one.cell.sequence_label());
    }
  }
  return "";
}

void check_presets(const StudyPlan& plan) {
  if (!plan.study->tuning) return;
  for (const std::string& label : DoneCells(plan).labels) {
    const fs::path file = preset_file(plan.out, label);
    if (is_there(file)) refuse_foreign(file);
  }
}

void write_presets(const std::vector<StudyChoice>& choices) {
  for (const StudyChoice& choice : choices) {
    if (!choice.preset) continue;
    const std::string text = json_text(to_json(*choice.preset));
    const fs::path& file = choice.preset->file;
    if (is_there(file)) {
      if (read_file(file) == text) continue;
      refuse_foreign(file);
    }
    write_file_atomic(file, text);
  }
}

}  // namespace mosbench
