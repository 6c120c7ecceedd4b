#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

/// What a number is of travels from the data through everything made of them into every output.
namespace mosbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

cli::Answer succeed(const std::vector<std::string>& words) {
  cli::Answer answer = cli::run(words);
  EXPECT_EQ(answer.exit_code, 0) << words.front() << ": " << answer.err;
  return answer;
}

fs::path simulated_in(const TempFolder& folder, const std::string& layout = "semantickitti") {
  const fs::path root = folder / "sim";
  succeed({"simulate", "--layout", layout, "--scene", "room", "--scans", "6", "--seed", "5",
           "--out", root.string()});
  return root;
}

/// Every way to show the results below `run`, by its words.
std::map<std::string, std::string> shown(const fs::path& run, const std::string& data) {
  std::map<std::string, std::string> outputs;
  for (const char* as : {"text", "json", "csv", "latex", "markdown", "html"}) {
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"stats", run.string()},
          {"rank", run.string()},
          {"compare", run.string(), run.string()},
          {"compare", "--by", "scan", run.string(), run.string()},
          {"score", data, "--predictions", run.string()}}) {
      std::vector<std::string> all = words;
      all.insert(all.end(), {"--as", as});
      outputs[words[0] + (words[1] == "--by" ? " by scan" : "") + " as " + as] = succeed(all).out;
    }
  }
  succeed({"report", run.string(), "--scans", "none", "-o", (run / "page.html").string()});
  outputs["report"] = read_file(run / "page.html");
  return outputs;
}

/// The only file below a folder whose name ends so.
fs::path file_below(const fs::path& folder, const std::string& end) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().native().ends_with(end)) return entry.path();
  }
  ADD_FAILURE() << folder << " has no file *" << end;
  return {};
}

/// A text as LaTeX writes it.
std::string latex(const std::string& text) {
  return std::regex_replace(text, std::regex("_"), "\\_");
}

void expect_marked(const std::string& data, const fs::path& out) {
  const cli::Answer run = succeed({"run", data, "--out", out.string()});
  EXPECT_THAT(run.out, HasSubstr("SIMULATED data (scene room, seed 5")) << data;
  for (const auto& [name, text] : shown(out, data)) {
    const char* mark =
        name == "report" ? "simulated data (scene room, seed 5" : "SIMULATED data (scene";
    EXPECT_THAT(text, HasSubstr(mark)) << name << " of " << data;
    if (!name.ends_with("latex")) continue;
    EXPECT_THAT(text, HasSubstr("$^\\dagger$ SIMULATED"));
  }
}

TEST(SimulatedMark, StaysWithASequenceThatIsRenamedMovedCopiedOrLinkedTo) {
  const TempFolder folder;
  const fs::path root = simulated_in(folder);
  const fs::path sequence = root / "sequences/08";
  fs::create_directories(folder / "copy");
  fs::copy(sequence, folder / "copy/anything", fs::copy_options::recursive);
  fs::create_directory_symlink(sequence, folder / "link");
  fs::create_directories(folder / "mine");
  fs::create_directory_symlink(sequence / "velodyne", folder / "mine/velodyne");
  for (const char* file : {"poses.txt", "calib.txt"})
    fs::copy(sequence / file, folder / "mine" / file);
  const std::string poses = (sequence / "poses.txt").string();
  const auto is_marked = [&](const fs::path& data) {
    const std::string out = (folder / "out" / data.filename()).string();
    const cli::Answer answer =
        succeed({"run", data.string(), "--poses", poses, "--out", out, "--json"});
    return ordered_json::parse(answer.out).contains("simulated");
  };
  EXPECT_TRUE(is_marked(folder / "copy/anything"));
  EXPECT_TRUE(is_marked(folder / "link"));
  EXPECT_TRUE(is_marked(folder / "mine"));
  EXPECT_TRUE(is_marked(sequence / "velodyne"));
  fs::create_directories(folder / "elsewhere");
  fs::rename(sequence, folder / "elsewhere/renamed");
  fs::remove_all(root);
  expect_marked((folder / "elsewhere/renamed").string(), folder / "out/moved");
}

