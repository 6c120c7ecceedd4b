#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <set>
#include <sstream>

#include "eval/cli/command_line.hpp"
#include "eval/cli/commands.hpp"
#include "tests/cli/program.hpp"

namespace mosbench {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// The width of a page in a terminal beside another.
void expect_narrow(const std::string& help, const std::string& name) {
  constexpr std::size_t kColumns = 100;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(line.size(), kColumns) << name << ": " << line;
  }
}

TEST(Help, OfTheProgramNamesEveryCommand) {
  const cli::Answer answer = cli::run({"--help"});
  EXPECT_EQ(answer.exit_code, 0);
  EXPECT_THAT(answer.out, HasSubstr("Usage: mosbench COMMAND [OPTIONS]\n"));
  EXPECT_THAT(answer.out, HasSubstr("Examples:\n  mosbench "));
  for (const Command& command : commands()) {
    EXPECT_THAT(answer.out, ContainsRegex(fmt::format("\n  {} +{}\n", command.name, command.help)));
  }
  EXPECT_EQ(cli::run({"help"}).out, answer.out);
  expect_narrow(answer.out, "mosbench");
}

TEST(Help, OfEveryCommandShowsUsageAndExamplesWithin100Columns) {
  ASSERT_EQ(commands().size(), 18U);
  for (const Command& command : commands()) {
    const std::string name(command.name);
    const cli::Answer answer = cli::run({name, "--help"});
    EXPECT_EQ(answer.exit_code, 0) << name;
    EXPECT_EQ(answer.err, "") << name;
    EXPECT_THAT(answer.out, StartsWith(command.help)) << name;
    EXPECT_THAT(answer.out, HasSubstr("Usage: mosbench " + name + " ")) << name;
    EXPECT_THAT(answer.out, HasSubstr("Examples:\n  mosbench " + name)) << name;
    EXPECT_EQ(cli::run({"help", name}).out, answer.out) << name;
    expect_narrow(answer.out, name);
    // What is typed behind a flag has a name or is listed.
    EXPECT_THAT(answer.out, Not(HasSubstr("TEXT"))) << name;
  }
}

/// Returns the command lines in a help, joined where they go on in the next line.
std::vector<std::string> example_lines(const std::string& help) {
  std::vector<std::string> examples;
  std::istringstream lines(help);
  bool goes_on = false;
  for (std::string line; std::getline(lines, line);) {
    if (goes_on) examples.back() += line;
    if (!goes_on && line.starts_with("  mosbench ")) examples.push_back(line);
    goes_on = !examples.empty() && examples.back().ends_with('\\') && line.ends_with('\\');
    if (goes_on) examples.back().pop_back();
  }
  return examples;
}

/// Returns the words behind the program's name, up to where a shell takes the answer.
std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words;
  std::istringstream text(line);
  for (std::string word; text >> word && word != ">" && word != "#";) {
    if (word.starts_with('"') && !word.ends_with('"')) {
      std::string rest;
      std::getline(text, rest, '"');
      word += rest;
    }
    std::erase(word, '"');
    words.push_back(word);
  }
  words.erase(words.begin());
  return words;
}

TEST(Help, FitsOneScreenAndItsExamplesAreUnderstood) {
  std::size_t examples = 0;
  const auto check = [&](const std::string& name) {
    std::vector<std::string> words = {name, "--help"}, all_words = {name, "--help-all"};
    if (name.empty()) words = {"--help"}, all_words = {"--help-all"};
    const std::string help = cli::run(words).out, all = cli::run(all_words).out;
    EXPECT_LE(std::ranges::count(help, '\n'), 40) << name << '\n' << help;
    expect_narrow(all, name);
    for (const std::string& line : example_lines(all)) {
      ++examples;
      EXPECT_NO_THROW(check_line(words_of(line))) << line;
    }
  };
  check("");
  for (const Command& command : commands()) check(std::string(command.name));
  EXPECT_GT(examples, 60U);
}

