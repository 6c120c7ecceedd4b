#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <optional>

#include "datasets/disk/files.hpp"
#include "datasets/formats/label_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

class Truth : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    made_ = new TempFolder;
    cli::write_small_sequence(*made_ / "room", kScans);
    std::filesystem::rename(*made_ / "room/labels", *made_ / "true_labels");
    proposed_ = new cli::Answer(cli::run(
        {"truth", "propose", (*made_ / "room").string(), "-o", (*made_ / "truth").string()}));
  }
  static void TearDownTestSuite() {
    delete proposed_;
    delete made_;
  }
  void SetUp() override {
    ASSERT_EQ(proposed_->exit_code, 0) << proposed_->err;
    std::filesystem::copy(*made_ / "truth", folder_ / "truth",
                          std::filesystem::copy_options::recursive);
  }

  static constexpr std::size_t kScans = 26;
  std::string truth() const { return (folder_ / "truth").string(); }
  std::string room() const { return (*made_ / "room").string(); }

  nlohmann::json tracks() const {
    return nlohmann::json::parse(read_file(folder_ / "truth/tracks.json")).at("tracks");
  }
  /// The track of the box that crosses the room.
  std::string box() const {
    const nlohmann::json all = tracks();
    const auto most = std::ranges::max_element(
        all, {}, [](const nlohmann::json& track) { return track.at("points").get<int>(); });
    return "room/" + std::to_string(most->at("number").get<int>());
  }
  void decide(const std::string& track, const std::string& decided) const {
    write_file_atomic(folder_ / "truth/decisions.json",
                      R"({"format": 1, "decisions": [{"track": ")" + track + R"(", "decided": ")" +
                          decided + "\"}]}");
  }
  cli::Answer write() const {
    return cli::run({"truth", "write", truth(), "--out", (folder_ / "own").string()});
  }
  std::vector<std::uint32_t> written(std::size_t scan) const {
    return read_labels(folder_ / "own/room/labels" / (cli::stem(scan) + ".label"),
                       cli::kPointsPerScan);
  }
  /// Returns how many points of the box have this label.
  std::size_t of_box(std::uint32_t label) const {
    std::size_t points = 0;
    for (std::size_t k = 0; k < kScans; ++k) {
      const auto labels = written(k);
      const auto truth =
          read_labels(*made_ / "true_labels" / (cli::stem(k) + ".label"), cli::kPointsPerScan);
      for (std::size_t i = 0; i < labels.size(); ++i) {
        if (truth[i] == kMovingLabel && labels[i] == label) ++points;
      }
    }
    return points;
  }

  static inline TempFolder* made_ = nullptr;
  static inline cli::Answer* proposed_ = nullptr;
  TempFolder folder_;
};

TEST_F(Truth, ProposesTracksAndSaysWhatIsLeft) {
  EXPECT_THAT(proposed_->out, HasSubstr("0 of them decided"));
  EXPECT_THAT(proposed_->out, HasSubstr("moving"));
  ASSERT_FALSE(tracks().empty());
  const cli::Answer status = cli::run({"truth", "status", truth()});
  EXPECT_EQ(status.exit_code, 0) << status.err;
  EXPECT_EQ(status.out, proposed_->out);
}

TEST_F(Truth, WritesLabelsBeforeAnyDecisionThatScoreTakes) {
  const cli::Answer answer = write();
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("0 decisions; labels in"));
  const std::size_t found = of_box(kMovingLabel);
  EXPECT_GT(found, 5000U);
  // The real truth beside the scans scores them as labels of any method.
  cli::write_small_sequence(folder_ / "room", kScans);
  const cli::Answer score =
      cli::run({"score", (folder_ / "room").string(), "--predictions", (folder_ / "own").string(),
                "--protocol", "mapmos", "--json"});
  ASSERT_EQ(score.exit_code, 0) << score.err;
  EXPECT_EQ(nlohmann::json::parse(score.out).at("sequences").at(0).at("summary").at("tp"), found);
}

TEST_F(Truth, HeedsDecisionsAndSaysWhereLabelsComeFrom) {
  decide(box(), "static");
  EXPECT_EQ(write().exit_code, 0);
  EXPECT_EQ(of_box(kMovingLabel), 0U);
  decide(box(), "unsure");
  const cli::Answer answer = write();
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("1 decision; labels in"));
  EXPECT_EQ(of_box(kMovingLabel), 0U);
  EXPECT_GT(of_box(0), 0U);
  const auto note = nlohmann::json::parse(read_file(folder_ / "own/room/labels/truth.json"));
  EXPECT_EQ(note.at("points").at("all"), kScans * cli::kPointsPerScan);
  EXPECT_GT(note.at("points").at("by_hand"), 0);
  EXPECT_EQ(note.at("decided").at(0).at("decided"), "unsure");
}