TEST(SimulatedMark, IsInheritedByWhatIsConvertedDisturbedOrGetsOtherPoses) {
  const TempFolder folder;
  const std::string root = simulated_in(folder).string();
  const std::string poses = (folder / "found.txt").string();
  const cli::Answer odometry = cli::run({"odometry", root, "-o", poses});
  EXPECT_THAT(odometry.out, HasSubstr("SIMULATED"));
  const auto converted = [&](const std::string& from, const std::string& layout) {
    const fs::path to = folder / ("as-" + layout);
    const cli::Answer answer = succeed({"convert", from, "--layout", layout, "--perturb",
                                        "range_noise_m=0.01", "--out", to.string()});
    EXPECT_THAT(answer.out, HasSubstr("SIMULATED"));
    fs::rename(to, folder / ("moved-" + layout));
    return folder / ("moved-" + layout);
  };
  const fs::path as_doals = converted(root, "doals");
  const fs::path as_bag = converted(as_doals.string(), "ros2-mcap");
  const fs::path as_kitti = converted(as_bag.string(), "semantickitti");
  const auto read = [](const fs::path& file) { return ordered_json::parse(read_file(file)); };
  EXPECT_EQ(read(as_kitti / "simulated.json").at("layout"), "semantickitti");
  expect_marked((as_kitti / "sequences").string(), folder / "out");
}

TEST(SimulatedMark, IsInsideABagThatIsCopiedAlone) {
  const TempFolder folder;
  const std::string root = simulated_in(folder).string();
  const std::map<std::string, std::string> bags = {
      {"ros2-mcap", ".mcap"}, {"ros2-db3", ".db3"}, {"doals-bag", ".bag"}};
  for (const auto& [layout, end] : bags) {
    const fs::path to = folder / layout;
    succeed({"convert", root, "--layout", layout, "--out", to.string()});
    const fs::path bag = file_below(to, end);
    fs::create_directories(folder / "alone");
    const fs::path alone = folder / ("alone/drive" + end);
    fs::copy(bag, alone);
    const cli::Answer run =
        succeed({"run", alone.string(), "--out", (folder / ("out" + end)).string()});
    EXPECT_THAT(run.out, HasSubstr("SIMULATED data (scene room, seed 5")) << layout;
  }
}

/// A doubt that stands in all that is shown of data, and of what is run on them.
void expect_doubt(const fs::path& data, const fs::path& out, const std::string& doubt) {
  const cli::Answer run = succeed({"run", data.string(), "--out", out.string()});
  EXPECT_THAT(run.out, HasSubstr(doubt)) << data;
  for (const auto& [name, text] : shown(out, data.string())) {
    EXPECT_THAT(text, HasSubstr(name.ends_with("latex") ? latex(doubt) : doubt)) << name;
  }
}

TEST(DisturbedMark, StandsInEveryOutputAndMovesWithTheSequence) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "room", 6);
  const std::string noise = "range_noise_m=0.01,seed=3", loss = "dropout_probability=0.1,seed=0";
  const cli::Answer converted =
      succeed({"convert", (folder / "room").string(), "--perturb", noise, "--layout",
               "semantickitti", "--out", (folder / "set").string()});
  EXPECT_THAT(converted.out, HasSubstr("disturbed on purpose by " + noise));
  fs::rename(folder / "set/sequences/room", folder / "renamed");
  expect_doubt(folder / "renamed", folder / "of-renamed", "disturbed on purpose by " + noise);
  const auto again = [&](const std::string& layout, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"convert", (folder / "renamed").string(), "--layout", layout,
                                      "--out",   (folder / layout).string()};
    words.insert(words.end(), more.begin(), more.end());
    succeed(words);
    return folder / layout;
  };
  expect_doubt(again("doals", {"--perturb", loss}), folder / "of-doals",
               "disturbed on purpose by " + noise + ", then " + loss);
  const fs::path bag = file_below(again("ros2-mcap", {}), ".mcap");
  fs::copy(bag, folder / "alone.mcap");
  const cli::Answer alone = succeed(
      {"run", (folder / "alone.mcap").string(), "--out", (folder / "of-bag").string(), "--json"});
  EXPECT_THAT(alone.out, HasSubstr("disturbed on purpose by " + noise));
  const cli::Answer found =
      cli::run({"odometry", (folder / "renamed").string(), "-o", (folder / "p.txt").string()});
  EXPECT_THAT(found.out, HasSubstr("disturbed on purpose by " + noise));
}

