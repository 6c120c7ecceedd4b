#include <gtest/gtest.h>

#include <random>

#include "datasets/disk/files.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/text/errors.hpp"
#include "eval/result/result_scans.hpp"
#include "eval/truth/completion.hpp"
#include "eval/truth/decisions.hpp"
#include "eval/truth/track_list.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

/// A run of two scans with the files that tracks are listed from.
struct KeptScan {
  std::vector<std::uint32_t> objects, labels;
  std::vector<float> scores;
};

Result kept_run(const TempFolder& folder, const std::vector<KeptScan>& scans) {
  Result run;
  run.file = folder / "08/result.json";
  run.sequence = SequenceName("08", run.file);
  run.from.fingerprint = "abc";
  for (std::size_t k = 0; k < scans.size(); ++k) {
    ScanRow& row = run.scans.emplace_back();
    row.stem = std::to_string(k);
    row.points = scans[k].objects.size();
    write_labels(object_file(run.folder(), row.stem), scans[k].objects);
    write_labels(run.folder() / "labels" / (row.stem + ".label"), scans[k].labels);
    write_file_atomic(dynamic_score_file(run.folder(), row.stem),
                      format_dynamic_scores(scans[k].scores));
  }
  return run;
}

TEST(TruthTracks, AreOrderedByWhatADecisionIsWorth) {
  const TempFolder folder;
  const Result run =
      kept_run(folder, {{{1, 1, 1, 2, 0}, {251, 251, 251, 9, 9}, {1, 1, 1, .5, 0}},
                        {{1, 3, 3, 2, 0}, {251, 251, 251, 9, 9}, {1, .2F, .2F, .5, 0}}});
  const TrackList list = list_tracks({run});
  ASSERT_EQ(list.tracks.size(), 3U);
  const auto& [doubtful, still, sure] = std::tie(list.tracks[0], list.tracks[1], list.tracks[2]);
  EXPECT_EQ(doubtful.id(), "08/3");
  EXPECT_TRUE(doubtful.moves);
  EXPECT_FLOAT_EQ(static_cast<float>(doubtful.doubt), 0.8F) << "looks that hit it speak against it";
  EXPECT_FLOAT_EQ(static_cast<float>(doubtful.worth), 2.0F / 6 * 0.64F);
  EXPECT_EQ(still.id(), "08/2");
  EXPECT_FALSE(still.moves);
  EXPECT_EQ(still.doubt, 0.5);
  EXPECT_EQ(sure.id(), "08/1");
  EXPECT_EQ(sure.worth, 0);
  EXPECT_EQ(sure.points, 4U);
  EXPECT_EQ(sure.scans, 2U);
  EXPECT_EQ(sure.first_scan, 0U);
  EXPECT_EQ(sure.last_scan, 1U);
  EXPECT_EQ(format_tracks(parse_tracks(format_tracks(list), "f")), format_tracks(list));
  EXPECT_EQ(parse_tracks(format_tracks(list), "f").fingerprints.at("08"), "abc");
}

TEST(TruthTracks, RefuseAFileThatIsNotTheirs) {
  const auto refused = [](const std::string& text) {
    return message_of<DataError>([&] { parse_tracks(text, "f"); });
  };
  const std::string wrote = ", expected the file as `mosbench truth propose` wrote it";
  EXPECT_EQ(refused("{}"), "f: lacks \"format\"" + wrote);
  EXPECT_EQ(refused(R"({"format": 2})"), "f: has a wrong \"format\"" + wrote);
  const auto with = [](const std::string& track) {
    return R"({"format": 1, "fingerprints": {"08": ""}, "tracks": [)" + track + "]}";
  };
  const std::string good =
      R"({"sequence": "08", "number": 1, "first_scan": 0, "last_scan": 0, "scans": 1, "points": 1, )"
      R"("guess": "moving", "doubt": 0.5, "worth": 0})";
  EXPECT_EQ(parse_tracks(with(good), "f").tracks.size(), 1U);
  EXPECT_EQ(refused(with(good + "," + good)), "f: has a wrong \"tracks\"" + wrote);
  const auto changed = [&](const std::string& from, const std::string& to) {
    return with(std::string(good).replace(good.find(from), from.size(), to));
  };
  EXPECT_EQ(refused(changed("\"number\": 1", "\"number\": 0")),
            "f: has a wrong \"number\"" + wrote);
  EXPECT_EQ(refused(changed("0.5", "1.5")), "f: has a wrong \"doubt\"" + wrote);
  EXPECT_EQ(refused(changed("\"08\", \"number\"", "\"09\", \"number\"")),
            "f: has a wrong \"sequence\"" + wrote);
  EXPECT_EQ(refused(changed("moving", "maybe")), "f: has a wrong \"guess\"" + wrote);
}