TEST_F(Truth, EstimatesTheIouOfLabelsFromDecisions) {
  const std::string run = (folder_ / "run").string();
  ASSERT_EQ(cli::run({"run", room(), "--method", "hmm-mos-plus", "--out", run}).exit_code, 0);
  const auto status = [&] { return cli::run({"truth", "status", truth(), run}); };
  EXPECT_THAT(status().out, testing::Not(HasSubstr("estimated"))) << "nothing is decided";
  nlohmann::json decisions = nlohmann::json::array();
  for (const nlohmann::json& track : tracks()) {
    const std::string id = "room/" + std::to_string(track.at("number").get<int>());
    decisions.push_back({{"track", id}, {"decided", id == box() ? "moving" : "static"}});
  }
  write_file_atomic(folder_ / "truth/decisions.json",
                    nlohmann::json{{"format", 1}, {"decisions", decisions}}.dump());
  EXPECT_THAT(status().out, HasSubstr("IoU if every track were decided, estimated"));
  const nlohmann::json answer =
      nlohmann::json::parse(cli::run({"truth", "status", truth(), run, "--json"}).out);
  const nlohmann::json rows = answer.at("sheets").at(1).at("rows");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].at("labels"), "as written now");
  EXPECT_EQ(rows[0].at("iou").at("value"), 1);

  // With every track decided it is what `score` says against the labels that are written.
  ASSERT_EQ(write().exit_code, 0);
  cli::write_small_sequence(folder_ / "room", kScans);
  std::filesystem::remove_all(folder_ / "room/labels");
  std::filesystem::copy(folder_ / "own/room/labels", folder_ / "room/labels");
  const cli::Answer score = cli::run({"score", (folder_ / "room").string(), "--predictions", run,
                                      "--protocol", "mapmos", "--json"});
  ASSERT_EQ(score.exit_code, 0) << score.err;
  const nlohmann::json scored =
      nlohmann::json::parse(score.out).at("sequences").at(0).at("summary").at("iou");
  EXPECT_NEAR(rows[1].at("iou").at("value"), scored.get<double>(), 1e-12);
  EXPECT_EQ(rows[1].at("iou").at("low"), rows[1].at("iou").at("high"));
}

TEST_F(Truth, EstimatesNothingOfOtherResults) {
  decide(box(), "moving");
  cli::write_small_sequence(folder_ / "room", 12);
  const std::string run = (folder_ / "run").string();
  ASSERT_EQ(cli::run({"run", (folder_ / "room").string(), "--out", run}).exit_code, 0);
  const cli::Answer other = cli::run({"truth", "status", truth(), run});
  EXPECT_EQ(other.exit_code, 3);
  EXPECT_THAT(other.err, HasSubstr("is of 12 scans, expected the 26 of "));
  const cli::Answer review = cli::run({"truth", "write", truth(), run});
  EXPECT_EQ(review.exit_code, 2);
  EXPECT_THAT(review.err, HasSubstr("RESULTS: are nothing for truth write"));
}

TEST_F(Truth, TellsDecisionsAgainstTheLooks) {
  auto list = nlohmann::ordered_json::parse(read_file(folder_ / "truth/tracks.json"));
  const std::string track = box();
  for (auto& told : list["tracks"]) told["doubt"] = 0.25;
  const auto status = [&] {
    write_file_atomic(folder_ / "truth/tracks.json", list.dump());
    return cli::run({"truth", "status", truth()}).out;
  };
  const std::string said = track + " is decided static, but 90 % of the looks at it say moving";
  decide(track, "static");
  EXPECT_THAT(status(), testing::Not(HasSubstr("look again")));
  for (auto& told : list["tracks"]) told["doubt"] = 0.1;
  EXPECT_THAT(status(), HasSubstr(said));
  decide(track, "moving");
  EXPECT_THAT(status(), testing::Not(HasSubstr("look again")));
}

