#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "eval/job/job.hpp"

namespace mosbench {

/// Which data the user named, as typed.
struct DataWords {
  std::filesystem::path input = {};
  std::string dataset = "auto";
  std::vector<std::string> sequences = {};
  Reading reading = {};
};

/// What the user asked of `mosbench run`, as typed.
struct JobWords : DataWords {
  std::optional<std::string> method, preset, protocol, range;
  std::string moving = "now";  ///< or "ever" or "ever:SECONDS"
  std::optional<std::filesystem::path> config_file;
  OdometryOptions odometry;  ///< poses are found by it when a kind is named
  std::vector<std::string> assignments;
};

/// Parse them. Throw UsageError.
Data data_of(const DataWords& words);
Job job_of(const JobWords& words);

/// Opens the data. Throws UsageError and DataError.
Dataset open_dataset(const DataWords& words);

/// Returns what "KEY=VALUE" of --set says to a method. Throws UsageError.
SettingChange change_of(const std::string& assignment, const MethodKind& method);

/// "auto" is nothing. Throws UsageError for a name that is no data set kind.
std::optional<DatasetKind> dataset_kind_option(const std::string& name);

/// "MIN,MAX" in metres, MAX -1 for no limit. Throws UsageError.
RangeGate parsed_range(const std::string& text);
/// The same, and throws for a limit that the protocol does not know.
RangeGate range_option(const std::string& text, const Protocol& protocol);

}  // namespace mosbench
