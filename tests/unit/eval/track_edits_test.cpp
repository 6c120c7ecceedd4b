#include "eval/truth/track_edits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "datasets/text/errors.hpp"
#include "eval/truth/completion.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using Numbers = std::vector<std::uint32_t>;

TruthTrack proposed_track(std::uint32_t number, bool moves, double doubt) {
  return {.sequence = "08",
          .number = number,
          .first_scan = 0,
          .last_scan = 9,
          .scans = 10,
          .points = 100,
          .moves = moves,
          .doubt = doubt,
          .worth = 0.1};
}

const std::vector<TruthTrack> kProposed = {proposed_track(1, true, 0.3),
                                           proposed_track(2, false, 0.1)};

Decision making(const std::string& track, const TrackEdit& edit) {
  return {track, Decided::kMade, edit};
}

const TrackEdit kCut{.takes = {{1, 40}}, .first_scan = 6, .last_scan = 9};
const TrackEdit kMerge{.takes = {{1, 60}, {2, 100}}, .first_scan = 0, .last_scan = 9};

/// Whether the corners, seen from a point, turn all the way around.
bool turns_around(const std::vector<Eigen::Vector2d>& corners, const Eigen::Vector2d& point) {
  double turned = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d a = corners[i] - point, b = corners[(i + 1) % corners.size()] - point;
    turned += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  }
  return std::abs(turned) > std::numbers::pi;
}

TEST(TrackEdits, APolygonHoldsWhatItsCornersTurnAround) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-4, 4), share(0.3, 1);
  std::size_t inside = 0, outside = 0;
  for (int round = 0; round < 50; ++round) {
    TrackEdit edit{.takes = {{1, 1}}};
    for (int corner = 0; corner < 7; ++corner) {  // a star, whose sides do not cross
      const double angle = 2 * std::numbers::pi * corner / 7, reach_m = 4 * share(random);
      edit.corners_m.emplace_back(reach_m * std::cos(angle), reach_m * std::sin(angle));
    }
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 100; ++i) points.emplace_back(place(random), place(random), 0);
    Numbers objects(points.size(), 1);
    apply_edits(std::vector<MadeTrack>{{"08", 5, edit}}, "08", 0, points, objects);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool expected = turns_around(edit.corners_m, points[i].head<2>());
      ASSERT_EQ(objects[i], expected ? 5U : 1U);
      ++(expected ? inside : outside);
    }
  }
  EXPECT_GT(inside, 500U);
  EXPECT_GT(outside, 500U);
}

TEST(TrackEdits, AreAppliedInOrderWithinTheirScansAndSequence) {
  const std::vector<MadeTrack> made = {
      {"08", 3, kCut}, {"08", 4, {.takes = {{2, 1}, {3, 1}}, .first_scan = 7, .last_scan = 7}}};
  const std::vector<Eigen::Vector3d> points(4, Eigen::Vector3d::Zero());
  const auto after = [&](const std::string& sequence, std::size_t scan) {
    Numbers objects = {0, 1, 2, 9};
    apply_edits(made, sequence, scan, points, objects);
    return objects;
  };
  EXPECT_EQ(after("08", 5), (Numbers{0, 1, 2, 9}));
  EXPECT_EQ(after("08", 6), (Numbers{0, 3, 2, 9}));
  EXPECT_EQ(after("08", 7), (Numbers{0, 4, 4, 9}));
  EXPECT_EQ(after("08", 10), (Numbers{0, 1, 2, 9}));
  EXPECT_EQ(after("09", 7), (Numbers{0, 1, 2, 9}));
}

TEST(TrackEdits, PaintLeavesTheGroundAndTracksAlone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Eigen::Vector3d> points = {{0, 0, 0}, {0, 0, 0.05}, {0, 0, 0.2}, {0, 0, 1.5},
                                               {0, 0, 1}, {9, 9, 1},    {0, 0, nan}};
  Numbers objects = {0, 0, 0, 0, 7, 0, 0};
  const TrackEdit paint{.takes = {{0, 2}}, .corners_m = {{-1, -1}, {1, -1}, {0, 2}}};
  apply_edits(std::vector<MadeTrack>{{"08", 5, paint}}, "08", 0, points, objects);
  EXPECT_EQ(objects, (Numbers{0, 0, 5, 5, 7, 0, 0}));
}

TEST(TrackEdits, DivideWhatADecisionIsWorth) {
  const auto tracks_after = [](const std::vector<Decision>& decisions) {
    return edited(kProposed, made_by(decisions, kProposed, "f"), "f");
  };
  const auto cut = tracks_after({making("08/3", kCut)});
  ASSERT_EQ(cut.size(), 3U);
  EXPECT_EQ(cut[1].id(), "08/1");
  EXPECT_EQ(cut[1].points, 60U);
  EXPECT_EQ(cut[1].last_scan, 5U);
  EXPECT_DOUBLE_EQ(cut[1].worth, 0.06);
  EXPECT_EQ(cut[2].id(), "08/3");
  EXPECT_EQ(cut[2].points, 40U);
  EXPECT_EQ(cut[2].first_scan, 6U);
  EXPECT_TRUE(cut[2].moves);
  EXPECT_EQ(cut[2].doubt, 0.3);
  EXPECT_DOUBLE_EQ(cut[2].worth, 0.04);
  const auto merged = tracks_after({making("08/3", kCut), making("08/4", kMerge)});
  ASSERT_EQ(merged.size(), 2U) << "those without points are gone";
  EXPECT_EQ(merged[0].id(), "08/4");
  EXPECT_FALSE(merged[0].moves) << "most points were of a static one";
  EXPECT_DOUBLE_EQ(merged[0].worth, 0.16);
  const auto painted =
      tracks_after({making("08/3", {.takes = {{0, 25}}, .corners_m = {{0, 0}, {1, 0}, {0, 1}}})});
  EXPECT_EQ(painted[0].id(), "08/3");
  EXPECT_FALSE(painted[0].moves);
  EXPECT_EQ(painted[0].doubt, 0.5);
  EXPECT_DOUBLE_EQ(painted[0].worth, 0.2) << "25 beside 100 moving points";
}