TEST_F(Truth, IsTruthOfTheDriveForRunAndScore) {
  decide(box(), "moving");
  ASSERT_EQ(write().exit_code, 0);
  std::filesystem::copy(room(), folder_ / "room", std::filesystem::copy_options::recursive);
  std::filesystem::rename(folder_ / "own/room/labels", folder_ / "room/labels");
  const cli::Answer run = cli::run({"run", (folder_ / "room").string(), "--preset", "offline",
                                    "--out", (folder_ / "run").string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("truth: 1 decision, 0.0 % unsure"));
  const cli::Answer score =
      cli::run({"score", (folder_ / "room").string(), "--predictions", (folder_ / "run").string()});
  EXPECT_THAT(score.out, HasSubstr("truth: 1 decision, 0.0 % unsure"));
  write_file_atomic(folder_ / "room/labels/truth.json", "{}");
  const cli::Answer broken = cli::run({"convert", (folder_ / "room").string(), "--check"});
  EXPECT_EQ(broken.exit_code, 3);
  EXPECT_THAT(broken.err, HasSubstr("truth.json: has no \"doubt\", expected the file as "
                                    "`mosbench truth write` wrote it"));
}

TEST_F(Truth, KeepsDecisionsWhenProposedAgain) {
  decide(box(), "moving");
  const auto again = [&] { return cli::run({"truth", "propose", room(), "-o", truth()}); };
  const std::string before = read_file(folder_ / "truth/decisions.json");
  const cli::Answer kept = again();
  EXPECT_EQ(kept.exit_code, 0) << kept.err;
  EXPECT_THAT(kept.out, HasSubstr("1 of them decided"));
  EXPECT_EQ(read_file(folder_ / "truth/decisions.json"), before);
  std::filesystem::remove(folder_ / "truth/room/objects/000003.object");
  const cli::Answer lost = again();
  EXPECT_EQ(lost.exit_code, 2);
  EXPECT_THAT(lost.err, HasSubstr("holds 1 decision on tracks whose files are not there any more"));
  EXPECT_EQ(read_file(folder_ / "truth/decisions.json"), before);
  std::filesystem::remove(folder_ / "truth/decisions.json");
  EXPECT_EQ(again().exit_code, 0) << "without decisions nothing is lost";
}

TEST_F(Truth, RefusesOtherDataAndLabelsOfOthers) {
  cli::write_small_sequence(folder_ / "other/room", kScans, 3);
  const cli::Answer other =
      cli::run({"truth", "write", truth(), "--out", (folder_ / "own").string(), "--data",
                (folder_ / "other").string()});
  EXPECT_EQ(other.exit_code, 3);
  EXPECT_THAT(other.err, HasSubstr("was made from other scans, poses or labels"));
  EXPECT_FALSE(is_there(folder_ / "own/room/labels"));
  write_file_atomic(folder_ / "own/room/labels/000000.label", "mine");
  const cli::Answer replaced = write();
  EXPECT_EQ(replaced.exit_code, 2);
  EXPECT_THAT(replaced.err, HasSubstr("holds labels that `mosbench truth` did not write"));
  EXPECT_EQ(read_file(folder_ / "own/room/labels/000000.label"), "mine");
}

TEST_F(Truth, NamesWhatIsWrong) {
  decide("room/99999", "moving");
  const cli::Answer unknown = cli::run({"truth", "status", truth()});
  EXPECT_EQ(unknown.exit_code, 3);
  EXPECT_THAT(unknown.err,
              HasSubstr("decisions.json: decides on \"room/99999\", expected a track"));
  const cli::Answer none = cli::run({"truth", "status", room()});
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_THAT(none.err, HasSubstr("has no tracks.json, expected a folder that `mosbench truth"));
  const cli::Answer flag = cli::run({"truth", "status", truth(), "--scans", "1:2"});
  EXPECT_EQ(flag.exit_code, 2);
  EXPECT_THAT(flag.err, HasSubstr("--scans 1:2: is nothing for truth status"));
  EXPECT_EQ(cli::run({"truth", "propose", room()}).exit_code, 2);
  EXPECT_EQ(cli::run({"truth", "write", truth()}).exit_code, 2);
}

/// The server of a page, until it is killed.
class ReviewServer {
 public:
  ReviewServer(const std::string& truth, const TempFolder& folder)
      : child_(cli::start({"truth", "review", truth}, folder.path())) {
    const std::string before = "open http://127.0.0.1:";
    for (int tries = 0; tries < 600 && port_ == 0; ++tries) {
      usleep(50'000);
      const std::string told = read_file(folder / "stderr.txt");
      const std::size_t at = told.find(before), token = told.find("/?token=");
      lacks_library_ = told.find("lacks cpp-httplib") != told.npos;
      if (lacks_library_) return;
      if (at == told.npos || token == told.npos || told.find(' ', token) == told.npos) continue;
      port_ = static_cast<std::uint16_t>(std::stoi(told.substr(at + before.size())));
      token_ = told.substr(token + 8, told.find(' ', token) - token - 8);
    }
  }
  ~ReviewServer() { kill_now(); }
  void kill_now() {
    if (child_ <= 0) return;
    kill(child_, SIGKILL);
    cli::wait_for(child_);
    child_ = 0;
  }
  bool lacks_library() const { return lacks_library_; }
  const std::string& token() const { return token_; }

  /// Returns the answer to a request, with its head.
  std::string ask(const std::string& method, const std::string& target) const {
    const int connection = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port_);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    std::string answer;
    if (connect(connection, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0) {
      const std::string request = method + ' ' + target +
                                  " HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 0\r\n"
                                  "Connection: close\r\n\r\n";
      send(connection, request.data(), request.size(), 0);
      char bytes[4096];
      for (ssize_t got = 0; (got = recv(connection, bytes, sizeof(bytes), 0)) > 0;) {
        answer.append(bytes, static_cast<std::size_t>(got));
      }
    }
    close(connection);
    return answer;
  }
  std::string decide(const std::string& track, const std::string& decided) const {
    return ask("POST", "/decide?track=" + track + "&decided=" + decided + "&token=" + token_);
  }
  nlohmann::json get(const std::string& target) const {
    const std::string answer = ask("GET", target + "token=" + token_);
    return nlohmann::json::parse(answer.substr(answer.find("\r\n\r\n") + 4));
  }

 private:
  pid_t child_;
  std::uint16_t port_ = 0;
  bool lacks_library_ = false;
  std::string token_;
};

TEST_F(Truth, ReviewStoresEachDecisionAtOnce) {
  const TempFolder streams, others;
  std::optional<ReviewServer> server;
  server.emplace(truth(), streams);
  if (server->lacks_library()) GTEST_SKIP() << "this build is without cpp-httplib";
  ASSERT_EQ(server->token().size(), 32U);
  EXPECT_THAT(server->ask("GET", "/?token=" + server->token()), HasSubstr("<title>mosbench truth"));
  const std::string track = box();
  const auto film = server->get("/film?track=" + track + "&");
  ASSERT_FALSE(film.at("frames").empty());
  EXPECT_FALSE(film.at("frames").at(10).at("track").empty());
  EXPECT_FALSE(film.at("frames").at(10).at("around").empty());
  EXPECT_THAT(server->decide(track, "static"), HasSubstr(" 200 "));
  EXPECT_THAT(server->decide(track, "moving"), HasSubstr(" 200 ")) << "of another page";
  server->kill_now();
  EXPECT_THAT(cli::run({"truth", "status", truth()}).out, HasSubstr("1 of them decided"));
  EXPECT_THAT(read_file(folder_ / "truth/decisions.json"), HasSubstr("static"));
  server.emplace(truth(), others);
  const nlohmann::json stored = server->get("/tracks?");
  for (const auto& told : stored.at("tracks")) {
    if (told.at("id") != track) continue;
    EXPECT_EQ(told.at("decided"), "moving") << "the last one wins";
  }
  EXPECT_THAT(server->decide(track, "taken-back"), HasSubstr("\"decided\":null"));
  const cli::Answer second = cli::run({"truth", "review", truth()});
  EXPECT_EQ(second.exit_code, 2) << "one server at a time";
}

TEST_F(Truth, ReviewAnswersNobodyWithoutTheToken) {
  const TempFolder streams;
  const ReviewServer server(truth(), streams);
  if (server.lacks_library()) GTEST_SKIP() << "this build is without cpp-httplib";
  for (const char* target : {"/", "/tracks", "/?token=0", "/film?track=room/1"}) {
    EXPECT_THAT(server.ask("GET", target), HasSubstr(" 403 ")) << target;
  }
  EXPECT_THAT(server.ask("POST", "/decide?track=" + box() + "&decided=moving"), HasSubstr(" 403 "));
  EXPECT_THAT(server.decide(box(), "maybe"), HasSubstr(" 400 "));
  EXPECT_THAT(server.decide("room/99999", "moving"), HasSubstr(" 404 "));
  EXPECT_FALSE(is_there(folder_ / "truth/decisions.json"));
}

}  // namespace
}  // namespace mosbench
