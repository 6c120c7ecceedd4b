#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/answer/answer.hpp"
#include "eval/truth/decisions.hpp"
#include "eval/truth/track_list.hpp"

namespace mosbench {

/// Sorts tracks into the order of decisions: in turn the most worthy one, while one is worth it,
/// and one drawn at random, the more likely the more points it has. The first mend the labels, the
/// drawn ones show how wrong the guesses are.
void sort_for_decisions(std::vector<TruthTrack>& tracks);

/// What labels say of the points of each track.
struct TrackCounts {
  std::vector<double> moving, all;  ///< as many as tracks
  double elsewhere = 0;             ///< called moving, of no track
};

/// Estimates the IoU of labels if every track were decided, with its 95 % interval. Decisions in
/// the order of `sort_for_decisions` are a sample: tracks above a threshold of points over chance
/// are all in it (sequential Poisson sampling), those decided for their worth stand for themselves.
/// The share of wrong guesses is estimated apart for points guessed moving and static, called
/// moving and static, each with a binomial interval (mid-P). Points of unsure tracks do not count.
/// Nothing before the first decision.
std::optional<Spread> sampled_iou(std::span<const TruthTrack> tracks,
                                  const std::map<std::string, Decided>& decided,
                                  const TrackCounts& counts);

}  // namespace mosbench
