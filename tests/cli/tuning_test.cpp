#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "datasets/hdf5/hdf5_module.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

using nlohmann::ordered_json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Two sequences of different lengths: tuned on one, judged on the other.
class Tuning : public testing::Test {
 protected:
  Tuning() {
    cli::write_small_sequence(folder_ / "data/sequences/00", 9);
    cli::write_small_sequence(folder_ / "data/sequences/01", 12, 9);
    folder_.write("s.yaml", R"(name: tune
protocol: semantickitti-mos
data: {name: small, path: data, dataset: semantickitti}
methods: [{method: underwood, set: {reference_offset_scans: 2}}]
grid: {max_range_m: [3, 40], range_tolerance_m: [0.15, 0.3]}
best_of: {metric: iou, tune_on: ["00"], judge_on: ["01"]}
)");
  }
  cli::Answer run(std::vector<std::string> words) const { return cli::run(words); }
  std::string path(const char* name) const { return folder_ / name; }

  TempFolder folder_;
};

TEST_F(Tuning, WritesAPresetThatRunTakes) {
  const cli::Answer half = run({"rank", path("s.yaml"), "--out", path("out")});
  EXPECT_EQ(half.exit_code, 1);
  EXPECT_THAT(half.out, AllOf(HasSubstr("4 cells of tune_on are missing"),
                              HasSubstr("small 00, underwood and 9 more cells: missing")));
  const cli::Answer study = run({"run", path("s.yaml"), "--out", path("out"), "--threads", "1"});
  ASSERT_EQ(study.exit_code, 0) << study.err;
  const std::string preset = path("out/underwood.preset.json");
  ASSERT_TRUE(is_there(preset));
  const auto json = ordered_json::parse(read_file(preset));
  EXPECT_EQ(json.at("method"), "underwood");
  EXPECT_EQ(json.at("preset"), "semantickitti");
  EXPECT_EQ(json.at("settings").at("max_range_m"), 40.0);
  EXPECT_EQ(json.at("metric"), "iou");
  EXPECT_EQ(json.at("tuned_on").at(0).at("label"), "small 00");
  EXPECT_EQ(json.at("tuned_on").size(), 1U);
  EXPECT_THAT(study.out, AllOf(HasSubstr("tuned IoU %"), HasSubstr("judged IoU %"),
                               HasSubstr("tuned on small 00 by iou (study tune)")));
  const auto table =
      ordered_json::parse(run({"rank", path("s.yaml"), "--out", path("out"), "--as", "json"}).out);
  const auto& choice = table.at("choices").at(0);
  EXPECT_EQ(choice.at("preset").at("settings"), json.at("settings"));

  // The same numbers as in the study, and a doubt where it was tuned.
  const cli::Answer judged =
      run({"run", path("data"), "--dataset", "semantickitti", "--sequences", "01", "--preset",
           preset, "--protocol", "semantickitti-mos", "--out", path("judged")});
  ASSERT_EQ(judged.exit_code, 0) << judged.err;
  EXPECT_THAT(judged.out, AllOf(HasSubstr("settings of "), Not(HasSubstr("tuned on this"))));
  const auto result = cli::timeless_result(folder_ / "judged/01");
  EXPECT_EQ(result.at("summary").at("iou"), choice.at("chosen").at("judged").at("iou").at("value"));
  EXPECT_THAT(result.at("settings_from").get<std::string>(),
              HasSubstr("tuned on small 00 by iou (study tune)"));
  EXPECT_THAT(result.at("doubts").dump(), Not(HasSubstr("tuned")));
  const cli::Answer tuned = run({"run", path("data"), "--dataset", "semantickitti", "--sequences",
                                 "00", "--preset", preset, "--out", path("tuned")});
  ASSERT_EQ(tuned.exit_code, 0) << tuned.err;
  EXPECT_THAT(tuned.out, HasSubstr("tuned on this sequence"));
  const cli::Answer scored = run({"score", path("data"), "--dataset", "semantickitti",
                                  "--sequences", "00", "--predictions", path("tuned")});
  EXPECT_THAT(scored.out, HasSubstr("tuned on this sequence"));
  const cli::Answer part = run({"run", path("data"), "--dataset", "semantickitti", "--sequences",
                                "00", "--scans", ":8", "--preset", preset, "--out", path("part")});
  EXPECT_THAT(part.out, HasSubstr("tuned on this sequence"));
  // Another layout and name; and another drive that has the name.
  ASSERT_EQ(run({"convert", path("data"), "--dataset", "semantickitti", "--sequences", "00",
                 "--layout", "nuscenes", "--out", path("copy")})
                .exit_code,
            0);
  fs::create_directories(folder_ / "other/sequences");
  fs::copy(folder_ / "data/sequences/01", folder_ / "other/sequences/00",
           fs::copy_options::recursive);
  for (const auto& [data, expected] :
       {std::pair("copy", testing::Matcher<std::string>(HasSubstr("tuned on this sequence"))),
        std::pair("other", testing::Matcher<std::string>(Not(HasSubstr("tuned on a"))))}) {
    const cli::Answer answer =
        run({"run", path(data), "--preset", preset, "--out", folder_ / "of" / data});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
    EXPECT_THAT(answer.out, expected) << data;
  }
  // What the study did not write stays.
  folder_.write("user.json", "{}");
  fs::remove_all(folder_ / "out/cells");
  const cli::Answer kept =
      run({"run", path("s.yaml"), "--out", path("out"), "-o", path("user.json")});
  EXPECT_EQ(kept.exit_code, 2);
  EXPECT_THAT(kept.err, HasSubstr("user.json: is there and no json that mosbench wrote"));
  EXPECT_FALSE(is_there(folder_ / "out/cells")) << "found before any work";
  write_file_atomic(preset, "my notes");
  fs::remove_all(folder_ / "out/cells");
  const cli::Answer foreign = run({"run", path("s.yaml"), "--out", path("out"), "--threads", "1"});
  EXPECT_EQ(foreign.exit_code, 2);
  EXPECT_THAT(foreign.err, HasSubstr("underwood.preset.json: is there and no preset of a study"));
  EXPECT_EQ(read_file(preset), "my notes");
  EXPECT_FALSE(is_there(folder_ / "out/cells")) << "found before any work";
}

