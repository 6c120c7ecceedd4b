#pragma once

#include <string>
#include <vector>

#include "eval/job/study_file.hpp"
#include "eval/job/yaml_node.hpp"

namespace mosbench {

/// Reads the values of a study that are changed: the keys disturb, vary, grid and sample. Throws
/// UsageError with file and line for values that no method of the study takes.
std::vector<StudyAxis> axes_of(const YamlNode& root, const std::vector<StudyMethod>& methods);

/// Reads the value of a setting of a method. Throws likewise.
SettingChange change_by(const std::string& setting, const YamlNode& value,
                        const MethodKind& method);

}  // namespace mosbench
