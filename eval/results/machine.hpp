#pragma once

#include <nlohmann/json.hpp>

namespace mosbench {

/// Processor, logical cores, memory and operating system, as far as they can be read.
nlohmann::ordered_json machine_json();

/// Tells the C library to keep memory that is freed for the next scan, which needs as much again,
/// instead of having the system take its pages back and clear new ones. Where something small is
/// kept of every scan, make room for it first: between large buffers it would hole the heap, and
/// the process would grow.
void keep_freed_memory();

/// Memory this process holds at the moment, MiB; 0 where it cannot be read.
double resident_mib();

}  // namespace mosbench
