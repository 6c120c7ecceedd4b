#include "eval/exec/exec_method.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <list>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "datasets/formats/point_range.hpp"
#include "eval/exec/child_process.hpp"
#include "eval/exec/pipe_messages.hpp"

namespace mosbench {
namespace {

/// A scan until the program gets it.
struct WaitingScan : Observed {
  WaitingScan(std::span<const Point> all, const Pose& pose)
      : points(all.begin(), all.end()), map_from_sensor(pose) {}
  std::vector<Point> points;
  Pose map_from_sensor;
};

/// The settings of the program as one JSON object; empty where it has none. Whole numbers have no
/// decimals, as a program may count with them.
std::string own_settings(const Settings& settings) {
  nlohmann::ordered_json json;
  for (const Setting& setting : settings.all()) {
    if (setting.name == kTimeout_s) continue;
    nlohmann::ordered_json& value = json[std::string(setting.name)];
    if (const auto* text = std::get_if<std::string>(&setting.value)) {
      value = *text;
      continue;
    }
    constexpr double kMostExact = 9007199254740992.0;
    const double number = settings.number(setting.name);
    const bool is_whole = number == std::floor(number) && std::abs(number) < kMostExact;
    if (is_whole) {
      value = static_cast<std::int64_t>(number);
    } else {
      value = number;
    }
  }
  return json.empty() ? ""
                      : json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

class ExecMethod : public Method {
 public:
  ExecMethod(const std::string& command, const Settings& settings, RunContext context)
      : timeout_s_(settings.number(kTimeout_s)),
        context_(std::move(context)),
        greeting_{context_.scan_count.value_or(0), context_.scores, own_settings(settings)},
        program_(command) {
    if (context_.threads == 0) throw std::invalid_argument("threads: is 0, expected at least 1");
  }

  using Method::push;
  std::unique_ptr<Observed> observe(std::span<const Point> points, const Pose& map_from_sensor,
                                    const RayOrigins&) override {
    return std::make_unique<WaitingScan>(points, map_from_sensor);
  }

  std::vector<LabelledScan> push(std::unique_ptr<Observed> observed) override {
    const auto* scan = dynamic_cast<const WaitingScan*>(observed.get());
    if (scan == nullptr) throw std::logic_error("exec: the scan was observed by another method");
    if (ended_ || (context_.scan_count && scans_ >= *context_.scan_count)) {
      throw std::logic_error("exec: gets more scans than were announced");
    }
    if (scans_ == 0) greet();
    std::vector<LabelledScan> results(1);
    label(*scan, results.front());
    ++scans_;
    return results;
  }

  std::vector<LabelledScan> finish() override {
    if (std::exchange(ended_, true)) return {};
    const auto deadline = new_deadline();
    program_.end(deadline);
    expect_silence();
    const std::string end = program_.how_it_ended(deadline);
    if (end.empty()) {
      remarks_.push_back(fmt::format(
          "the program still ran {:g} s after its last scan, and was killed", timeout_s_));
    } else if (end != "ended with exit code 0") {
      remarks_.push_back(fmt::format("the program {} after its last scan", end));
    }
    return {};
  }

  std::vector<std::string> remarks() const override { return remarks_; }

 private:
  ChildProcess::Deadline new_deadline() const {
    return std::chrono::steady_clock::now() +
           std::chrono::round<std::chrono::steady_clock::duration>(
               std::chrono::duration<double>(timeout_s_));
  }

  void greet() {
    sends_scores_ = parse_ready(receive(greeting_message(greeting_), ready_answer()), greeting_);
    expect_silence();
  }

  void label(const WaitingScan& scan, LabelledScan& result) {
    const std::size_t points = scan.points.size();
    const std::string payload =
        receive(scan_message({scans_, stamp_ns(), scan.points, scan.map_from_sensor}),
                label_answer(points, sends_scores_));
    LabelMessage message = parse_labels(payload, scans_, points, sends_scores_);
    expect_silence();
    result.scan_index = scans_;
    result.labels = std::move(message.labels);
    if (context_.scores) result.scores = std::move(message.scores);
    result.judged = true;
    result.nonfinite_points =
        static_cast<std::size_t>(std::ranges::count(scan.points, false, is_finite));
  }

  std::int64_t stamp_ns() const {
    return scans_ < context_.stamps_ns.size() ? context_.stamps_ns[scans_] : ScanMessage::kNoStamp;
  }

  /// Sends, and returns the payload of the answer.
  std::string receive(std::string_view outgoing, const ExpectedAnswer& answer) {
    const auto deadline = new_deadline();
    await(outgoing, kHeaderBytes, answer.payload_bytes, deadline);
    check_header(program_.take(kHeaderBytes), answer);
    await({}, answer.payload_bytes, 0, deadline);
    return program_.take(answer.payload_bytes);
  }

  /// Sends, and waits until so many bytes are there. At most `further` bytes may follow.
  void await(std::string_view outgoing, std::size_t bytes, std::size_t further,
             ChildProcess::Deadline deadline) {
    const std::size_t unread = program_.exchange(outgoing, bytes, bytes + further, deadline);
    const std::size_t got = program_.inbox().size();
    if (got >= bytes && (unread == 0 || got > bytes + further)) return;
    if (!program_.is_closed()) {
      throw ProgramError(fmt::format("the program gave {} of {} bytes within {:g} s, and left {} "
                                     "bytes of its input unread",
                                     got, bytes, timeout_s_, unread),
                         "an answer in time, or a longer --set timeout_s");
    }
    std::string end = program_.how_it_ended(deadline);
    if (end.empty()) end = "closed its stdout";
    throw ProgramError(
        got >= bytes
            ? fmt::format("the program {} and left {} bytes of its input unread", end, unread)
            : fmt::format("the program {} after {} of {} bytes", end, got, bytes),
        "an answer to every scan; what it wrote to stderr stands above");
  }

  /// More than an answer was asked for: its labels may be shifted.
  void expect_silence() const {
    if (program_.inbox().empty()) return;
    throw ProgramError(fmt::format("the program wrote {} bytes or more behind its answer",
                                   program_.inbox().size()),
                       "one answer to each message and nothing else on stdout");
  }

  double timeout_s_;
  RunContext context_;
  Greeting greeting_;
  ChildProcess program_;
  std::size_t scans_ = 0;
  bool sends_scores_ = false, ended_ = false;
  std::vector<std::string> remarks_;
};

/// The row keeps views of the names.
struct NamedKind {
  std::string command, title;
  std::vector<std::string> names = {};  ///< of the program's own settings
  std::vector<Setting> own = {};
  MethodKind kind = {};
};

Settings default_settings(const NamedKind& named) {
  Setting timeout;
  timeout.name = kTimeout_s;
  timeout.value = 60.0;
  timeout.meaning = "the program answers its start and every scan within this time";
  timeout.lowest = 0.01;
  timeout.highest = 86400.0;
  std::vector<Setting> settings = {timeout};
  settings.insert(settings.end(), named.own.begin(), named.own.end());
  return Settings(std::move(settings));
}

bool are_alike(const std::vector<Setting>& one, const std::vector<Setting>& other) {
  return std::ranges::equal(one, other, [](const Setting& a, const Setting& b) {
    return a.name == b.name && a.value.index() == b.value.index();
  });
}

MethodKind kind_of(const NamedKind& named) {
  return {.name = kExecKind,
          .title = named.title,
          .source = "a program of the user",
          .summary = "labels of a program of the user, over a pipe",
          .defaults = default_settings(named),
          .check = [](const Settings&) {},
          .make = [command = named.command](const Settings& settings,
                                            const RunContext& context) -> std::unique_ptr<Method> {
            return std::make_unique<ExecMethod>(command, settings, context);
          },
          .takes_origins = true};  // of which the program learns nothing
}

}  // namespace

const MethodKind& exec_method(const std::string& command, const std::vector<Setting>& own) {
  if (command.empty()) {
    throw UsageError("--method exec: names no program, expected exec:COMMAND");
  }
  static std::mutex mutex;
  static std::list<NamedKind> kinds;
  const std::lock_guard lock(mutex);
  const auto known = std::ranges::find_if(kinds, [&](const NamedKind& kind) {
    return kind.command == command && are_alike(kind.own, own);
  });
  if (known != kinds.end()) return known->kind;
  NamedKind& named = kinds.emplace_back(NamedKind{command, "exec:" + command});
  for (const Setting& setting : own) named.names.emplace_back(setting.name);
  named.own = own;
  for (std::size_t i = 0; i < own.size(); ++i) named.own[i].name = named.names[i];
  named.kind = kind_of(named);
  return named.kind;
}

}  // namespace mosbench
