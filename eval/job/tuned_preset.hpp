#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/method.hpp>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "eval/job/job.hpp"

namespace mosbench {

/// A sequence on which settings were chosen.
struct TunedSequence {
  std::string label;  ///< "street-1 08": its data in the study, and its name
  std::string dataset, sequence;
  std::string simulation;              ///< see `drive_of`; empty for recorded data
  std::string fingerprint;             ///< of its scans, without poses
  std::set<std::uint64_t> scans = {};  ///< see `scan_hashes`; empty of what an older mosbench wrote
};

/// Settings that a study chose: what its preset file holds.
struct TunedPreset {
  std::filesystem::path file;
  const MethodKind* method = nullptr;
  const Preset* base = nullptr;         ///< null: the usual one of each data set
  std::vector<SettingChange> settings;  ///< over those of the base
  std::string metric, study;
  std::vector<TunedSequence> tuned_on;

  /// Returns "preset semantickitti with max_range_m=30, tuned on a 08, b 08 by iou (study mine)".
  std::string words() const;
  /// Returns "best.json: " and the words.
  std::string title() const;
};

nlohmann::ordered_json to_json(const TunedPreset& preset);
/// Throws UsageError naming the file for what is no such file, and for methods, presets and
/// settings that this mosbench does not have.
TunedPreset read_tuned_preset(const std::filesystem::path& file);

/// Returns whether --preset names such a file.
bool is_preset_file(const std::string& preset);

/// Returns the doubt about a result with these settings on a sequence that they were chosen on, or
/// on another seed of its scene. `scans` are those of the sequence as of `scan_hashes`; a name
/// tells only where they are not known of both. Empty for other sequences.
std::string tuning_doubt(const TunedPreset& preset, const Result& result,
                         const std::set<std::uint64_t>& scans);

}  // namespace mosbench
