#include "eval/protocols/protocol_list.hpp"

#include <fmt/format.h>

#include <cstdint>

namespace mosbench {
namespace {

std::string_view words(TruthClass truth) {
  switch (truth) {
    case TruthClass::kIgnored:
      return "ignored";
    case TruthClass::kStatic:
      return "static";
    case TruthClass::kMoving:
      return "moving";
    case TruthClass::kAlwaysNegative:
      return "always a true negative";
  }
  return "";
}

std::string_view words(Aggregation aggregation) {
  switch (aggregation) {
    case Aggregation::kPooled:
      return "pooled";
    case Aggregation::kMeanOfScans:
      return "mean of scans";
    case Aggregation::kMeanOfSequences:
      return "pooled per sequence, mean of sequences";
  }
  return "";
}

std::string_view words(EmptyCase empty_case) {
  switch (empty_case) {
    case EmptyCase::kNan:
      return "NaN";
    case EmptyCase::kNanWithoutTruth:
      return "NaN without moving truth";
    case EmptyCase::kOne:
      return "1";
    case EmptyCase::kEpsilon:
      return "0";
  }
  return "";
}

std::string words(const IdRange& range) {
  return range.first == range.last ? fmt::format("{}", range.first)
                                   : fmt::format("{}-{}", range.first, range.last);
}

/// "0-1 9 20": the ids of one class.
std::string ids_of(const IdMap& map, TruthClass wanted) {
  std::string text;
  for (const IdRange& range : map.ranges) {
    if (range.becomes != wanted) continue;
    if (!text.empty()) text += ' ';
    text += words(range);
  }
  return text;
}

bool knows_every_id(const IdMap& map) {
  const LabelTable table(map);
  for (std::uint32_t id = 0; id <= 0xFFFF; ++id) {
    if (!table.is_known(id)) return false;
  }
  return true;
}

std::string describe_truth(const IdMap& map) {
  std::string text;
  for (const TruthClass wanted : {TruthClass::kIgnored, TruthClass::kStatic, TruthClass::kMoving,
                                  TruthClass::kAlwaysNegative}) {
    const std::string listed = ids_of(map, wanted);
    if (!listed.empty()) text += fmt::format("{} {}, ", listed, words(wanted));
  }
  if (!knows_every_id(map)) return text + fmt::format("others {}", words(map.unknown));
  return text.substr(0, text.size() - 2);
}

std::string describe_range(const Protocol& protocol) {
  if (protocol.range_rule == RangeRule::kNone) return "none";
  const std::string_view what =
      protocol.range_rule == RangeRule::kTruthOnly ? "truth only" : "truth and prediction";
  const RangeGate& limits = protocol.default_range;
  if (limits.max_m <= 0.0 && limits.min_m > 0.0) {
    return fmt::format("{}, from {:g} m by default", what, limits.min_m);
  }
  if (limits.max_m <= 0.0) return fmt::format("{}, no limit by default", what);
  return fmt::format("{}, {:g} to {:g} m by default", what, limits.min_m, limits.max_m);
}

}  // namespace

std::vector<ProtocolDescription> describe_protocols() {
  std::vector<ProtocolDescription> rows;
  for (const Protocol& protocol : protocols()) {
    rows.push_back({.name = std::string(protocol.name),
                    .truth = describe_truth(protocol.truth),
                    .prediction = ids_of(protocol.prediction, TruthClass::kMoving),
                    .range = describe_range(protocol),
                    .aggregation = std::string(words(protocol.aggregation)),
                    .split = protocol.default_split.empty() ? "all labelled scans"
                                                            : std::string(protocol.default_split),
                    .empty_case = std::string(words(protocol.empty_case)),
                    .summary = std::string(protocol.summary),
                    .source = std::string(protocol.source)});
  }
  return rows;
}

std::string counted_range_text(const Protocol& protocol, const RangeGate& range) {
  if (protocol.range_rule == RangeRule::kNone) return "";
  return range.max_m > 0 ? fmt::format("{:g} to {:g} m", range.min_m, range.max_m)
                         : fmt::format("from {:g} m", range.min_m);
}

namespace {

std::string in_brackets(const ScoreRule& rule) {
  const std::string range = counted_range_text(*rule.protocol, rule.range);
  return range.empty() ? "" : fmt::format(" ({})", range);
}

}  // namespace

std::string rule_line(const ScoreRule& rule) {
  return fmt::format("protocol {}: {}{}", rule.protocol->name, rule.protocol->summary,
                     in_brackets(rule));
}

std::string rule_name(const ScoreRule& rule) {
  return fmt::format("{}{}", rule.protocol->name, in_brackets(rule));
}

}  // namespace mosbench