TEST(Decisions, TheLastOneOfATrackCounts) {
  const std::vector<Decision> made = {{"08/1", Decided::kMoving},
                                      {"08/2", Decided::kStatic},
                                      {"08/1", Decided::kUnsure},
                                      {"08/2", Decided::kTakenBack}};
  EXPECT_EQ(last_of_each(made), (std::map<std::string, Decided>{{"08/1", Decided::kUnsure}}));
  EXPECT_EQ(parse_decisions(format_decisions(made), "f"), made) << "all stay, to be taken back";
}

TEST(Decisions, RefuseWordsThatAreNotKnown) {
  const auto refused = [](const std::string& text) {
    return message_of<DataError>([&] { parse_decisions(text, "f"); });
  };
  EXPECT_TRUE(refused(R"({"format": 1})").starts_with("f: lacks \"decisions\""));
  EXPECT_TRUE(
      refused(R"({"format": 3, "decisions": []})").starts_with("f: has another \"format\""));
  EXPECT_TRUE(refused(R"({"format": 1, "decisions": [{"track": "a/1", "decided": "yes"}]})")
                  .starts_with("f: has a decision that is not known"));
}

/// The rule of completion, point by point.
std::vector<std::uint32_t> completed_plainly(const std::vector<Eigen::Vector3d>& points,
                                             const std::vector<std::uint32_t>& part) {
  const auto column = [](double x) { return std::floor(x / 0.5); };
  std::vector<std::uint32_t> completed(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (part[i] != 0) continue;
    double least = 0.3 * 0.3, low = points[i].z();
    std::uint32_t nearest = 0;
    for (std::size_t j = 0; j < points.size(); ++j) {
      const Eigen::Vector3d to = points[j] - points[i];
      const bool is_around = std::abs(column(points[j].x()) - column(points[i].x())) <= 2 &&
                             std::abs(column(points[j].y()) - column(points[i].y())) <= 2;
      if (is_around) low = std::min(low, points[j].z());
      if (part[j] == 0 || to.squaredNorm() >= least) continue;
      least = to.squaredNorm();
      nearest = part[j];
    }
    const double height = points[i].z() - low;
    if (height >= 0.05 && height <= 0.5) completed[i] = nearest;
  }
  return completed;
}

TEST(Completion, IsThatOfThePlainRule) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-3, 3), height(0, 0.8);
  std::size_t completed = 0;
  for (int round = 0; round < 20; ++round) {
    std::vector<Eigen::Vector3d> points;
    std::vector<std::uint32_t> part;
    for (int i = 0; i < 400; ++i) {
      points.emplace_back(place(random) + 500, place(random), height(random));
      part.push_back(i % 5 == 0 ? static_cast<std::uint32_t>(1 + random() % 3) : 0);
    }
    const auto expected = completed_plainly(points, part);
    ASSERT_EQ(completed_by(points, part), expected);
    completed += static_cast<std::size_t>(std::ranges::count_if(expected, std::identity{}));
  }
  EXPECT_GT(completed, 100U);
}

TEST(Completion, LeavesPointsAloneThatAreNoNumbers) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Eigen::Vector3d> points = {{0, 0, 0}, {0, 0, 0.3}, {nan, 0, 0.2}, {0, 0, 0.2}};
  EXPECT_EQ(completed_by(points, std::vector<std::uint32_t>{0, 7, 0, 0}),
            (std::vector<std::uint32_t>{0, 0, 0, 7}));
}

}  // namespace
}  // namespace mosbench
