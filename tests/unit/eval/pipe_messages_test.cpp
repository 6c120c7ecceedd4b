#include "eval/exec/pipe_messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

/// Bytes of hexadecimal digits; blanks are left out.
std::string bytes_of(const std::string& hex) {
  std::string digits, bytes;
  for (const char c : hex) {
    if (c != ' ') digits += c;
  }
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    bytes += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  }
  return bytes;
}

TEST(PipeMessages, GreetAsDocumented) {
  EXPECT_EQ(greeting_message({.scans = 258, .wants_scores = true, .settings = {}}),
            "MOShello" + bytes_of("1800000000000000 01000000 04000000 0201000000000000 "
                                  "01000000 00000000"));
  const Greeting with_settings{.settings = R"({"a":1})"};
  EXPECT_EQ(greeting_message(with_settings),
            "MOShello" +
                bytes_of("1f00000000000000 02000000 04000000 0000000000000000 "
                         "00000000 00000000") +
                R"({"a":1})");
  EXPECT_FALSE(parse_ready(bytes_of("0200000000000000"), with_settings));
  EXPECT_THROW(parse_ready(bytes_of("0100000000000000"), with_settings), ProgramError);
}

TEST(PipeMessages, HoldAScanAsDocumented) {
  const std::vector<Point> points = {{1, 2, -1, 0.5F}, {0, 0, 0, 0}};
  Pose pose = Pose::Identity();
  pose.translation().x() = 2;
  const std::string message = scan_message({7, 10, points, pose});
  ASSERT_EQ(message.size(), 16U + 120 + 32);
  EXPECT_EQ(message.substr(0, 32),
            "MOSscan " + bytes_of("9800000000000000 0700000000000000 0a00000000000000"));
  const std::string one = "000000000000f03f", zero = "0000000000000000";
  EXPECT_EQ(message.substr(32, 32), bytes_of(one + zero + zero + "0000000000000040"));
  EXPECT_EQ(message.substr(128, 8), bytes_of("0200000000000000"));
  EXPECT_EQ(message.substr(136, 16), bytes_of("0000803f 00000040 000080bf 0000003f"));
  EXPECT_EQ(scan_message({0, ScanMessage::kNoStamp, {}, pose}).substr(24, 8),
            bytes_of("0000000000000080"));
}

TEST(PipeMessages, GiveTheLabelsAndScoresOfAnAnswer) {
  const std::string payload =
      bytes_of("0300000000000000 0200000000000000 09000000 fb000000 0000803f 000080bf");
  ASSERT_EQ(payload.size(), label_answer(2, true).payload_bytes);
  const LabelMessage message = parse_labels(payload, 3, 2, true);
  EXPECT_THAT(message.labels, testing::ElementsAre(9, 251));
  EXPECT_THAT(message.scores, testing::ElementsAre(1, -1));
  EXPECT_EQ(parse_labels(std::string(16, 0), 0, 0, true).labels.size(), 0U);
}

TEST(PipeMessages, RefuseWhatIsNoAnswer) {
  const auto refusal = [](auto&& read) { return message_of<ProgramError>(read); };
  const std::string header = "MOSlabel" + bytes_of("1800000000000000");
  check_header(header, label_answer(2, false));
  EXPECT_THAT(
      refusal([&] { check_header(header, label_answer(2, true)); }),
      HasSubstr("announces 24 bytes in MOSlabel, expected 32 bytes: the labels and scores"));
  EXPECT_THAT(refusal([&] { check_header(header, ready_answer()); }),
              HasSubstr("answers \"MOSlabel\""));
  EXPECT_THAT(refusal([&] {
                check_header(std::string("\0\x1b[2J\xff\n\r", 8) + bytes_of("0800000000000000"),
                             ready_answer());
              }),
              HasSubstr("answers \"??[2J???\""));
  const std::string start = "0000000000000000 0100000000000000 ";
  EXPECT_THAT(refusal([&] { parse_labels(bytes_of(start + "01000000"), 0, 1, false); }),
              HasSubstr("gives point 0 the label 1"));
  EXPECT_THAT(refusal([&] { parse_labels(bytes_of(start + "09000000 0000c07f"), 0, 1, true); }),
              HasSubstr("gives point 0 the score nan"));
  EXPECT_THAT(refusal([&] { parse_ready(bytes_of("0000000000000000"), {}); }),
              HasSubstr("speaks version 0"));
}

}  // namespace
}  // namespace mosbench
