#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "datasets/sequence/reading_options.hpp"

namespace mosbench {

/// Adds what every command that reads sequences takes: DATA, --dataset, --sequences and the flags
/// of the group Reading. What they fill must outlive the parsing.
void add_dataset_flags(CLI::App& command, std::filesystem::path& input, std::string& dataset,
                       std::vector<std::string>& sequences, ReadingOptions& reading);

/// Adds the same without the flags about poses.
void add_scan_dataset_flags(CLI::App& command, std::filesystem::path& input, std::string& dataset,
                            std::vector<std::string>& sequences, ReadingOptions& reading);

/// Adds --dataset alone.
void add_dataset_kind_flag(CLI::App& command, std::string& dataset);

/// Adds --threads; 0 stands for all.
void add_threads_flag(CLI::App& command, unsigned& threads);

}  // namespace mosbench
