#pragma once

#include <string_view>

namespace mosbench {

// Embedded by CMakeLists.txt: the files of scripts/cluster.
std::string_view snakefile_asset();
std::string_view local_profile_asset();
std::string_view slurm_profile_asset();
std::string_view slurm_status_asset();

}  // namespace mosbench
