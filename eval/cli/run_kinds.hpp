#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "eval/answer/answer.hpp"
#include "eval/engine/run_plan.hpp"
#include "eval/job/job.hpp"
#include "eval/result/result.hpp"

// What `mosbench run` is given: data, a file that names methods and data, or a published table.

namespace mosbench {

/// Runs one method or those of a list, and writes products of each (see `write_products`). Throws
/// UsageError and DataError.
Answer run_data(const JobWords& words, const RunPlace& place,
                std::span<const std::string> products);

/// Returns the points of a sequence, and those that the method labelled moving.
std::pair<std::uint64_t, std::uint64_t> moving_points(const Result& result);

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

/// Returns whether DATA names such a file.
bool is_job(const std::filesystem::path& input);
/// Computes the cells that are missing, or with `dry_run` counts them.
Answer run_job(const JobFlags& flags);
/// Returns the table of what is computed.
Answer rank_job(const JobFlags& flags);

}  // namespace mosbench