TEST_F(Tuning, RefusesPresetsOfAnotherMethodAndOtherFiles) {
  folder_.write("p.json",
                R"({"method": "underwood", "preset": null, "settings": {}, "metric": "iou",
                             "study": "s", "tuned_on": []})");
  const cli::Answer other = run({"run", path("data/sequences/00"), "--method", "yoon", "--preset",
                                 path("p.json"), "--out", path("x")});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("p.json: is of method Underwood et al., expected no --method"));
  const cli::Answer gone =
      run({"run", path("data/sequences/00"), "--preset", path("gone.json"), "--out", path("x")});
  EXPECT_EQ(gone.exit_code, 2);
  EXPECT_THAT(gone.err, HasSubstr("gone.json"));
  folder_.write("s.yaml", read_file(folder_ / "s.yaml") + "seeds: [1]\n");
  std::string text = read_file(folder_ / "s.yaml");
  folder_.write("s.yaml", text.replace(text.find("[\"01\"]"), 6, "[\"00\"]"));
  const cli::Answer cheat = run({"run", path("s.yaml"), "--out", path("out")});
  EXPECT_EQ(cheat.exit_code, 2);
  EXPECT_THAT(cheat.err, HasSubstr("best_of tunes and judges on sequence \"small 00\""));
}

/// Another folder, name or number of scans makes no other drive.
TEST_F(Tuning, RefusesToJudgeOnWhatItWasTunedOn) {
  const auto refusal = [&](const std::string& data, const std::string& judge_on) {
    folder_.write("s.yaml",
                  "name: tune\nprotocol: semantickitti-mos\nmethods: [underwood]\n"
                  "grid: {max_range_m: [3, 40]}\ndata:\n" +
                      data + "best_of: {metric: iou, tune_on: [a], judge_on: [" + judge_on +
                      "]}\n");
    const cli::Answer answer = run({"run", path("s.yaml"), "--out", path("out")});
    EXPECT_EQ(answer.exit_code, 2) << answer.out;
    return answer.err;
  };
  fs::create_directories(folder_ / "copy/sequences");
  fs::copy(folder_ / "data/sequences/00", folder_ / "copy/sequences/77",
           fs::copy_options::recursive);
  const std::string copies = R"(- {name: a, path: data, dataset: semantickitti, sequences: ["00"]}
- {name: b, path: copy, dataset: semantickitti}
)";
  EXPECT_THAT(refusal(copies, "b"), HasSubstr("tunes on \"a 00\" and judges on \"b 77\", which are "
                                              "the same drive"));
  // Another layout, and all scans but one.
  const auto convert = [&](const char* from, const char* layout) {
    const cli::Answer answer =
        run({"convert", path(from), "--layout", layout, "--out", path(layout)});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
  };
  convert("copy", "helimos");
  convert("helimos", has_hdf5() ? "opensceneflow" : "nuscenes");
  for (const char* file : {"velodyne/000003.bin", "labels/000003.label"}) {
    fs::remove(folder_ / "copy/sequences/77" / file);
  }
  std::string poses = read_file(folder_ / "copy/sequences/77/poses.txt");
  folder_.write("copy/sequences/77/poses.txt", poses.substr(poses.find('\n') + 1));
  for (const char* place : {"copy", "helimos", has_hdf5() ? "opensceneflow" : "nuscenes"}) {
    const std::string dataset =
        std::string_view(place) == "copy" ? "semantickitti" : std::string(place);
    EXPECT_THAT(refusal("- {name: a, path: data, dataset: semantickitti, sequences: [\"00\"]}\n"
                        "- {name: b, path: " +
                            std::string(place) + ", dataset: " + dataset + "}\n",
                        "b"),
                HasSubstr("which are the same drive"))
        << place;
  }
  // A part of a copy, whose scans have other numbers.
  ASSERT_EQ(run({"convert", path("data"), "--dataset", "semantickitti", "--sequences", "01",
                 "--scans", "6:", "--layout", "semantickitti", "--out", path("part")})
                .exit_code,
            0);
  EXPECT_THAT(
      refusal("- {name: a, path: data, dataset: semantickitti, sequences: [\"01\"], reading: "
              "{scans: \"6:\"}}\n- {name: b, path: part, dataset: semantickitti, reading: {scans: "
              "\":6\"}}\n",
              "b"),
      HasSubstr("which are the same drive"));
  const std::string simulated =
      R"(- {name: a, simulate: {layout: semantickitti, scene: room, scans: 6, seed: 3}}
