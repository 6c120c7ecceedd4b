#pragma once

#include <nlohmann/json.hpp>

namespace mosbench {

/// Processor, logical cores, memory and operating system, as far as they can be read.
nlohmann::ordered_json machine_json();

/// Memory this process holds at the moment, MiB; 0 where it cannot be read.
double resident_mib();

}  // namespace mosbench
