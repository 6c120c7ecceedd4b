#include "eval/result/tell.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

Caller& current_caller() {
  static Caller current;
  return current;
}

constexpr std::chrono::milliseconds kTerminalInterval{200};
constexpr std::chrono::milliseconds kPipeInterval{5000};

}  // namespace

const Caller& caller() { return current_caller(); }

CallerScope::CallerScope(Caller caller) { current_caller() = std::move(caller); }
CallerScope::~CallerScope() { current_caller() = {}; }

void tell(std::string_view line) {
  if (!caller().quiet) std::fputs((shown(line) + '\n').c_str(), stderr);
}

Progress::Progress(const std::string& title, std::size_t scans)
    : title_(shown_in_line(title)), scans_(scans), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (line_open_) std::fputc('\n', stderr);
}

void Progress::advance() {
  caller().at_each_scan();
  ++done_;
  const Clock::time_point now = Clock::now();
  const bool due = now - printed_ >= (terminal_ ? kTerminalInterval : kPipeInterval);
  if (due || done_ == scans_) print(now);
}

void Progress::print(Clock::time_point now) {
  printed_ = now;
  if (caller().quiet) return;
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  const double scan_s = elapsed_s / static_cast<double>(done_);
  const std::string line =
      fmt::format("{}: scan {}/{}, {:.0f} ms/scan, {} left", title_, done_, scans_, scan_s * 1e3,
                  duration_text(scan_s * static_cast<double>(scans_ - done_)));
  // Not fmt::print: it throws when nobody reads stderr, and progress is not worth a failed run.
  std::fputs((terminal_ ? "\r" + line + "\x1b[K" : line + "\n").c_str(), stderr);
  std::fflush(stderr);
  line_open_ = terminal_;
}

std::function<void(const std::string&, std::size_t, std::size_t)> progress_over_sequences(
    std::string title) {
  return [title = std::move(title), progress = std::make_shared<std::optional<Progress>>()](
             const std::string& sequence, std::size_t done, std::size_t scans) {
    if (done == 1) progress->emplace(title + " " + sequence, scans);
    progress->value().advance();
    if (done == scans) progress->reset();
  };
}

std::string duration_text(double seconds_s) {
  const auto whole = static_cast<long>(std::lround(seconds_s));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace mosbench
