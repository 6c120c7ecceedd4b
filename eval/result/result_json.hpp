#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "eval/result/result.hpp"

namespace mosbench {

/// "format" of the result.json files that this program writes. 1 (not written): `variant` beside
/// the config, no `method` in results of `mosbench run`, settings left out where they were the
/// default. 2: `config`, `code`, `machine`, `fingerprint` and `simulated` beside each other, the
/// places of this machine in `timing` and `source`.
inline constexpr int kResultFormat = 3;

/// What is wrong with a result's JSON: which member, and what it lacks or holds.
class MemberFault : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// All of a result but its scans, what depends on the clock, and places on this machine.
nlohmann::ordered_json header_json(const Result& result);
/// All of a result, members as docs/formats/files.md describes them.
nlohmann::ordered_json to_json(const Result& result);

/// Of the header, what decides labels and scores: two runs that give the same asked the same.
nlohmann::ordered_json identity_json(const Result& result);

nlohmann::ordered_json row_json(const ScanRow& row);
ScanRow row_from_json(const nlohmann::ordered_json& json, const std::filesystem::path& file);
nlohmann::ordered_json timing_json(const Result& result);
Timing timing_from_json(const nlohmann::ordered_json& json);

nlohmann::ordered_json to_json(const Machine& machine);
nlohmann::ordered_json to_json(const SimulatedOrigin& origin);
nlohmann::ordered_json to_json(const ScoredPredictions& predictions);

/// Returns what a result.json of kResultFormat says. Throws DataError, UsageError and nlohmann's
/// exceptions.
Result result_from_json(const nlohmann::ordered_json& content, const std::filesystem::path& file);

}  // namespace mosbench