- {name: b, simulate: {layout: doals, scene: room, scans: 8, seed: 3}}
)";
  EXPECT_THAT(refusal(simulated, "b"), HasSubstr("which are the same drive"));
  const cli::Answer made = run({"simulate", "--layout", "semantickitti", "--scene", "room",
                                "--scans", "6", "--seed", "3", "--out", path("made")});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(refusal(simulated.substr(0, simulated.find("- {name: b")) +
                          "- {name: b, path: made, dataset: semantickitti}\n",
                      "b"),
              HasSubstr("which are the same drive"));
}

TEST_F(Tuning, MayJudgeOnAnotherSensorOfASimulation) {
  folder_.write("s.yaml", R"(name: tune
protocol: semantickitti-mos
methods: [underwood]
grid: {max_range_m: [3, 40]}
data:
- {name: a, simulate: {layout: helimos, scene: room, scans: 6, seed: 3}, sequences: [Aeva]}
- {name: b, simulate: {layout: helimos, scene: room, scans: 6, seed: 3}, sequences: [Avia]}
best_of: {metric: iou, tune_on: [a], judge_on: [b]}
)");
  const cli::Answer answer = run({"rank", path("s.yaml"), "--out", path("out")});
  EXPECT_EQ(answer.exit_code, 1) << answer.err;
}

