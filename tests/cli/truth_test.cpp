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
  decide(box(), "unsure");
  ASSERT_EQ(write().exit_code, 0);
  std::filesystem::remove_all(folder_ / "room/labels");
  std::filesystem::rename(folder_ / "own/room/labels", folder_ / "room/labels");
  // The run calls the box moving: that may be all wrong, or all right.
  const std::string open = "unsure points leave 0.0 to 100.0 % IoU open, by mapmos";
  for (const char* as : {"text", "json"}) {
    const cli::Answer again =
        cli::run({"score", (folder_ / "room").string(), "--predictions", (folder_ / "run").string(),
                  "--protocol", "mapmos", "--as", as});
    EXPECT_THAT(again.out, HasSubstr(open)) << again.err;
  }
  const cli::Answer rerun =
      cli::run({"run", (folder_ / "room").string(), "--preset", "offline", "--protocol", "mapmos",
                "--out", (folder_ / "rerun").string()});
  EXPECT_THAT(rerun.out, HasSubstr(open)) << rerun.err;
  EXPECT_THAT(cli::run({"rank", (folder_ / "rerun").string()}).out, HasSubstr(open));
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
  const std::string& token() const { return token_; }

  /// Returns the answer to a request, with its head.
  std::string ask(const std::string& method, const std::string& target,
                  const std::string& body = "") const {
    const int connection = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port_);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    std::string answer;
    if (connect(connection, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0) {
      const std::string request =
          method + ' ' + target +
          " HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: " + std::to_string(body.size()) +
          "\r\n\r\n" + body;
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
    return post("/decide", {{"track", track}, {"decided", decided}});
  }
  std::string post(const std::string& target, nlohmann::json asked) const {
    asked["token"] = token_;
    return ask("POST", target, asked.dump());
  }
  nlohmann::json get(const std::string& target, const nlohmann::json& asked) const {
    const std::string answer = post(target, asked);
    return nlohmann::json::parse(answer.substr(answer.find("\r\n\r\n") + 4));
  }

 private:
  pid_t child_;
  std::uint16_t port_ = 0;
  std::string token_;
};

TEST_F(Truth, ReviewStoresEachDecisionAtOnce) {
  const TempFolder streams, others;
  std::optional<ReviewServer> server;
  server.emplace(truth(), streams);
  ASSERT_EQ(server->token().size(), 32U);
  EXPECT_THAT(server->ask("GET", "/?token=" + server->token()), HasSubstr("<title>mosbench truth"));
  const std::string track = box();
  const auto film = server->get("/film", {{"track", track}});
  ASSERT_FALSE(film.at("frames").empty());
  EXPECT_FALSE(film.at("frames").at(10).at("track").empty());
  EXPECT_FALSE(film.at("frames").at(10).at("around").empty());
  EXPECT_THAT(server->decide(track, "static"), HasSubstr(" 200 "));
  EXPECT_THAT(server->decide(track, "moving"), HasSubstr(" 200 ")) << "of another page";
  server->kill_now();
  EXPECT_THAT(cli::run({"truth", "status", truth()}).out, HasSubstr("1 of them decided"));
  EXPECT_THAT(read_file(folder_ / "truth/decisions.json"), HasSubstr("static"));
  server.emplace(truth(), others);
  const nlohmann::json stored = server->get("/tracks", nlohmann::json::object());
  for (const auto& told : stored.at("tracks")) {
    if (told.at("id") != track) continue;
    EXPECT_EQ(told.at("decided"), "moving") << "the last one wins";
  }
  EXPECT_THAT(server->decide(track, "taken-back"), HasSubstr("\"decided\":null"));
  const cli::Answer second = cli::run({"truth", "review", truth()});
  EXPECT_EQ(second.exit_code, 2) << "one server at a time";
}

