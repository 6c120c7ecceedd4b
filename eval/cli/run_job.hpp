#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "eval/answer/answer.hpp"

namespace mosbench {

/// What to do with a file that names methods, data and disturbances to combine.
struct JobFlags {
  std::filesystem::path file;
  std::optional<std::filesystem::path> out;  ///< nothing: results/runs/<name of the file>
  std::filesystem::path output = "-";        ///< of the table
  std::vector<std::string> keys;             ///< of the only cells to compute, on this machine
  std::optional<std::string> profile;        ///< of Snakemake; nothing: this process
  unsigned threads = 0;                      ///< of each cell; 0: not said
  bool dry_run = false, yes = false;
};

/// Returns whether DATA of `mosbench run` names such a file.
bool is_job(const std::filesystem::path& input);

/// Computes the cells that are missing, or with `dry_run` counts them.
Answer run_job(const JobFlags& flags);

/// Returns the table of what is computed.
Answer rank_job(const JobFlags& flags);

}  // namespace mosbench