TEST_F(Tuning, TakesSeedsOfASceneForOneSequence) {
  std::string data;
  for (const char* seed : {"1", "2", "3"}) {
    const cli::Answer made = run({"simulate", "--layout", "semantickitti", "--scene", "room",
                                  "--scans", "6", "--seed", seed, "--out", path(seed)});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    data += fmt::format("- {{name: s{0}, path: \"{0}\", dataset: semantickitti}}\n", seed);
  }
  const std::string head = "name: seeds\nprotocol: semantickitti-mos\ndata:\n" + data;
  folder_.write("s.yaml", head +
                              "- {name: small, path: data, dataset: semantickitti, sequences: "
                              "[\"00\"]}\nmethods: [underwood, yoon]\n");
  const cli::Answer study = run({"run", path("s.yaml"), "--out", path("out"), "--as", "json"});
  ASSERT_EQ(study.exit_code, 0) << study.err;
  EXPECT_EQ(ordered_json::parse(study.out).at("ranked_sequences"), 2);
  // A foggy copy is no seed, and parts of one drive are none.
  ASSERT_EQ(run({"convert", path("1"), "--perturb", "range_noise_m=0.1", "--layout",
                 "semantickitti", "--out", path("noisy")})
                .exit_code,
            0);
  folder_.write("s.yaml",
                "name: kinds\nprotocol: semantickitti-mos\nmethods: [underwood, yoon]\n"
                "data:\n- {name: clean, path: \"1\", reading: {scans: \":3\"}}\n"
                "- {name: later, path: \"1\", reading: {scans: \"3:\"}}\n"
                "- {name: noisy, path: noisy, reading: {scans: \":3\"}}\n");
  const cli::Answer kinds = run({"run", path("s.yaml"), "--out", path("kinds"), "--as", "json"});
  ASSERT_EQ(kinds.exit_code, 0) << kinds.err;
  EXPECT_EQ(ordered_json::parse(kinds.out).at("ranked_sequences"), 3);
  folder_.write("s.yaml", head +
                              "methods: [underwood]\ngrid: {max_range_m: [3, 40]}\n"
                              "best_of: {metric: iou, tune_on: [s1], judge_on: [s2]}\n");
  EXPECT_THAT(run({"rank", path("s.yaml"), "--out", path("best")}).out,
              HasSubstr("best_of judges on \"s2 08\", another seed of the scene of \"s1 08\""));
}

TEST_F(Tuning, MayJudgeOnOtherScansOfADrive) {
  const auto exit_code = [&](const std::string& judged) {
    folder_.write("s.yaml", R"(name: tune
protocol: semantickitti-mos
methods: [underwood]
grid: {max_range_m: [3, 40]}
data:
- {name: a, path: data, dataset: semantickitti, sequences: ["01"], reading: {scans: ":6"}}
- {name: b, path: data, dataset: semantickitti, sequences: ["01"], reading: {scans: ")" +
                                judged + R"("}}
best_of: {metric: iou, tune_on: [a], judge_on: [b]}
)");
    return run({"rank", path("s.yaml"), "--out", path("out")}).exit_code;
  };
  EXPECT_EQ(exit_code("6:"), 1) << "cells are missing";
  EXPECT_EQ(exit_code("5:"), 2);
}

TEST_F(Tuning, GivesAProgramItsSettings) {
  const std::string client = std::string(MOSBENCH_SOURCE_DIR) + "/tests/examples/exec/client.py";
  const std::string program = "exec:/usr/bin/python3 " + client;
  const auto labels = [&](const std::string& out, std::vector<std::string> more) {
    std::vector<std::string> words = {
        "run",      path("data/sequences/00"), "--method", program,
        "--preset", "semantickitti",           "--out",    folder_ / out};
    words.insert(words.end(), more.begin(), more.end());
    const cli::Answer answer = cli::run(words);
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
    return read_file(folder_ / out / "00/labels/000008.label");
  };
  const std::string plain = labels("plain", {});
  EXPECT_EQ(labels("same", {"--set", "voxel_size_m=0.5"}), plain) << "its own default";
  EXPECT_NE(labels("other", {"--set", "voxel_size_m=3,name=mine,timeout_s=30"}), plain);
  EXPECT_EQ(cli::timeless_result(folder_ / "other/00").at("settings"),
            ordered_json::parse(R"({"timeout_s": 30.0, "voxel_size_m": 3.0, "name": "mine"})"));
  folder_.write("s.yaml", R"(name: tune
protocol: semantickitti-mos
data: {name: small, path: data, dataset: semantickitti}
methods: {name: ours, method: ")" +
                              program + R"(", preset: semantickitti, set: {voxel_size_m: 1}}
grid: {voxel_size_m: [3, 0.5]}
best_of: {metric: iou, tune_on: ["00"], judge_on: ["01"]}
)");
  const cli::Answer study = run({"run", path("s.yaml"), "--out", path("out"), "--threads", "1"});
  ASSERT_EQ(study.exit_code, 0) << study.err;
  const std::string preset = path("out/ours.preset.json");
  EXPECT_EQ(ordered_json::parse(read_file(preset)).at("settings").at("voxel_size_m"), 0.5);
  const cli::Answer again =
      run({"run", path("data/sequences/01"), "--preset", preset, "--out", path("again")});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(cli::timeless_result(folder_ / "again/01").at("settings").at("voxel_size_m"), 0.5);
}

}  // namespace
}  // namespace mosbench
