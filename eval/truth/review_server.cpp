#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <memory>
#include <mutex>
#include <random>
#include <thread>

#include "datasets/disk/claim.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/truth/film.hpp"
#include "eval/truth/review.hpp"
#include "eval/truth/truth_folder.hpp"

namespace mosbench {

std::string_view review_page();

namespace {

namespace fs = std::filesystem;
namespace http = boost::beast::http;
using boost::asio::ip::tcp;
using nlohmann::ordered_json;
using Request = http::request<http::string_body>;
using Response = http::response<http::string_body>;

/// A question that gets this status instead of an answer.
struct Refused {
  http::status status;
};

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
  }

  /// Browsers open connections ahead and leave them silent, so each has a thread of its own.
  [[noreturn]] void serve(const std::function<void(const std::string& address)>& ready) try {
    boost::asio::io_context context;
    tcp::acceptor acceptor(context, {boost::asio::ip::address_v4::loopback(), 0});
    ready(fmt::format("http://127.0.0.1:{}/?token={}", acceptor.local_endpoint().port(), token_));
    while (true) std::thread(&ReviewServer::answer, this, acceptor.accept()).detach();
  } catch (const boost::system::system_error& error) {
    throw DataError("127.0.0.1", error.what(), "a free port to serve the page on");
  }

 private:
  void answer(tcp::socket connection) {
    boost::system::error_code gone;  // whoever asked may have left
    boost::beast::flat_buffer buffer;
    Request request;
    http::read(connection, buffer, request, gone);
    if (gone) return;
    Response response = response_to(request);
    response.set(http::field::cache_control, "no-store");
    response.set("Referrer-Policy", "no-referrer");
    response.keep_alive(false);
    response.prepare_payload();
    http::write(connection, response, gone);
    connection.shutdown(tcp::socket::shutdown_send, gone);
  }

  Response response_to(const Request& request) {
    Response response{http::status::ok, request.version()};
    try {
      response.body() = body_for(request, response);
    } catch (const Refused& refused) {
      response.result(refused.status);
    } catch (const std::exception& error) {
      response.result(http::status::internal_server_error);
      response.set(http::field::content_type, "text/plain");
      response.body() = error.what();
    }
    return response;
  }

  /// What is asked without the token gets no answer, so other pages of the browser learn nothing.
  std::string body_for(const Request& request, Response& response) {
    const std::string target(request.target());
    if (request.method() == http::verb::get && target == "/?token=" + token_) {
      response.set(http::field::content_type, "text/html");
      return std::string(review_page());
    }
    if (request.method() != http::verb::post) throw Refused{http::status::forbidden};
    const ordered_json asked = parse_json(request.body(), "request");
    if (!asked.is_object() || asked.value("token", "") != token_) {
      throw Refused{http::status::forbidden};
    }
    response.set(http::field::content_type, "application/json");
    if (target == "/tracks") return state();
    if (target == "/film") return film(asked);
    if (target == "/decide") return decide(asked);
    if (target == "/make") return make(asked);
    throw Refused{http::status::not_found};
  }

  const TruthTrack& track_of(const ordered_json& asked) const {
    const auto track =
        std::ranges::find(truth_.tracks, asked.at("track").get<std::string>(), &TruthTrack::id);
    if (track == truth_.tracks.end()) throw Refused{http::status::not_found};
    return *track;
  }

  std::string film(const ordered_json& asked) {
    std::unique_lock guard(mutex_);
    const TruthTrack track = track_of(asked);
    const std::vector<MadeTrack> made = truth_.made;
    guard.unlock();  // reading scans takes its time
    const std::size_t wider = std::clamp<std::size_t>(asked.value("wider", 1U), 1, 16);
    return film_of(*scans_.at(track.sequence), made, track, wider).dump();
  }

  std::string state() {
    const std::lock_guard guard(mutex_);
    ordered_json tracks = ordered_json::array();
    for (const TruthTrack& track : truth_.tracks) {
      ordered_json& told = tracks.emplace_back();
      told = {{"id", track.id()},       {"sequence", track.sequence},
              {"number", track.number}, {"guess", track.moves ? "moving" : "static"},
              {"points", track.points}, {"scans", {track.first_scan, track.last_scan}},
              {"doubt", track.doubt},   {"decided", nullptr}};
      const auto decided = truth_.decided.find(track.id());
      if (decided == truth_.decided.end()) continue;
      told["decided"] = kDecidedNames[static_cast<std::size_t>(decided->second)];
    }
    return ordered_json{{"left", left_text(truth_.undecided())}, {"tracks", std::move(tracks)}}
        .dump();
  }

  std::string decide(const ordered_json& asked) {
    const auto decided = std::ranges::find(kDecidedNames, asked.at("decided").get<std::string>());
    if (decided == kDecidedNames.end() || *decided == "made") {
      throw Refused{http::status::bad_request};
    }
    {
      const std::lock_guard guard(mutex_);
      truth_.decide(std::vector<Decision>{
          {track_of(asked).id(), static_cast<Decided>(decided - kDecidedNames.begin())}});
    }
    return state();
  }

  /// Cuts, splits, merges or paints; tells also which track it made.
  std::string make(const ordered_json& asked) {
    const std::lock_guard guard(mutex_);
    const auto scans = scans_.find(asked.at("sequence").get<std::string>());
    if (scans == scans_.end()) throw Refused{http::status::not_found};
    const TrackEdit edit = with_points(edit_from(asked), *scans->second, truth_.made);
    return ordered_json{{"made", truth_.make(scans->first, edit).id()}}.dump();
  }

  FolderLock lock_;  // a second server would not know of the decisions of this one
  TruthFolder truth_;
  std::map<std::string, std::unique_ptr<ResultScans>> scans_;
  std::mutex mutex_;  // of the decisions
  const std::string token_ = random_token();
};

}  // namespace

void serve_review(const fs::path& folder, const std::optional<fs::path>& data,
                  const std::function<void(const std::string& address)>& ready) {
  ReviewServer(folder, data).serve(ready);
}

}  // namespace mosbench
