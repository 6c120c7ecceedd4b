#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/perturb/perturbation.hpp"
#include "eval/job/job.hpp"
#include "eval/protocols/metrics.hpp"

namespace mosbench {

/// Data under a name; each seed of a simulation is a row of its own.
struct StudyData {
  std::string name;
  std::string group;  ///< the name without the seed of a simulation
  Data data;
};

struct StudyMethod {
  std::string name;  ///< in tables
  Segment segment;
};

/// One kind of disturbance, or settings, at several values; all else stays as it is. The values of
/// a grid are in its order: those of the last setting change first.
struct StudyAxis {
  const PerturbKind* kind = nullptr;  ///< null for settings
  std::string name;                   ///< of the kind or the setting; "sample" of several settings
  std::vector<std::string> values;    ///< as tables show them
  std::string with;                   ///< shared keys of --perturb, each with a comma in front
  std::vector<std::vector<SettingChange>> changes;  ///< by value; none of a disturbance
  std::vector<std::string> sampled;                 ///< the settings that are drawn all at once
  bool is_grid = false;                             ///< values are combinations of settings
};

/// Of the grid, the settings with the best metric on some sequences are judged on others.
struct StudyTuning {
  Metric metric = Metric::kIou;
  /// Names of data, of sequences, or of both with a blank between.
  std::vector<std::string> tune_on, judge_on;
};

/// What study.yaml says: jobs that differ in data, method, poses, or in one value of one axis.
struct Study {
  std::filesystem::path file;
  std::string name;
  RuleChoice rule;
  std::vector<StudyData> data;
  std::vector<StudyMethod> methods;
  std::vector<std::optional<OdometryChoice>> odometries = {std::nullopt};  ///< nothing: the data's
  std::vector<StudyAxis> axes;
  std::optional<StudyTuning> tuning = std::nullopt;
  std::vector<std::uint64_t> seeds = {1};
};

/// Reads a study. Paths are from the file's folder. Throws UsageError with file and line for
/// unknown, missing or double keys, values of another kind, and methods, settings, protocols and
/// disturbances that are not known.
Study read_study(const std::filesystem::path& file);
Study parse_study(const std::string& text, const std::filesystem::path& file);

}  // namespace mosbench
