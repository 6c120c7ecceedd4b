#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SequenceNames : public testing::Test {
 protected:
  SequenceNames() {
    cli::write_small_sequence(data() / "sequences/08", 6);
    const cli::Answer run = cli::run({"run", data(), "--out", out()});
    if (run.exit_code != 0) throw std::runtime_error(run.err);
  }
  fs::path data() const { return folder_ / "data"; }
  fs::path out() const { return folder_ / "out"; }

  /// Puts the result of 08 into another folder under another name.
  fs::path put_result(const fs::path& folder, const std::string& name) const {
    auto content = nlohmann::ordered_json::parse(read_file(out() / "08/result.json"));
    content["sequence"] = name;
    write_file_atomic(folder / "result.json", content.dump());
    return folder / "result.json";
  }

  TempFolder folder_;
};

TEST_F(SequenceNames, ThatResultsUseThemselvesAreRefusedByRun) {
  for (const std::string name : {"labels", "reasons", "08.partial", "08.replaced", "result.json"}) {
    fs::copy(data() / "sequences/08", data() / "sequences" / name, fs::copy_options::recursive);
    const auto before = cli::contents(out());
    const cli::Answer answer = cli::run({"run", data(), "--out", out()});
    EXPECT_EQ(answer.exit_code, 3) << name;
    EXPECT_THAT(answer.err,
                HasSubstr("names the sequence \"" + name + "\", expected another name"));
    EXPECT_EQ(cli::contents(out()), before);
    // The others can still be run.
    EXPECT_EQ(cli::run({"run", data(), "--out", out(), "--sequences", "08"}).exit_code, 0);
    fs::remove_all(data() / "sequences" / name);
  }
}

TEST_F(SequenceNames, ThatResultsUseThemselvesAreNotLeftOutOfNumbers) {
  for (const std::string name : {"labels", "reasons", "08.partial", "08.replaced"}) {
    const fs::path file = put_result(out() / name, name);
    for (const std::vector<std::string>& command :
         std::vector<std::vector<std::string>>{{"stats", out()},
                                               {"compare", out(), out()},
                                               {"bless", out(), folder_ / "baseline"},
                                               {"report", out(), "-o", folder_ / "r.html"},
                                               {"table", "II", out()},
                                               {"diff", out(), out()}}) {
      const cli::Answer answer = cli::run(command);
      EXPECT_EQ(answer.exit_code, 3) << command.front() << ' ' << answer.out;
      EXPECT_THAT(answer.err, HasSubstr(file.string() + ": names the sequence")) << command.front();
    }
    fs::remove_all(out() / name);
  }
  // A run's result in a folder called like that counts.
  fs::rename(out() / "08", out() / "labels");
  const cli::Answer stats = cli::run({"stats", out()});
  EXPECT_EQ(stats.exit_code, 0) << stats.err;
}

TEST_F(SequenceNames, OfKilledRunsAreStillPassedOver) {
  put_result(out() / "09.partial", "09");
  put_result(out() / "08.replaced", "08");
  const cli::Answer answer = cli::run({"stats", out(), "--csv"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(std::count(answer.out.begin(), answer.out.end(), '\n'), 1 + 6);
}

TEST_F(SequenceNames, NeverLeadOutOfABaseline) {
  const fs::path stranger = folder_ / "stranger";
  for (const std::string& name : {std::string("../../escaped"), (folder_ / "escaped").string()}) {
    put_result(stranger, name);
    const cli::Answer answer = cli::run({"bless", stranger, folder_ / "a/b/baseline"});
    EXPECT_EQ(answer.exit_code, 3);
    EXPECT_THAT(answer.err, HasSubstr("names the sequence"));
    EXPECT_FALSE(fs::exists(folder_ / "a"));
    EXPECT_FALSE(fs::exists(folder_ / "escaped"));
  }
}

}  // namespace
}  // namespace mosbench
