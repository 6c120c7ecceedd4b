#include "eval/truth/sampled_iou.hpp"

#include <algorithm>
#include <array>
#include <random>

namespace mosbench {
namespace {

constexpr std::size_t kDraws = 2000;

/// Tracks with more of it are drawn first; a track of n points is above t with probability n / t.
double rank_of(const TruthTrack& track) { return static_cast<double>(track.points) / track.chance; }

/// Points whose guess may be wrong, of one guess that the labels share or not.
struct Part {
  double open = 0;                ///< of tracks that nobody decided
  double wrong = 0, sampled = 0;  ///< tracks that stand for them
};

double draw_beta(double a, double b, std::mt19937_64& random) {
  if (!(a > 0)) return 0;
  if (!(b > 0)) return 1;
  const double one = std::gamma_distribution<double>(a)(random);
  const double other = std::gamma_distribution<double>(b)(random);
  return one + other > 0 ? one / (one + other) : 0;
}

/// The sums of which IoU is a ratio, with what is not known about them.
class SampledCounts {
 public:
  SampledCounts(std::span<const TruthTrack> tracks, const std::map<std::string, Decided>& decided,
                const TrackCounts& counts)
      : called_(counts.elsewhere) {
    double most_worth = 0;  // of open tracks
    for (const TruthTrack& track : tracks) {
      if (decided.contains(track.id())) continue;
      most_worth = std::max(most_worth, track.worth);
      threshold_ = std::max(threshold_, rank_of(track));
    }
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      const auto found = decided.find(tracks[i].id());
      const double called = counts.moving[i], missed = counts.all[i] - called;
      if (found == decided.end()) {
        add(tracks[i].moves, called, missed);
        parts_[tracks[i].moves ? 1 : 0][1].open += called;
        parts_[tracks[i].moves ? 1 : 0][0].open += missed;
      } else if (found->second != Decided::kUnsure) {
        const bool moves = found->second == Decided::kMoving;
        add(moves, called, missed);
        const bool stands_alone =
            tracks[i].worth >= kWorthADecision && tracks[i].worth > most_worth;
        if (!stands_alone) take_as_sample(tracks[i], moves, counts.all[i], called);
      }
    }
  }

  /// Returns the IoU with these shares of wrong guesses: by guess, and by label.
  template <typename Share>
  double iou(Share&& share) const {
    double found = found_, missed = missed_;
    for (std::size_t guess = 0; guess < 2; ++guess) {
      const double sign = guess == 1 ? -1 : 1;  // what does not move is neither found nor missed
      missed += sign * parts_[guess][0].open * share(parts_[guess][0]);
      found += sign * parts_[guess][1].open * share(parts_[guess][1]);
    }
    return called_ + missed > 0 ? std::clamp(found / (called_ + missed), 0.0, 1.0) : 1;
  }

 private:
  void add(bool moves, double called, double missed) {
    called_ += called;
    found_ += moves ? called : 0;
    missed_ += moves ? missed : 0;
  }

  /// A track stands for open ones by the probability that it had not been drawn.
  void take_as_sample(const TruthTrack& track, bool moves, double all, double called) {
    const double weight = 1 - static_cast<double>(track.points) / threshold_;
    if (!(rank_of(track) > threshold_) || !(weight > 0) || !(all > 0)) return;
    for (const std::size_t label : {0U, 1U}) {
      Part& part = parts_[track.moves ? 1 : 0][label];
      const double share = weight * (label == 1 ? called : all - called) / all;
      part.sampled += share;
      part.wrong += moves == track.moves ? 0 : share;
    }
  }

  double threshold_ = 0;
  double called_, found_ = 0, missed_ = 0;  // points called moving, and those that move of the two
  std::array<std::array<Part, 2>, 2> parts_;  // by guess, and by label
};

}  // namespace

void sort_for_decisions(std::vector<TruthTrack>& tracks) {
  std::vector<const TruthTrack*> worthy, drawn;
  for (const TruthTrack& track : tracks) {
    if (track.worth >= kWorthADecision) worthy.push_back(&track);
    drawn.push_back(&track);
  }
  std::ranges::stable_sort(worthy, std::ranges::greater{}, &TruthTrack::worth);
  std::ranges::stable_sort(drawn, std::ranges::greater{},
                           [](const TruthTrack* track) { return rank_of(*track); });
  std::vector<TruthTrack> sorted;
  std::vector<bool> taken(tracks.size(), false);
  const auto take = [&](const TruthTrack* track) {
    const auto index = static_cast<std::size_t>(track - tracks.data());
    if (!taken[index]) sorted.push_back(*track);
    taken[index] = true;
  };
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (i < worthy.size()) take(worthy[i]);
    take(drawn[i]);
  }
  tracks = std::move(sorted);
}

std::optional<Spread> sampled_iou(std::span<const TruthTrack> tracks,
                                  const std::map<std::string, Decided>& decided,
                                  const TrackCounts& counts) {
  if (decided.empty()) return std::nullopt;
  const SampledCounts sums(tracks, decided, counts);
  std::mt19937_64 random(1);
  std::vector<double> drawn;
  for (std::size_t i = 0; i < kDraws; ++i) {
    // Mid-P: one or the other of what the exact binomial interval takes for its ends.
    drawn.push_back(sums.iou([&](const Part& part) {
      const double right = std::max(0.0, part.sampled - part.wrong);
      return random() % 2 == 0 ? draw_beta(part.wrong + 1, right, random)
                               : draw_beta(part.wrong, right + 1, random);
    }));
  }
  std::ranges::sort(drawn);
  const double value = sums.iou([](const Part& part) {
    return part.sampled > 0 ? std::min(1.0, part.wrong / part.sampled) : 0;
  });
  return Spread{value, drawn[kDraws / 40], drawn[kDraws - 1 - kDraws / 40]};
}

}  // namespace mosbench
