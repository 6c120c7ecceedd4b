#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "eval/answer/answer.hpp"

namespace mosbench {

/// A table of the paper, "I" or "doals", and the data to fill it from.
struct TableRun {
  std::string name;
  std::filesystem::path root;
  std::optional<std::filesystem::path> out;
  std::vector<std::string> sequences;  ///< empty: all
  unsigned threads = 1;
};

/// Runs all that the table needs, keeps what is finished, and returns the table.
Answer run_table(const TableRun& options);

}  // namespace mosbench