TEST(DisturbedMark, IsADoubtOfDataThatAreDisturbedAsTheyAreRead) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "room", 6);
  const std::string doubt = "disturbed on purpose by range_noise_m=0.01,seed=3";
  const fs::path out = folder / "out";
  succeed({"run", (folder / "room").string(), "--perturb", "range_noise_m=0.01,seed=3", "--out",
           out.string()});
  EXPECT_THAT(succeed({"stats", out.string()}).out, HasSubstr(doubt));
  // As an older program wrote it.
  ordered_json result = ordered_json::parse(read_file(out / "room/result.json"));
  result.erase("doubts");
  folder.write("out/room/result.json", result.dump());
  EXPECT_THAT(succeed({"stats", out.string()}).out, HasSubstr(doubt));
}

TEST(DisturbedMark, OfSimulatedDataIsADoubt) {
  const TempFolder folder;
  const fs::path sim = folder / "sim";
  succeed({"simulate", "--layout", "semantickitti", "--scene", "room", "--scans", "6", "--seed",
           "5", "--perturb", "pose_noise_m=0.01,seed=3", "--out", sim.string()});
  expect_doubt(sim / "sequences/08", folder / "out",
               "disturbed on purpose by pose_noise_m=0.01,seed=3");
}

TEST(DisturbedMark, IsNoFileOfTheUsersOfThatName) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "room", 6);
  folder.write("room/disturbed.txt", "by my dog\n");
  const cli::Answer run = cli::run({"run", (folder / "room").string(), "--out", folder / "out"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, Not(HasSubstr("disturbed")));
}

TEST(SimulatedMark, IsNotTakenFromTheFolderAround) {
  const TempFolder folder;
  const fs::path root = simulated_in(folder);
  cli::write_small_sequence(root / "recordings/mine", 6);
  const cli::Answer own =
      succeed({"run", (root / "recordings/mine").string(), "--out", (folder / "out").string()});
  EXPECT_THAT(own.out, Not(HasSubstr("SIMULATED")));
  cli::write_small_sequence(root / "sequences/09", 6);
  const cli::Answer mixed = cli::run({"run", root.string(), "--out", (folder / "mixed").string()});
  EXPECT_EQ(mixed.exit_code, 3);
  EXPECT_THAT(mixed.err, HasSubstr("sequences/09: has no simulated.json, but the data set"));
}

TEST(SimulatedMark, IsInEveryLayoutThatIsSimulated) {
  for (const char* layout :
       {"doals", "sipailou", "helimos", "nuscenes", "helipr", "kitti-raw", "kitti-tracking"}) {
    const TempFolder folder;
    const fs::path root = simulated_in(folder, layout);
    fs::remove(root / "simulated.json");
    fs::rename(root, folder / "renamed");
    const cli::Answer answer =
        succeed({"convert", (folder / "renamed").string(), "--dataset", layout, "--layout",
                 "semantickitti", "--out", (folder / "out").string()});
    EXPECT_THAT(answer.out, HasSubstr("SIMULATED")) << layout;
  }
}

