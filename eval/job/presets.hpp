#pragma once

#include <mosbench/method.hpp>
#include <mosbench/settings.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "datasets/layouts/dataset.hpp"

namespace mosbench {

/// Published settings of methods for a data set, and how its numbers are computed there.
struct Preset : MethodPreset {
  std::optional<DatasetKind> kind;  ///< nothing: any, see `preset_for`
  std::string_view protocol;        ///< name of a row of the protocol table; empty without a kind
};

std::span<const Preset> presets();

/// Throws UsageError naming the known presets.
const Preset& preset_named(std::string_view name);

/// Returns the method's defaults with the preset's values for the settings that the method has.
Settings settings_of(const Preset& preset, const MethodKind& method);

/// Returns the preset; one of any data set with the values and protocol of this kind's default.
Preset preset_for(const Preset& preset, DatasetKind kind);

/// What `mosbench run` takes when the user names none: the online preset of the data set.
const Preset& default_preset(DatasetKind kind);

}  // namespace mosbench
