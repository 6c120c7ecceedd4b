#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "eval/truth/sampled_iou.hpp"

namespace mosbench {
namespace {

/// Tracks of a drive that nobody ever drove, with what is true of them.
struct MadeDrive {
  std::vector<TruthTrack> tracks;
  std::map<std::string, Decided> truth;
};

/// Tracks of all sizes; guesses are wrong the more often the more looks speak against them.
MadeDrive made_drive(std::mt19937_64& random, double wrong_share) {
  std::uniform_real_distribution<double> even(0, 1);
  std::normal_distribution<double> log_points(5, 1.6);
  MadeDrive drive;
  const std::size_t count = 40 + random() % 260;
  double moving = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    TruthTrack track{.sequence = "08", .number = i + 1};
    track.points = static_cast<std::size_t>(std::ceil(std::exp(log_points(random))));
    track.moves = even(random) < 0.35;
    track.doubt = std::pow(even(random), 5);
    track.chance = 1 - even(random);
    moving += track.moves ? static_cast<double>(track.points) : 0;
    const bool wrong = even(random) < std::min(0.9, 6 * wrong_share * track.doubt);
    drive.truth[track.id()] = track.moves != wrong ? Decided::kMoving : Decided::kStatic;
    drive.tracks.push_back(track);
  }
  for (TruthTrack& track : drive.tracks) {
    track.worth =
        static_cast<double>(track.points) / std::max(1.0, moving) * track.doubt * track.doubt;
  }
  sort_for_decisions(drive.tracks);
  return drive;
}

std::map<std::string, Decided> first_decisions(const MadeDrive& drive, std::size_t count) {
  std::map<std::string, Decided> decided;
  for (std::size_t i = 0; i < std::min(count, drive.tracks.size()); ++i) {
    decided.insert(*drive.truth.find(drive.tracks[i].id()));
  }
  return decided;
}

double true_iou(const MadeDrive& drive, const TrackCounts& counts) {
  double found = 0, all = counts.elsewhere;
  for (std::size_t i = 0; i < drive.tracks.size(); ++i) {
    const bool moves = drive.truth.at(drive.tracks[i].id()) == Decided::kMoving;
    found += moves ? counts.moving[i] : 0;
    all += moves ? counts.all[i] : counts.moving[i];
  }
  return found / std::max(1.0, all);
}

/// Labels with the guesses, and those of a method that errs on its own.
TrackCounts guesses(const MadeDrive& drive) {
  TrackCounts counts;
  for (const TruthTrack& track : drive.tracks) {
    counts.all.push_back(static_cast<double>(track.points));
    counts.moving.push_back(track.moves ? counts.all.back() : 0);
  }
  return counts;
}

TrackCounts other_labels(const MadeDrive& drive, std::mt19937_64& random) {
  std::uniform_real_distribution<double> even(0, 1);
  TrackCounts counts = guesses(drive);
  for (std::size_t i = 0; i < drive.tracks.size(); ++i) {
    const bool moves = drive.truth.at(drive.tracks[i].id()) == Decided::kMoving;
    const double share = moves ? std::sqrt(even(random)) : std::pow(even(random), 12);
    counts.moving[i] = std::floor(share * counts.all[i]);
  }
  counts.elsewhere = 100;
  return counts;
}

TEST(SampledIou, IsInItsIntervalIn93To97Of100Drives) {
  constexpr int kRepetitions = 400;
  std::mt19937_64 random(11);
  int of_guesses = 0, of_others = 0;
  double width = 0;
  for (int i = 0; i < kRepetitions; ++i) {
    const MadeDrive drive = made_drive(random, i % 2 == 0 ? 0.02 : 0.1);
    const auto decided = first_decisions(drive, i % 4 < 2 ? 20 : 40);
    const auto is_inside = [&](const TrackCounts& counts) {
      const Spread iou = sampled_iou(drive.tracks, decided, counts).value();
      width += *iou.high - *iou.low;
      const double truth = true_iou(drive, counts);
      return *iou.low <= truth + 1e-9 && truth <= *iou.high + 1e-9 ? 1 : 0;
    };
    of_guesses += is_inside(guesses(drive));
    of_others += is_inside(other_labels(drive, random));
  }
  EXPECT_GE(of_guesses, 0.93 * kRepetitions);
  EXPECT_LE(of_guesses, 0.97 * kRepetitions);
  EXPECT_GE(of_others, 0.93 * kRepetitions);
  EXPECT_LT(width / (2 * kRepetitions), 0.4) << "an interval of all numbers is always right";
  RecordProperty("guesses", of_guesses);
  RecordProperty("others", of_others);
}

TEST(SampledIou, IsThatOfTheTruthWhenAllTracksAreDecided) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 20; ++i) {
    const MadeDrive drive = made_drive(random, 0.1);
    const TrackCounts counts = other_labels(drive, random);
    const Spread iou = sampled_iou(drive.tracks, drive.truth, counts).value();
    EXPECT_DOUBLE_EQ(*iou.value, true_iou(drive, counts));
    EXPECT_DOUBLE_EQ(*iou.low, *iou.value);
    EXPECT_DOUBLE_EQ(*iou.high, *iou.value);
  }
}

TEST(SampledIou, LeavesUnsureTracksOut) {
  const std::vector<TruthTrack> tracks = {{.sequence = "08", .number = 1, .points = 30},
                                          {.sequence = "08", .number = 2, .points = 50}};
  const TrackCounts counts{{20, 50}, {30, 50}, 10};
  EXPECT_EQ(sampled_iou(tracks, {}, counts), std::nullopt);
  const std::map<std::string, Decided> decided = {{"08/1", Decided::kMoving},
                                                  {"08/2", Decided::kUnsure}};
  EXPECT_DOUBLE_EQ(*sampled_iou(tracks, decided, counts).value().value, 20.0 / 40);
}

TEST(OrderOfDecisions, TakesTheMostWorthyAndADrawInTurn) {
  std::vector<TruthTrack> tracks;
  for (std::uint32_t i = 0; i < 6; ++i) {
    tracks.push_back({.sequence = "a",
                      .number = i,
                      .points = 10,
                      .worth = i < 3 ? 0.1 * (3 - i) : 0,
                      .chance = 0.1 * (6 - i)});
  }
  sort_for_decisions(tracks);
  std::vector<std::uint32_t> numbers;
  for (const TruthTrack& track : tracks) numbers.push_back(track.number);
  EXPECT_EQ(numbers, (std::vector<std::uint32_t>{0, 5, 1, 4, 2, 3}));
}

}  // namespace
}  // namespace mosbench