TEST(TrackEdits, AreTakenBackFromTheLast) {
  const std::vector<Decision> both = {making("08/3", kCut), making("08/4", kMerge)};
  const auto with = [&](const std::string& id, Decided decided) {
    auto decisions = both;
    decisions.push_back({id, decided});
    return decisions;
  };
  const auto refused = [&](const std::vector<Decision>& decisions) {
    return message_of<DataError>(
        [&] { edited(kProposed, made_by(decisions, kProposed, "f"), "f"); });
  };
  EXPECT_EQ(made_by(with("08/4", Decided::kUnmade), kProposed, "f").size(), 1U);
  EXPECT_EQ(refused(with("08/3", Decided::kUnmade)),
            "f: unmakes \"08/3\", expected the last track that was made");
  EXPECT_EQ(refused({{"08/3", Decided::kMoving}}),
            "f: decides on \"08/3\", expected a track of tracks.json, or one made before");
  EXPECT_EQ(refused({making("08/2", kCut)}),
            "f: makes \"08/2\", expected a new number in a sequence of tracks.json");
  EXPECT_EQ(refused({making("09/3", kCut)}),
            "f: makes \"09/3\", expected a new number in a sequence of tracks.json");
  EXPECT_EQ(refused({making("08/0", kCut)}),
            "f: makes \"08/0\", expected a new number in a sequence of tracks.json");
  EXPECT_EQ(refused({both[0], making("08/5", {.takes = {{1, 61}}})}),
            "f: 08/5 takes 61 points of 1, expected a track with as many");
  EXPECT_EQ(new_number(kProposed, with("08/4", Decided::kUnmade), "08"), 5U) << "used once";
  EXPECT_EQ(new_number(kProposed, both, "09"), 1U);
  EXPECT_TRUE(last_of_each(std::vector<Decision>{
                               both[0], {"08/3", Decided::kMoving}, {"08/3", Decided::kUnmade}})
                  .empty());
}

TEST(TrackEdits, AreReadAsTheyWereWritten) {
  const std::vector<Decision> made = {
      making("08/3", {.takes = {{0, 7}}, .last_scan = 2, .corners_m = {{0.1, -2}, {3, 4}, {5, 6}}}),
      making("08/4", kCut),
      {"08/4", Decided::kUnmade}};
  EXPECT_EQ(parse_decisions(format_decisions(made), "f"), made);
  const auto refused = [](const std::string& members) {
    return message_of<DataError>([&] {
      parse_decisions(
          R"({"format": 1, "decisions": [{"track": "08/3", "decided": "made", )" + members + "}]}",
          "f");
    });
  };
  const auto with = [&](const std::string& takes, const std::string& scans,
                        const std::string& corners) {
    return refused("\"takes\": " + takes + ", \"scans\": " + scans + ", \"corners_m\": " + corners);
  };
  EXPECT_EQ(with(R"({"1": 2})", "[3, 4]", "[]"), "nothing thrown");
  EXPECT_TRUE(refused("\"takes\": {}").starts_with("f: lacks \"scans\""));
  EXPECT_TRUE(with(R"({"x": 2})", "[3, 4]", "[]").starts_with("f: has a track that is no number"));
  EXPECT_TRUE(
      with(R"({"4294967296": 2})", "[3, 4]", "[]").starts_with("f: has a track that is no number"));
  for (const char* count : {"-2", "1.5", "\"2\""}) {
    EXPECT_TRUE(with(std::string(R"({"1": )") + count + "}", "[3, 4]", "[]")
                    .starts_with("f: has a count that is no whole number"));
  }
  EXPECT_TRUE(with(R"({"1": 2})", "[4, 3]", "[]").starts_with("f: has scans that end too soon"));
  EXPECT_TRUE(with(R"({"1": 2})", "[3, 4]", "[[0, 0], [1, 1]]")
                  .starts_with("f: has a polygon of less than three corners"));
  EXPECT_TRUE(with(R"({"0": 2})", "[3, 4]", "[]")
                  .starts_with("f: has a polygon of less than three corners"))
      << "all points of no track are no paint";
  EXPECT_TRUE(with("[5]", "[3, 4]", "[]").starts_with("f: has tracks that are no object"));
  EXPECT_NE(with(R"({"1": 2})", "[3]", "[]"), "nothing thrown");
  EXPECT_NE(with(R"({"1": 2})", "[3, 4]", R"([["a", 0], [1, 1], [2, 2]])"), "nothing thrown");
}

}  // namespace
}  // namespace mosbench
