#pragma once

#include <CLI/App.hpp>

#include "datasets/sequence/reading_options.hpp"

namespace mosbench {

/// Adds the flags about scans alone; they fill `options`, which has to outlive the parsing.
void add_scan_flags(CLI::App& command, ReadingOptions& options);

/// The flags about how a sequence is to be read, the same for every command that reads one. They
/// fill `options`, which has to outlive the parsing.
void add_reading_flags(CLI::App& command, ReadingOptions& options);

}  // namespace mosbench
