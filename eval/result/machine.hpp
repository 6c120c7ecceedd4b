#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

namespace mosbench {

/// Processor, logical cores, memory and operating system, as far as they can be read.
struct Machine {
  std::string processor = "unknown";
  unsigned logical_cores = 0;
  double memory_mib = 0.0;
  std::string system;
  bool operator==(const Machine&) const = default;
};
Machine this_machine();

/// Returns the CPU milliseconds that a fixed piece of work takes here, the least of some rounds,
/// which this process measures once: CPU times of two machines compare by the ratio of theirs.
double calibration_ms();

/// Version of mosbench and the compiler that built it.
nlohmann::ordered_json code_json();

/// Makes the C library keep freed memory for the next scan, which needs as much again; otherwise
/// the system takes its pages back and clears new ones. Whoever keeps something small of every scan
/// reserves the memory for it first: between large buffers it would split the heap, and the process
/// would grow.
void keep_freed_memory();

/// Gives memory that was kept back to the system, so that what is held next shows what needs it.
void give_back_memory();

/// Memory of this machine.
std::size_t memory_bytes();

/// Memory this process holds at the moment, MiB; 0 where it cannot be read.
double resident_mib();

}  // namespace mosbench
