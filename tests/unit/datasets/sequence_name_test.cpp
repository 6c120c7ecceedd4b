#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "datasets/sequence/sequence.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string refusal(const std::string& name) {
  return message_of<DataError>([&] { SequenceName(name, "some/result.json"); });
}

TEST(SequenceName, TakesFoldersAndScenesWithAFolder) {
  for (const std::string& name :
       {std::string("08"), std::string("station/sequence_1"), std::string("a b;c"),
        std::string("..."), std::string(".hidden"), std::string("Straße"), std::string(255, 'x'),
        std::string("my.labels"), std::string("partial")}) {
    EXPECT_EQ(SequenceName(name, "folder").text(), name);
  }
}

TEST(SequenceName, RefusesWhatLeadsOutOfTheFolderOfResults) {
  for (const char* name : {"", ".", "..", "../../escaped", "/etc", "a/..", "a/", "a//b", "/"}) {
    EXPECT_THAT(refusal(name), StartsWith("some/result.json: names the sequence \"")) << name;
  }
  EXPECT_THAT(refusal("a/b/c"), HasSubstr("expected one folder, or a scene and a folder"));
}

TEST(SequenceName, RefusesNamesThatResultsUseThemselves) {
  for (const char* name : {"labels", "scores", "reasons", "result.json", "08.partial",
                           "08.replaced", ".partial", "labels/sequence_1", "station/scores"}) {
    EXPECT_THAT(refusal(name), HasSubstr("expected another name: results use labels, scores"))
        << name;
  }
}

TEST(SequenceName, RefusesBytesThatCannotBeShown) {
  for (const std::string& name :
       {std::string("a\x1b[2J"), std::string("a\nb"), std::string("a\0b", 3), std::string("a\x7f"),
        std::string("\xff"), std::string("\xc2\x9b"), std::string("\xed\xa0\x80")}) {
    EXPECT_THAT(refusal(name), HasSubstr("expected UTF-8 without control characters"));
  }
  EXPECT_THAT(refusal("a\x1b[2J\n"), HasSubstr("\"a\\x1b[2J\\x0a\""));
  EXPECT_THAT(refusal(std::string(256, 'x')), HasSubstr("expected at most 255 bytes"));
}

TEST(ShownText, EscapesWhatATerminalObeysAndWhatIsNoUtf8) {
  EXPECT_EQ(shown("Straße \xe2\x82\xac\n\ttail"), "Straße \xe2\x82\xac\n\ttail");
  EXPECT_EQ(shown("\x1b[31mred\r\x07\x7f"), "\\x1b[31mred\\x0d\\x07\\x7f");
  EXPECT_EQ(shown("\xc2\x9b"
                  "1m"),
            "\\xc2\\x9b1m");
  EXPECT_EQ(shown("a\xff\xfe"
                  "b\xc3"),
            "a\\xff\\xfeb\\xc3");
  EXPECT_EQ(shown(std::string_view("\0", 1)), "\\x00");
  EXPECT_EQ(shown_in_line("a\nb\tc"), "a\\x0ab\\x09c");
  EXPECT_TRUE(is_printable("Straße"));
  EXPECT_FALSE(is_printable("a\n"));
}

}  // namespace
}  // namespace mosbench
