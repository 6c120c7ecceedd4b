#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "datasets/perturb/perturb_kinds.hpp"
#include "datasets/sequence/reading.hpp"
#include "eval/protocols/protocol.hpp"

namespace mosbench {

/// Data of a study that are simulated when they are needed.
struct StudySimulation {
  DatasetKind layout = DatasetKind::kSemanticKitti;
  std::string scene;  ///< a name, or the path of a file
  std::size_t scans = 0;
  std::uint64_t seed = 1;
};

/// Data on disk, or a simulation of them.
struct StudyData {
  std::string name;
  std::string group;  ///< the name without the seed of a simulation
  std::optional<StudySimulation> simulation;
  std::filesystem::path path;  ///< of data on disk
  std::string dataset = "auto";
  std::vector<std::string> sequences;  ///< all when empty
  Reading reading;
};

struct StudyMethod {
  std::string name;  ///< in tables
  std::string method;
  std::optional<std::string> preset;
  std::vector<std::string> assignments;  ///< as of --set
};

/// What a study sets: a setting and its value, as of --set.
struct StudyAssignment {
  std::string setting, value;
};

/// One kind of disturbance, or settings, at several values; all else stays as it is.
struct StudyAxis {
  const PerturbKind* kind = nullptr;  ///< null for settings
  std::string name;                   ///< of the kind or the setting; "sample" of several settings
  std::vector<std::string> values;
  std::string with;  ///< shared keys of --perturb, each with a comma in front
  std::vector<std::vector<StudyAssignment>> assignments;  ///< by value; none of a disturbance
  std::vector<std::string>
      sampled;  ///< the settings that are drawn all at once, see `sampled_axis`
};

/// What study.yaml says.
struct Study {
  std::filesystem::path file;
  std::string name;
  std::optional<std::string> protocol, range;
  std::vector<StudyData> data;
  std::vector<StudyMethod> methods;
  std::vector<std::string> odometries = {""};  ///< empty: the poses of the data
  std::vector<StudyAxis> axes;
  std::vector<std::uint64_t> seeds = {1};
};

/// Reads a study. Paths are from the file's folder. Throws UsageError with file and line for
/// unknown, missing or double keys, values of another kind, and methods, settings, protocols and
/// disturbances that are not known.
Study read_study(const std::filesystem::path& file);
Study parse_study(const std::string& text, const std::filesystem::path& file);

}  // namespace mosbench
