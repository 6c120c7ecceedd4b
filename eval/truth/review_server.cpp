#include <fmt/format.h>
#include <httplib.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <random>

#include "datasets/disk/claim.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/truth/film.hpp"
#include "eval/truth/review.hpp"
#include "eval/truth/truth_folder.hpp"

namespace mosbench {

std::string_view review_page();

namespace {

namespace fs = std::filesystem;
using httplib::Request;
using httplib::Response;

constexpr const char* kHost = "127.0.0.1";
constexpr const char* kJson = "application/json";

std::string random_token() {
  std::random_device random;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", random());
  return token;
}

class ReviewServer {
 public:
  ReviewServer(const fs::path& folder, const std::optional<fs::path>& data)
      : lock_(folder), truth_(open_truth(folder)) {
    for (const Result& run : truth_.runs) {
      scans_[run.sequence.text()] = std::make_unique<ResultScans>(run, data);
    }
    // What is asked without the token gets no answer, so other pages of the browser learn nothing.
    server_.set_pre_routing_handler([this](const Request& request, Response& response) {
      response.set_header("Cache-Control", "no-store");
      response.set_header("Referrer-Policy", "no-referrer");
      if (request.get_param_value("token") == token_) {
        return httplib::Server::HandlerResponse::Unhandled;
      }
      response.status = 403;
      return httplib::Server::HandlerResponse::Handled;
    });
    server_.set_exception_handler(
        [](const Request&, Response& response, std::exception_ptr thrown) {
          response.status = 500;
          try {
            std::rethrow_exception(thrown);
          } catch (const std::exception& error) {
            response.set_content(error.what(), "text/plain");
          }
        });
    server_.Get("/", [](const Request&, Response& response) {
      response.set_content(std::string(review_page()), "text/html");
    });
    server_.Get("/tracks", [this](const Request&, Response& response) { tell_tracks(response); });
    server_.Get("/film", [this](const Request& request, Response& response) {
      const TruthTrack* track = track_of(request, response);
      if (track == nullptr) return;
      response.set_content(film_of(*scans_.at(track->sequence), *track).dump(), kJson);
    });
    server_.Post("/decide",
                 [this](const Request& request, Response& response) { decide(request, response); });
  }

  void serve(const std::function<void(const std::string& address)>& ready) {
    const int port = server_.bind_to_any_port(kHost);
    if (port < 0) throw DataError("127.0.0.1", "has no free port", "one to serve the page on");
    ready(fmt::format("http://{}:{}/?token={}", kHost, port, token_));
    server_.listen_after_bind();
  }

 private:
  const TruthTrack* track_of(const Request& request, Response& response) const {
    const auto track =
        std::ranges::find(truth_.tracks, request.get_param_value("track"), &TruthTrack::id);
    if (track != truth_.tracks.end()) return &*track;
    response.status = 404;
    return nullptr;
  }

  void tell_tracks(Response& response) {
    const std::lock_guard guard(mutex_);
    nlohmann::ordered_json tracks = nlohmann::ordered_json::array();
    for (const TruthTrack& track : truth_.tracks) {
      nlohmann::ordered_json& told = tracks.emplace_back();
      told = {{"id", track.id()},       {"guess", track.moves ? "moving" : "static"},
              {"points", track.points}, {"scans", track.scans},
              {"doubt", track.doubt},   {"decided", nullptr}};
      const auto decided = truth_.decided.find(track.id());
      if (decided == truth_.decided.end()) continue;
      told["decided"] = kDecidedNames[static_cast<std::size_t>(decided->second)];
    }
    const nlohmann::ordered_json all = {{"left", left_text(truth_.undecided())},
                                        {"tracks", std::move(tracks)}};
    response.set_content(all.dump(), kJson);
  }

  void decide(const Request& request, Response& response) {
    const TruthTrack* track = track_of(request, response);
    if (track == nullptr) return;
    const auto decided = std::ranges::find(kDecidedNames, request.get_param_value("decided"));
    if (decided == kDecidedNames.end()) {
      response.status = 400;
      return;
    }
    {
      const std::lock_guard guard(mutex_);
      truth_.decide({track->id(), static_cast<Decided>(decided - kDecidedNames.begin())});
    }
    tell_tracks(response);
  }

  FolderLock lock_;  // a second server would not know of the decisions of this one
  TruthFolder truth_;
  std::map<std::string, std::unique_ptr<ResultScans>> scans_;
  std::mutex mutex_;  // of the decisions
  std::string token_ = random_token();
  httplib::Server server_;
};

}  // namespace

void serve_review(const fs::path& folder, const std::optional<fs::path>& data,
                  const std::function<void(const std::string& address)>& ready) {
  ReviewServer(folder, data).serve(ready);
}

}  // namespace mosbench
