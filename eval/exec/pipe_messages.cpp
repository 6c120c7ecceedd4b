#include "eval/exec/pipe_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they are stored");
static_assert(sizeof(Point) == 4 * sizeof(float));

constexpr std::uint32_t kColumns = 4;
constexpr std::size_t kLabelStartBytes = 16;

template <typename Number>
void append(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

template <typename Number>
Number number_at(std::string_view bytes, std::size_t offset) {
  Number number;
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

template <typename Number>
std::vector<Number> numbers_at(std::string_view bytes, std::size_t offset, std::size_t count) {
  std::vector<Number> numbers(count);
  if (count > 0) std::memcpy(numbers.data(), bytes.data() + offset, count * sizeof(Number));
  return numbers;
}

std::string header(std::string_view tag, std::uint64_t payload_bytes) {
  std::string bytes(tag);
  append(bytes, payload_bytes);
  return bytes;
}

/// Throws ProgramError for the first value that is wrong.
template <typename Value>
void check_each(const std::vector<Value>& values, bool (*is_right)(Value), const char* what,
                const std::string& expected) {
  const auto wrong = std::ranges::find_if_not(values, is_right);
  if (wrong == values.end()) return;
  throw ProgramError(
      fmt::format("the program gives point {} the {} {}", wrong - values.begin(), what, *wrong),
      expected);
}

bool is_label(std::uint32_t label) { return label == kStaticLabel || label == kMovingLabel; }

}  // namespace

std::string greeting_message(const Greeting& greeting) {
  std::string bytes = header("MOShello", 24 + greeting.settings.size());
  append(bytes, greeting.version());
  append(bytes, kColumns);
  append(bytes, greeting.scans);
  append(bytes, std::uint32_t{greeting.wants_scores});
  append(bytes, std::uint32_t{0});
  return bytes + greeting.settings;
}

std::string scan_message(const ScanMessage& scan) {
  const std::size_t start_bytes = 3 * sizeof(std::uint64_t) + 12 * sizeof(double);
  std::string bytes = header("MOSscan ", start_bytes + scan.points.size_bytes());
  bytes.reserve(bytes.size() + start_bytes + scan.points.size_bytes());
  append(bytes, scan.scan_index);
  append(bytes, scan.stamp_ns);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      append(bytes, scan.map_from_sensor.matrix()(row, column));
    }
  }
  append(bytes, std::uint64_t{scan.points.size()});
  bytes.append(reinterpret_cast<const char*>(scan.points.data()), scan.points.size_bytes());
  return bytes;
}

ExpectedAnswer ready_answer() { return {"MOSready", 8, "version and whether scores come"}; }

ExpectedAnswer label_answer(std::size_t points, bool with_scores) {
  return {"MOSlabel", kLabelStartBytes + points * (with_scores ? 8 : 4),
          fmt::format("the labels{} of {} points", with_scores ? " and scores" : "", points)};
}

void check_header(std::string_view header, const ExpectedAnswer& expected) {
  if (const std::string_view tag = header.substr(0, 8); tag != expected.tag) {
    throw ProgramError(
        fmt::format("the program answers {}", mosbench::quoted(tag)),
        fmt::format("a message {} on stdout, and other text on stderr", expected.tag));
  }
  if (const auto bytes = number_at<std::uint64_t>(header, 8); bytes != expected.payload_bytes) {
    throw ProgramError(fmt::format("the program announces {} bytes in {}", bytes, expected.tag),
                       fmt::format("{} bytes: {}", expected.payload_bytes, expected.payload));
  }
}

bool parse_ready(std::string_view payload, const Greeting& greeting) {
  const auto version = number_at<std::uint32_t>(payload, 0);
  if (version != greeting.version()) {
    throw ProgramError(fmt::format("the program speaks version {}", version),
                       fmt::format("version {}", greeting.version()));
  }
  const bool with_scores = number_at<std::uint32_t>(payload, 4) != 0;
  if (greeting.wants_scores && !with_scores) {
    throw ProgramError("the program gives no scores", "scores, or a run without --write scores");
  }
  return with_scores;
}

LabelMessage parse_labels(std::string_view payload, std::uint64_t scan_index, std::size_t points,
                          bool with_scores) {
  const auto index = number_at<std::uint64_t>(payload, 0);
  const auto count = number_at<std::uint64_t>(payload, 8);
  if (index != scan_index || count != points) {
    throw ProgramError(fmt::format("the program labels {} points of scan {}", count, index),
                       fmt::format("the {} points of scan {}", points, scan_index));
  }
  LabelMessage message{numbers_at<std::uint32_t>(payload, kLabelStartBytes, points), {}};
  check_each(message.labels, is_label, "label",
             fmt::format("{} (static) or {} (moving)", kStaticLabel, kMovingLabel));
  if (!with_scores) return message;
  message.scores = numbers_at<float>(payload, kLabelStartBytes + 4 * points, points);
  check_each<float>(
      message.scores, [](float score) { return std::isfinite(score); }, "score", "a finite number");
  return message;
}

}  // namespace mosbench
