#include "eval/protocols/benchmark_split.hpp"

#include <algorithm>

namespace mosbench {

bool picks_scans(const Split& split) {
  return std::ranges::any_of(split.parts,
                             [](const SplitPart& part) { return part.stems.has_value(); });
}

const Split* benchmark_split(const Protocol& protocol, const std::vector<Split>& splits) {
  const auto found = std::ranges::find(splits, protocol.default_split, &Split::name);
  return found == splits.end() ? nullptr : &*found;
}

const Split* benchmark_scans(const Protocol& protocol, const std::vector<Split>& splits) {
  const Split* split = benchmark_split(protocol, splits);
  return split != nullptr && picks_scans(*split) ? split : nullptr;
}

std::optional<std::set<std::string>> stems_in_split(const Split& split, std::size_t position) {
  const auto part = std::ranges::find(split.parts, position, &SplitPart::sequence);
  return part == split.parts.end() ? std::set<std::string>{} : part->stems;
}

std::map<std::string, std::set<std::string>> picked_stems(const Dataset& dataset,
                                                          std::size_t position) {
  std::map<std::string, std::set<std::string>> picked;
  for (const Split& split : dataset.splits) {
    for (const SplitPart& part : split.parts) {
      if (part.sequence == position && part.stems) picked[split.name] = *part.stems;
    }
  }
  return picked;
}

}  // namespace mosbench
