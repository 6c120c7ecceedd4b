#pragma once

#include <span>
#include <string_view>

#include "core/hmm_mos/config.hpp"
#include "datasets/layouts/dataset.hpp"

namespace mosbench {

/// Published settings of the method for a data set, and how its numbers are computed there.
struct Preset {
  std::string_view name;
  DatasetKind kind;
  Config config;
  std::string_view protocol;  ///< name of a row of the protocol table
  std::string_view source;    ///< where the settings come from
};

std::span<const Preset> presets();

/// Throws UsageError naming the known presets.
const Preset& preset_named(std::string_view name);

/// What `mosbench run` takes when the user names none: the online preset of the data set.
const Preset& default_preset(DatasetKind kind);

}  // namespace mosbench
