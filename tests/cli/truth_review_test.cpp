#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <optional>

#include "tests/cli/truth_of_room.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

class TruthReview : public TruthOfRoom {};

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

TEST_F(TruthReview, StoresEachDecisionAtOnce) {
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

TEST_F(TruthReview, CutsMergesAndPaintsTracks) {
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

TEST_F(TruthReview, AnswersNobodyWithoutTheToken) {
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
