#pragma once

#include <string>
#include <vector>

#include "eval/protocols/protocol.hpp"

namespace mosbench {

/// A protocol in words, one member per line of `mosbench list protocols`.
struct ProtocolDescription {
  std::string name;
  std::string truth;        ///< "0-1 ignored, 9 static, 251-259 moving, others ignored"
  std::string prediction;   ///< ids that count as a moving prediction
  std::string range;        ///< "truth and prediction, 0.5 to 20 m"
  std::string aggregation;  ///< "mean of scans"
  std::string split;        ///< scans its published numbers are over: "test", "all labelled scans"
  std::string empty_case;   ///< what its own program gives for 0/0
  std::string summary;
  std::string source;
};

/// All protocols, in the order of `protocols()`.
std::vector<ProtocolDescription> describe_protocols();

/// Returns "0.5 to 20 m" or "from 0.5 m" of the points that count; empty when the protocol does not
/// limit the range.
std::string counted_range_text(const Protocol& protocol, const RangeGate& range);

/// Returns "protocol mapmos: pooled; ... (from 3 m)", the range that is really applied.
std::string rule_line(const ScoreRule& rule);
/// Returns "mapmos (from 3 m)".
std::string rule_name(const ScoreRule& rule);

}  // namespace mosbench