TEST_F(Truth, ReviewCutsMergesAndPaintsTracks) {
  const TempFolder streams;
  const ReviewServer server(truth(), streams);
  const std::string whole = box(), number = whole.substr(5);
  const std::size_t moving = (write(), of_box(kMovingLabel));
  const auto make = [&](const std::string& takes, nlohmann::json scans, nlohmann::json corners) {
    return server.get("/make", {{"sequence", "room"},
                                {"takes", {{takes, 0}}},
                                {"scans", std::move(scans)},
                                {"corners_m", std::move(corners)}});
  };
  const std::string later = make(number, {13, 4294967295}, nlohmann::json::array()).at("made");
  server.decide(later, "static");
  ASSERT_EQ(write().exit_code, 0);
  const std::size_t before = of_box(kMovingLabel);
  EXPECT_GT(before, moving / 4);
  EXPECT_LT(before, 3 * moving / 4);
  EXPECT_THAT(written(5), testing::Contains(kMovingLabel));
  EXPECT_THAT(written(13), testing::Not(testing::Contains(kMovingLabel)));
  EXPECT_THAT(cli::run({"truth", "status", truth()}).out, HasSubstr("1 of them decided"));
  const auto film = server.get("/film", {{"track", later}});
  EXPECT_FALSE(film.at("frames").front().at("others").at(number).empty()) << "the earlier part";
  EXPECT_GT(server.get("/film", {{"track", later}, {"wider", 2}}).at("half_cm"),
            film.at("half_cm"));
  // Paint of all the room in one scan: walls, and not the floor, which is most of it.
  const auto corners = nlohmann::json::parse("[[-90, -90], [90, -90], [90, 90], [-90, 90]]");
  const std::string painted = make("0", {20, 20}, corners).at("made");
  server.decide(painted, "moving");
  ASSERT_EQ(write().exit_code, 0);
  EXPECT_EQ(std::ranges::count(written(19), kMovingLabel), 0);
  EXPECT_GT(std::ranges::count(written(20), kMovingLabel), 0);
  EXPECT_GT(std::ranges::count(written(20), kStaticLabel), 0);
  EXPECT_THAT(server.decide(later, "unmade"), HasSubstr("unmakes"));
  EXPECT_THAT(server.decide(painted, "unmade"), HasSubstr(" 200 "));
  EXPECT_THAT(server.decide(later, "unmade"), HasSubstr(" 200 "));
  ASSERT_EQ(write().exit_code, 0);
  EXPECT_EQ(of_box(kMovingLabel), moving) << "as if nothing had been made";
  EXPECT_THAT(server.decide(later, "moving"), HasSubstr(" 404 "));
  EXPECT_THAT(server.decide(whole, "made"), HasSubstr(" 400 "));
  const nlohmann::json far = {
      {"sequence", "room"}, {"takes", {{number, 0}}}, {"corners_m", nlohmann::json::array()}};
  nlohmann::json beyond = far;
  beyond["scans"] = {900, 901};
  EXPECT_THAT(server.post("/make", beyond), HasSubstr("request: holds no points"));
  EXPECT_THAT(server.post("/make", far), HasSubstr(" 500 "));
}

TEST_F(Truth, ReviewAnswersNobodyWithoutTheToken) {
  const TempFolder streams;
  const ReviewServer server(truth(), streams);
  for (const char* target : {"/", "/tracks", "/?token=0", "/film"}) {
    EXPECT_THAT(server.ask("GET", target), HasSubstr(" 403 ")) << target;
    EXPECT_THAT(server.ask("POST", target, R"({"token": "0"})"), HasSubstr(" 403 ")) << target;
    EXPECT_THAT(server.ask("POST", target, "[]"), HasSubstr(" 403 ")) << target;
  }
  const nlohmann::json decision = {{"track", box()}, {"decided", "moving"}};
  EXPECT_THAT(server.ask("POST", "/decide", decision.dump()), HasSubstr(" 403 "));
  EXPECT_THAT(server.ask("POST", "/decide", "{"), HasSubstr("request: is no JSON"));
  EXPECT_THAT(server.decide(box(), "maybe"), HasSubstr(" 400 "));
  EXPECT_THAT(server.decide("room/99999", "moving"), HasSubstr(" 404 "));
  EXPECT_FALSE(is_there(folder_ / "truth/decisions.json"));
}

}  // namespace
}  // namespace mosbench
