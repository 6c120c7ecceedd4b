#pragma once

#include <string>

#include "datasets/doctor/doctor.hpp"

namespace mosbench {

/// Per sequence what was seen, then what is wrong, the verdict and the command to run next on
/// `input`, words of a shell.
std::string checkup_text(const Checkup& checkup, const std::string& input);

std::string checkup_json(const Checkup& checkup);

}  // namespace mosbench