TEST(Help, ListsTheValuesOfAFlagAndNamesThoseOfAList) {
  const std::string run = cli::run({"run", "--help-all"}).out;
  for (const char* part : {"\n  --odometry {simple,kiss}", "\n  --write WHAT,...  ",
                           "Also write scores, boxes, moving-cloud, static-cloud,\n",
                           "\nReading:\n  --scans", "\nKeys of --read:\n  pose_format "}) {
    EXPECT_THAT(run, HasSubstr(part));
  }
  const std::string simulate = cli::run({"simulate", "--help"}).out;
  EXPECT_THAT(simulate, HasSubstr("Disturb what is written, in this order"));
  EXPECT_THAT(simulate, Not(HasSubstr("Reading:")));
}

TEST(Version, NamesProgramAndCompiler) {
  const cli::Answer answer = cli::run({"--version"});
  EXPECT_EQ(answer.exit_code, 0);
  EXPECT_EQ(cli::run({"-V"}).out, answer.out);
  EXPECT_THAT(answer.out, testing::MatchesRegex("mosbench [0-9].* \\(.+\\)\n"));
}

TEST(Usage, IsRefusedWithExitCode2AndAPrefixedMessage) {
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {},
           {"rum"},
           {"run"},
           {"run", "x", "--no-such-flag"},
           {"run", "x", "--threads", "0"},
           {"run", "x", "--threads", "many"},
           {"list", "nonsense"},
           {"score", "x"},
           {"simulate", "--layout", "doals", "--scene", "room", "--out", "x", "--seed", "-1"},
           {"simulate", "--layout", "doals"}}) {
    const cli::Answer answer = cli::run(arguments);
    EXPECT_EQ(answer.exit_code, 2) << testing::PrintToString(arguments);
    EXPECT_THAT(answer.err, StartsWith("mosbench: ")) << testing::PrintToString(arguments);
    EXPECT_EQ(answer.out, "") << testing::PrintToString(arguments);
  }
}

TEST(Usage, OfTrajectoryWithoutTruthSaysWhatToType) {
  const cli::Answer two = cli::run({"trajectory", "a.txt", "my b.txt"});
  EXPECT_EQ(two.exit_code, 2);
  EXPECT_THAT(two.err, HasSubstr("mosbench trajectory a.txt --truth 'my b.txt'"));
  EXPECT_THAT(two.err, HasSubstr("mosbench trajectory a.txt 'my b.txt' --truth TRUE_POSES"));
  EXPECT_THAT(cli::run({"trajectory", "a.txt"}).err,
              HasSubstr("expected mosbench trajectory a.txt --truth TRUE_POSES"));
}

TEST(List, ShowsTheSettingsOfOdometry) {
  const std::string text = cli::run({"list", "odometry"}).out;
  EXPECT_THAT(text, HasSubstr("\nkiss: "));
  EXPECT_THAT(text, ContainsRegex("\nuq-vlp16 +simple +.*sigma_m=12"));
  const auto json = nlohmann::json::parse(cli::run({"list", "odometry", "--json"}).out);
  const auto& kinds = json.at("odometry").at("kinds");
  ASSERT_EQ(kinds.size(), 2U);
  EXPECT_EQ(kinds.at(0).at("name"), "simple");
  for (const auto& setting : kinds.at(0).at("settings")) {
    EXPECT_THAT(text, HasSubstr("\n  " + setting.at("name").get<std::string>() + " "));
  }
}

