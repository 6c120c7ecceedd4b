#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "eval/protocols/protocol.hpp"
#include "eval/study/study_file.hpp"

namespace mosbench {

/// One run of a study: a method on a sequence, with at most one thing changed.
struct StudyCell {
  const StudyData* data = nullptr;
  DatasetKind kind = DatasetKind::kRecording;  ///< of the data
  std::string sequence;
  const StudyMethod* method = nullptr;
  std::string odometry;                  ///< empty: the poses of the data
  const StudyAxis* axis = nullptr;       ///< null where nothing is changed
  std::string value;                     ///< of the axis
  std::vector<std::string> assignments;  ///< as of --set: of the method, then of the axis
  std::uint64_t seed = 0;                ///< 0 where nothing is random
  nlohmann::ordered_json identity;       ///< all that decides the result but the program
  std::string key;                       ///< hash of it, 32 hexadecimal digits
  std::string cost_key;  ///< hash of what decides the cost of the method on the sequence

  /// Returns how scans are disturbed; nothing where they stay as they are.
  std::optional<Perturbation> perturb() const;
  /// Returns "hmm-mos", or "hmm-mos (kiss)" with poses by odometry: its row in tables.
  std::string label() const;
  /// Returns "street-1 08".
  std::string sequence_label() const;
  /// Returns "street 08": seeds of one scene are no more than one sequence to a mean.
  std::string group_label() const;
  /// Returns "street 08, hmm-mos, pose_noise_m=0.05, seed 2".
  std::string title() const;
};

/// Whether a method is a program of the user's, which runs in a process of its own.
bool is_program(const StudyMethod& method);

/// Whether a method has a setting of this name.
bool has_setting(const StudyMethod& method, const std::string& name);

/// Returns what a cell sets, as of --set: what the study says of the method, then those settings of
/// one value of the axis that the method has.
std::vector<std::string> assignments_of(const StudyMethod& method, const StudyAxis& axis,
                                        std::size_t value);

/// What lies where a cell's result belongs.
enum class CellState : std::uint8_t {
  kMissing,
  kFailed,        ///< and what it said lies there
  kOtherVersion,  ///< a result of another version of mosbench
  kDone
};

/// Returns "missing", "failed", "other version" or "done".
std::string_view to_string(CellState state);

struct PlannedCell {
  StudyCell cell;
  CellState state = CellState::kMissing;
  nlohmann::ordered_json record;  ///< what lies there, null where nothing does
};

/// All cells of a study, each once, in the order of its file.
struct StudyPlan {
  const Study* study = nullptr;
  std::filesystem::path out;
  std::vector<PlannedCell> cells;
  /// By which every cell is scored; nothing where the settings of all are refused.
  std::optional<ScoreRule> rule;
};

/// Lists the cells and what is known of them. Data on disk are opened, simulated ones are not made.
/// With `only` given, of these keys alone. Throws UsageError, also where cells would be scored by
/// different rules, and DataError; a sequence that cannot be opened is a cell that will fail.
StudyPlan plan_study(const Study& study, const std::filesystem::path& out,
                     const std::vector<std::string>& only = {});

/// Returns the number `what` in the member `part` of a record; nothing where there is none.
std::optional<double> number_in(const nlohmann::ordered_json& record, const std::string& part,
                                std::string_view what);

std::filesystem::path record_file(const std::filesystem::path& out, const std::string& key);
std::filesystem::path failure_file(const std::filesystem::path& out, const std::string& key);

/// Returns the folder of simulated data below that of the study.
std::filesystem::path simulated_folder(const std::filesystem::path& out, const StudyData& data);

/// Returns where data lie, and makes simulated ones first where they are missing, in one step for
/// all who look, also on other hosts. Throws as `simulate` does.
std::filesystem::path made_data(const std::filesystem::path& out, const StudyData& data);

/// Puts bytes in place by a name of its own and one rename, without locks, which file systems that
/// hosts share may lack.
void write_shared(const std::filesystem::path& file, const std::string& bytes);

/// Removes what processes of this host that have ended left half-written in a study's folder.
void remove_abandoned(const std::filesystem::path& out);

}  // namespace mosbench
