#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "datasets/sequence/reading.hpp"
#include "eval/answer/answer.hpp"
#include "eval/breakdown/breakdown.hpp"

namespace mosbench {

/// Whose labels `mosbench stats --by range,height,object` breaks down, and how.
struct BreakdownFlags {
  std::filesystem::path input;  ///< results, or data with `predictions`
  std::optional<std::filesystem::path> predictions;
  std::string dataset = "auto";
  std::vector<std::string> sequences;
  std::optional<std::string> protocol, range, format;
  Reading reading;
  BreakdownParts parts;
  std::size_t top = 10;
  unsigned threads = hardware_threads();
};

/// Returns the breakdown. Throws UsageError for flags of `command` that results
/// tell already.
Answer breakdown_of(const BreakdownFlags& options, const CLI::App& command);

}  // namespace mosbench