TEST(Usage, RefusesAFolderAsOutputBeforeTheWork) {
  const TempFolder folder;
  const std::string nothing = folder / "nothing", out = folder.path();
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"report", nothing, "-o", out},
                                             {"render", nothing, "--scan", "0", "-o", out},
                                             {"stats", nothing, "--by", "threshold", "-o", out},
                                             {"compare", nothing, nothing, "--out", out},
                                             {"profile", nothing, "--json", out},
                                             {"profile", nothing, "--out", out},
                                             {"rank", nothing, "-o", out}}) {
    const cli::Answer answer = cli::run(words);
    EXPECT_EQ(answer.exit_code, 3) << words[0];
    EXPECT_THAT(answer.err, HasSubstr(out + ": is a folder, expected a file to write")) << words[0];
  }
  const auto file = folder.write("file", "");
  EXPECT_THAT(cli::run({"report", nothing, "-o", file / "x.html"}).err, HasSubstr("is no folder"));
}

TEST(Usage, NamesTheNearestWordToAnUnknownOne) {
  struct Mistake {
    std::vector<std::string> arguments;
    const char* error;
  };
  for (const Mistake& mistake : std::vector<Mistake>{
           {{"rum"}, "'rum' is not a command (nearest: run); see mosbench --help"},
           {{"help", "rum"}, "'rum' is not a command (nearest: run)"},
           {{"score", "x", "--predictons", "y"},
            "--predictons: is no flag of mosbench score (nearest: --predictions); see mosbench "
            "score --help"},
           {{"run", "x", "--treads=2"},
            "--treads: is no flag of mosbench run (nearest: --threads)"},
           {{"run", "x", "--delay", "10"}, "(a setting of hmm-mos: --set delay_scans=...)"},
           {{"run", "x", "-q"}, "-q: is no flag of mosbench run; see mosbench run --help"},
           {{"run", "x", "--out", "--json"}, "--out: --json is a flag, expected a value"},
           {{"run", "x", "y"}, "y: is one argument too many"}}) {
    const cli::Answer answer = cli::run(mistake.arguments);
    EXPECT_EQ(answer.exit_code, 2) << mistake.error;
    EXPECT_THAT(answer.err, HasSubstr(mistake.error));
  }
}

/// Returns what bash offers after `words` when its last one is being typed.
std::string completed(const std::string& script, const std::string& words) {
  const TempFolder folder;
  const auto file = folder.write("mosbench", script);
  const std::string command = fmt::format(
      "bash -c 'source {}; COMP_WORDS=({}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); _mosbench; "
      "echo ${{COMPREPLY[@]}}'",
      file.string(), words);
  std::string answer;
  FILE* pipe = popen(command.c_str(), "r");
  for (int c = 0; (c = std::fgetc(pipe)) != EOF;) answer += static_cast<char>(c);
  EXPECT_EQ(pclose(pipe), 0) << command;
  return answer;
}

TEST(Completion, OffersCommandsFlagsAndTheirValuesInBash) {
  const std::string script = cli::run({"help", "--completion", "bash"}).out;
  EXPECT_EQ(completed(script, "mosbench re"), "report render\n");
  EXPECT_EQ(completed(script, "mosbench lead"), "\n");
  EXPECT_EQ(completed(script, "mosbench run --pre"), "--preset\n");
  EXPECT_EQ(completed(script, "mosbench run DATA --preset doals-"), "doals-20m doals-120m\n");
  EXPECT_EQ(completed(script, "mosbench list me"), "methods\n");
  EXPECT_EQ(completed(script, "mosbench run DATA --write s"),
            "scores static-cloud static-cloud-pcd\n");
  EXPECT_EQ(completed(script, "mosbench odometry DATA --odometry ki"), "kiss\n");
  EXPECT_EQ(completed(script, "mosbench run --out d"), "\n");
}

TEST(Help, NamesAtMostSeventyFlags) {
  const std::string script = cli::run({"help", "--completion", "zsh"}).out;
  std::set<std::string> flags;
  for (std::size_t at = 0; (at = script.find("'--", at)) != std::string::npos; ++at) {
    flags.insert(script.substr(at + 1, script.find('[', at) - at - 1));
  }
  EXPECT_GT(flags.size(), 50U);
  EXPECT_LE(flags.size(), 70U) << testing::PrintToString(flags);
}

