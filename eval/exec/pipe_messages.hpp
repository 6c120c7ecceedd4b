#pragma once

#include <cstddef>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/text/errors.hpp"

namespace mosbench {

/// A program behind --method exec: does not do what it should. Whoever knows the scan names it.
class ProgramError : public DataError {
 public:
  ProgramError(const std::string& wrong, const std::string& expected)
      : DataError("exec", wrong, expected), wrong_(wrong), expected_(expected) {}

  const std::string& wrong() const { return wrong_; }
  const std::string& expected() const { return expected_; }

 private:
  std::string wrong_, expected_;
};

/// The messages between mosbench and a program that labels scans, as docs/formats/exec.md describes
/// them: a header of 16 bytes, then a payload; little endian, without padding.
inline constexpr std::size_t kHeaderBytes = 16;

/// What mosbench says first.
struct Greeting {
  std::uint64_t scans = 0;  ///< of the sequence; 0: not known
  bool wants_scores = false;
  std::string settings;  ///< a JSON object; empty for none

  /// Of the messages: programs that know no settings need not know of the second one.
  std::uint32_t version() const { return settings.empty() ? 1 : 2; }
};

/// One scan on its way to the program.
struct ScanMessage {
  std::uint64_t scan_index = 0;
  std::int64_t stamp_ns = kNoStamp;
  std::span<const Point> points;
  Pose map_from_sensor = Pose::Identity();

  static constexpr std::int64_t kNoStamp = INT64_MIN;
};

/// What the program answers to a scan.
struct LabelMessage {
  std::vector<std::uint32_t> labels;
  std::vector<float> scores;  ///< empty without
};

std::string greeting_message(const Greeting& greeting);
std::string scan_message(const ScanMessage& scan);

/// The message that a program has to answer with.
struct ExpectedAnswer {
  std::string_view tag;  ///< 8 bytes
  std::uint64_t payload_bytes;
  std::string payload;  ///< what it holds, in words
};

/// The answer to a greeting.
ExpectedAnswer ready_answer();
/// The answer to a scan of so many points.
ExpectedAnswer label_answer(std::size_t points, bool with_scores);
/// Checks kHeaderBytes bytes. Throws ProgramError for another message, or another size of one.
void check_header(std::string_view header, const ExpectedAnswer& expected);

/// Returns whether scores will come. Throws ProgramError for another version, or when scores are
/// wanted and will not come.
bool parse_ready(std::string_view payload, const Greeting& greeting);

/// Throws ProgramError for another scan, for labels other than 9 and 251 and for scores that are
/// not finite.
LabelMessage parse_labels(std::string_view payload, std::uint64_t scan_index, std::size_t points,
                          bool with_scores);

}  // namespace mosbench