/// Sequence "room" with faults that only a part of it has.
fs::path doubtful_sequence(const TempFolder& folder) {
  const fs::path room = folder / "room";
  cli::write_small_sequence(room, 6);
  folder.write("room/times.txt", "0.0\n0.1\n0.1\n0.2\n0.15\n0.4\n");
  return room;
}

TEST(Doubts, StandInEveryOutput) {
  const TempFolder folder;
  const fs::path room = doubtful_sequence(folder), out = folder / "out";
  const cli::Answer run = succeed({"run", room.string(), "--out", out.string()});
  const std::vector<std::string> doubts = {
      "2 stamps are not later than the one before, first that of scan 000002",
      "all 6 poses are equal"};
  for (const std::string& doubt : doubts) EXPECT_THAT(run.out, HasSubstr("room: " + doubt));
  for (const auto& [name, text] : shown(out, room.string())) {
    for (const std::string& doubt : doubts) EXPECT_THAT(text, HasSubstr(doubt)) << name;
  }
  for (const char* command : {"convert", "odometry"}) {
    const std::vector<std::string> to = {"--out", (folder / command).string()};
    std::vector<std::string> words = {command, room.string()};
    if (words[0] == "convert") words.insert(words.end(), {"--layout", "doals"});
    words.insert(words.end(), to.begin(), to.end());
    EXPECT_THAT(cli::run(words).out, HasSubstr(doubts[0])) << command;
  }
}

TEST(Doubts, AreOneLineForAllSequencesThatShareThem) {
  const TempFolder folder;
  for (const char* name : {"a", "b", "c", "d", "e"}) {
    cli::write_small_sequence(folder.path() / "set" / name, 3);
  }
  const cli::Answer run =
      succeed({"run", (folder / "set").string(), "--out", (folder / "out").string()});
  EXPECT_THAT(run.out, HasSubstr("a, b, c and 2 more: all 3 poses are equal"));
}

TEST(Doubts, AreNotSaidOfSoundData) {
  const TempFolder folder;
  const std::string root = simulated_in(folder).string();
  const cli::Answer run = succeed({"run", root, "--out", (folder / "out").string(), "--json"});
  const ordered_json answer = ordered_json::parse(run.out);
  EXPECT_EQ(answer.at("standing").size(), 1U) << answer.at("standing").dump();
  EXPECT_THAT(answer.at("sequences").at(0).at("doubts"), IsEmpty());
}

TEST(Doubts, AreSaidOfATruthWithOneClassAlone) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "room", 5);
  for (std::size_t k = 0; k < 5; ++k) {
    write_labels(folder / "room/labels" / (cli::stem(k) + ".label"),
                 std::vector<std::uint32_t>(cli::kPointsPerScan, kStaticLabel));
  }
  const cli::Answer run =
      succeed({"run", (folder / "room").string(), "--out", (folder / "out").string()});
  EXPECT_THAT(run.out, HasSubstr("by the truth no counted point of 5 scans moves"));
}

class MarkWriters : public testing::Test {
 protected:
  MarkWriters() {
    cli::write_small_sequence(folder_ / "room", 5);
    succeed({"run", room_, "--out", out_});
  }
  TempFolder folder_;
  const std::string room_ = (folder_ / "room").string(), out_ = (folder_ / "out").string();
};

TEST_F(MarkWriters, OfScoresReplaceNoOthers) {
  const std::string kept = (folder_ / "scores").string();
  const std::vector<std::string> words = {"score", room_, "--predictions", out_, "--out", kept};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), words.begin(), words.end());
    return cli::run(more);
  };
  succeed(words);
  succeed(words);
  const auto before = cli::contents(kept);
  const cli::Answer refused = with({"--protocol", "doals-hmm"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("result.json: holds other scores, expected --overwrite"));
  EXPECT_EQ(with({"--method", "ours"}).exit_code, 2);
  fs::resize_file(folder_ / "out/room/labels/000004.label", 0);
  EXPECT_EQ(with({"--allow-missing"}).exit_code, 2);
  EXPECT_EQ(cli::contents(kept), before);
  EXPECT_EQ(with({"--allow-missing", "--overwrite"}).exit_code, 0);
  EXPECT_NE(cli::contents(kept), before);
}

