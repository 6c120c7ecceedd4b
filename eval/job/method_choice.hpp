#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <mosbench/method.hpp>
#include <mosbench/odometry.hpp>
#include <mosbench/settings.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "datasets/sequence/reading.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/result/result.hpp"

namespace mosbench {

/// Published settings of methods for a data set, and how its numbers are computed there.
struct Preset : MethodPreset {
  std::optional<DatasetKind> kind;  ///< nothing: any, see `preset_for`
  std::string_view protocol;        ///< name of a row of the protocol table; empty without a kind
};

std::span<const Preset> presets();

/// Returns the row of a table with that name. Throws UsageError with the nearest one.
template <typename Row>
const Row& row_named(std::span<const Row> rows, std::string_view name, const char* flag) {
  std::vector<std::string_view> names;
  for (const Row& row : rows) {
    if (row.name == name) return row;
    names.push_back(row.name);
  }
  throw UsageError(fmt::format("{}: '{}' is not known, expected one of {} (nearest: {})", flag,
                               name, fmt::join(names, ", "), nearest_name(name, names)));
}

/// Throws UsageError naming the known presets.
const Preset& preset_named(std::string_view name);

/// Returns the method's defaults with the preset's values for the settings that the method has.
Settings settings_of(const Preset& preset, const MethodKind& method);

/// Returns the preset; one of any data set with the values and protocol of this kind's default.
Preset preset_for(const Preset& preset, DatasetKind kind);

/// What `mosbench run` takes when the user names none: the online preset of the data set.
const Preset& default_preset(DatasetKind kind);

/// Returns the method that --method names; of "exec:COMMAND" that of `exec_method`. Throws
/// UsageError naming the nearest one.
const MethodKind& method_named(const std::string& name);

/// Returns the method; of a program of the user one that also has the settings of "KEY=VALUE".
const MethodKind& taking(const MethodKind& method, const std::vector<std::string>& assignments);

/// Returns the method that is named, else that of the preset, else the paper's. Throws UsageError
/// where the preset is of another method than the one that is named.
const MethodKind& method_of(const std::optional<std::string>& method,
                            const std::optional<std::string>& preset);

/// Methods of a benchmark, and why others are not among them.
struct MethodChoice {
  std::vector<std::string> names;
  std::vector<std::string> notes;  ///< plain sentences
};

/// Whether --method is a list, or "all".
bool names_several_methods(const std::string& text);

/// Takes "A", "A,B,exec:COMMAND" or "all": every method but twins and those that this build lacks,
/// in the order of `methods()`. Throws UsageError for a name that is not known, empty or given
/// twice.
MethodChoice chosen_methods(const std::string& text);

/// What the user asked of odometry, as typed.
struct OdometryOptions {
  std::optional<std::string> kind = {}, preset = {};
  std::optional<std::filesystem::path> config_file = {};
  std::vector<std::string> assignments = {};
  bool drop_moving = false;
};

/// An online method whose moving points stay out of the map that scans are registered to.
struct MovingFilter {
  const MethodKind* method = nullptr;
  Settings settings;
};

struct OdometryChoice {
  const OdometryKind* kind = nullptr;
  Settings settings;
  std::optional<MovingFilter> filter = std::nullopt;
  Deskew deskew = Deskew::kPoses;  ///< of the scans once their poses are found
  bool says_deskew = false;        ///< whether the user did
  bool drop_moving = false;        ///< what the job's method finds moving is to be the filter
};

/// Settings are defaults < preset < file < deskewing of `reading` < assignments. The preset's kind
/// is taken when none is named. Throws UsageError.
OdometryChoice choose_odometry(const OdometryOptions& options, const Reading& reading);

/// The choice when a kind is named; `options.poses` is then refused. Throws UsageError.
std::optional<OdometryChoice> named_odometry(const OdometryOptions& odometry,
                                             const Reading& reading);

/// The method with these settings, but without a delay.
MovingFilter moving_filter(const MethodKind& method, Settings settings);

/// Which odometry with which settings, for results.
OdometryDone odometry_done(const OdometryChoice& choice);
/// The same for the statement on how a sequence was read.
PosesDone statement_of(const OdometryChoice& choice);

}  // namespace mosbench