TEST(Completion, KnowsEveryCommandInZsh) {
  const std::string script = cli::run({"help", "--completion", "zsh"}).out;
  EXPECT_THAT(script, StartsWith("#compdef mosbench\n"));
  for (const Command& command : commands()) {
    EXPECT_THAT(script, HasSubstr(fmt::format("\n    {})\n      _arguments", command.name)));
  }
}

TEST(List, ShowsTheSettingsOfOneMethodWithUnits) {
  const cli::Answer one = cli::run({"list", "methods", "underwood"});
  EXPECT_EQ(one.exit_code, 0) << one.err;
  EXPECT_THAT(cli::run({"list", "methods"}).out, HasSubstr(one.out));
  EXPECT_THAT(one.out, ContainsRegex("neighbour_angle_rad +0.0157 +rad +0.002 to 0.5 "));
  EXPECT_THAT(one.out, Not(HasSubstr("dynablox")));
  const cli::Answer unknown = cli::run({"list", "methods", "underwod"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("(nearest: underwood)"));
  EXPECT_EQ(cli::run({"list", "presets", "underwood"}).exit_code, 2);
}

TEST(List, PrintsJson) {
  const auto all = nlohmann::json::parse(cli::run({"list", "--json"}).out);
  EXPECT_TRUE(all.contains("schema_version"));
  for (const char* what : {"datasets", "methods", "presets", "protocols", "scenes", "formats"}) {
    EXPECT_GT(all.at(what).size(), 2U) << what;
    auto part = nlohmann::json::parse(cli::run({"list", what, "--json"}).out);
    EXPECT_EQ(part.size(), 2U) << what << " and the version";
    EXPECT_EQ(part.at(what), all.at(what));
  }
  auto one = nlohmann::json::parse(cli::run({"list", "methods", "underwood", "--json"}).out);
  EXPECT_EQ(one.at("name"), "underwood");
  const auto angle = std::ranges::find_if(one.at("settings"), [](const nlohmann::json& setting) {
    return setting.at("name") == "neighbour_angle_rad";
  });
  ASSERT_NE(angle, one.at("settings").end());
  EXPECT_EQ(angle->at("default"), 0.0157);
  EXPECT_EQ(angle->at("unit"), "rad");
  EXPECT_EQ(angle->at("highest"), 0.5);
}

TEST(List, ShowsDatasetsPresetsProtocolsAndScenes) {
  const std::string all = cli::run({"list"}).out;
  std::string parts;
  for (const char* what : {"datasets", "presets", "protocols", "scenes", "formats"}) {
    const cli::Answer answer = cli::run({"list", what});
    EXPECT_EQ(answer.exit_code, 0) << what;
    EXPECT_THAT(all, HasSubstr(answer.out)) << what;
    parts += answer.out;
  }
  for (const char* name :
       {"DOI 10.3929/ethz-c-000788171", "velodyne/%06d.bin", "doals-20m", "doals-120m", "sipailou",
        "helimos-delayed", "semantickitti", "v1.0-{mini,trainval,test}/*.json", "KITTI-Road-MOS",
        "doals-hmm", "mapmos", "room"}) {
    EXPECT_THAT(parts, HasSubstr(name));
  }
}

TEST(Stdout, ThatIsFullOrClosedIsAnError) {
  const cli::Answer full =
      cli::run({"list"}, [] { dup2(open("/dev/full", O_WRONLY), STDOUT_FILENO); });
  EXPECT_EQ(full.exit_code, 3);
  EXPECT_THAT(full.err, HasSubstr("mosbench: stdout: cannot be written"));
  const cli::Answer closed = cli::run({"list"}, [] { close(STDOUT_FILENO); });
  EXPECT_EQ(closed.exit_code, 3);
  EXPECT_THAT(closed.err, HasSubstr("mosbench: stdout: is closed"));
}

}  // namespace
}  // namespace mosbench