TEST_F(MarkWriters, WriteWhatTheNameSays) {
  const auto written = [&](const std::string& name, std::vector<std::string> words) {
    const std::string file = (folder_ / name).string();
    words.insert(words.end(), {"-o", file});
    succeed(words);
    return read_file(file);
  };
  EXPECT_THAT(written("t.csv", {"rank", out_}), HasSubstr("iou_percent"));
  EXPECT_THAT(written("t.tex", {"rank", out_}), HasSubstr("\\begin{tabular}"));
  EXPECT_THAT(written("t.md", {"rank", out_}), HasSubstr("|---|"));
  EXPECT_THAT(written("t.json", {"rank", out_}), testing::StartsWith("{"));
  EXPECT_THAT(written("t.html", {"rank", out_}), testing::StartsWith("<!doctype"));
  EXPECT_THAT(written("t", {"rank", out_, "--as", "csv"}), HasSubstr("iou_percent"));
  EXPECT_THAT(written("t.png", {"render", out_, "--scans", "4"}), HasSubstr("PNG"));
}

TEST_F(MarkWriters, RefuseNamesOfOtherKindsOfFiles) {
  const auto fault_of = [&](const std::string& name, std::vector<std::string> words) {
    const fs::path file = folder_ / name;
    words.insert(words.end(), {"-o", file.string()});
    const cli::Answer answer = cli::run(words);
    EXPECT_EQ(answer.exit_code, 2) << name;
    EXPECT_FALSE(fs::exists(file)) << name;
    return answer.err;
  };
  for (const char* name : {"x.pdf", "x.svg", "x.jpg", "x.csv", "x.mp4"}) {
    EXPECT_THAT(fault_of(name, {"render", out_, "--scans", "4"}),
                HasSubstr("is not what is written, expected a name that ends in .png"));
  }
  EXPECT_THAT(fault_of("x.pdf", {"report", out_}), HasSubstr("ends in .html or .htm"));
  EXPECT_THAT(fault_of("x.pdf", {"rank", out_}), HasSubstr("ends in .txt"));
  EXPECT_THAT(fault_of("x.csv", {"rank", out_, "--as", "json"}), HasSubstr("ends in .json"));
  EXPECT_THAT(fault_of("x.pdf", {"compare", out_, out_}), HasSubstr("ends in .md"));
}

TEST_F(MarkWriters, NameTheFileAndWhatItLacks) {
  const fs::path file = folder_ / "out/room/result.json";
  const std::string whole = read_file(file);
  const auto fault_without = [&](const std::vector<std::string>& path) {
    ordered_json json = ordered_json::parse(whole);
    ordered_json* parent = &json;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) parent = &parent->at(path[i]);
    parent->erase(path.back());
    write_file_atomic(file, json.dump());
    const cli::Answer answer = cli::run({"stats", out_});
    EXPECT_EQ(answer.exit_code, 3) << path.back();
    EXPECT_THAT(answer.err, Not(HasSubstr("json.exception")));
    return answer.err;
  };
  for (const char* member : {"sequence", "dataset", "method", "protocol", "provenance", "scans"}) {
    EXPECT_THAT(fault_without({member}),
                HasSubstr(file.string() + ": lacks \"" + member + "\", expected a result.json"));
  }
  EXPECT_THAT(fault_without({"places", "reading"}), HasSubstr("lacks \"reading\""));
  ordered_json wrong = ordered_json::parse(whole);
  wrong["provenance"]["version"] = 7;
  write_file_atomic(file, wrong.dump());
  EXPECT_THAT(cli::run({"stats", out_}).err,
              HasSubstr("\"provenance\" \"version\" type must be string, but is number"));
}

}  // namespace
}  // namespace mosbench
