#include "datasets/files/files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/files/errors.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(WriteFileAtomic, ReadsBackByteForByteInMissingFolders) {
  const TempFolder folder;
  const std::string bytes("a\0b\r\n\xff", 6);
  const auto file = folder / "new/folder/scan.label";
  write_file_atomic(file, bytes);
  EXPECT_EQ(read_file(file), bytes);
}

TEST(WriteFileAtomic, ReplacesAndLeavesNothingBeside) {
  const TempFolder folder;
  const auto file = folder.write("result.json", "old and longer");
  folder.write("result.json.partial", "left by a killed run");
  write_file_atomic(file, "new");
  EXPECT_EQ(read_file(file), "new");
  EXPECT_FALSE(std::filesystem::exists(folder / "result.json.partial"));
}

TEST(WriteFileAtomic, NamesTheFileWhenItsFolderIsAFile) {
  const TempFolder folder;
  folder.write("taken", "");
  const auto message =
      message_of<DataError>([&] { write_file_atomic(folder / "taken/result.json", "x"); });
  EXPECT_THAT(message, AllOf(HasSubstr("taken/result.json"), HasSubstr("expected a writable")));
}

TEST(WriteFileAtomic, KeepsTheOldFileAndSaysWhyOnAFullDisk) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  const TempFolder folder;
  const auto file = folder.write("result.json", "old");
  std::filesystem::create_symlink("/dev/full", folder / "result.json.partial");
  const auto message = message_of<DataError>([&] { write_file_atomic(file, "new"); });
  EXPECT_THAT(message, AllOf(HasSubstr("result.json"), HasSubstr("No space left")));
  EXPECT_EQ(read_file(file), "old");
}

TEST(ReadFile, TellsAFolderAndAMissingFileApart) {
  const TempFolder folder;
  EXPECT_THAT(message_of<DataError>([&] { read_file(folder.path()); }), HasSubstr("is a folder"));
  EXPECT_THAT(message_of<DataError>([&] { read_file(folder / "absent"); }),
              AllOf(HasSubstr("absent"), HasSubstr("No such file")));
}

TEST(ReadFile, IntoBytesWantsAFileOfJustThatLength) {
  const TempFolder folder;
  const auto file = folder.write("f", "abc");
  std::vector<std::byte> bytes(3);
  read_file(file, bytes);
  EXPECT_EQ(bytes[2], std::byte{'c'});
  for (const std::size_t length : {0U, 2U, 4U}) {
    bytes.resize(length);
    EXPECT_THAT(message_of<DataError>([&] { read_file(file, bytes); }),
                HasSubstr("changed while it was read"))
        << length;
  }
  bytes.clear();
  read_file(folder.write("empty", ""), bytes);
  EXPECT_THAT(message_of<DataError>([&] { size_of(folder.path()); }), HasSubstr("is a folder"));
  EXPECT_THAT(message_of<DataError>([&] { size_of(folder / "none"); }),
              HasSubstr("none: cannot be opened (No such file"));
}

TEST(ReadHead, EndsAfterTheLastLineOfTheHeadWhereverThatLies) {
  const TempFolder folder;
  // Around 4096 bytes, which are read at a time, the line lies before, across and after the step.
  for (const std::size_t before : {0U, 10U, 4080U, 4090U, 4095U, 4096U, 4097U, 9000U}) {
    const std::string head = std::string(before, 'c') + "\nDATA ascii\n";
    const auto file = folder.write("f", head + std::string(100'000, '7'));
    const std::string read = read_head(file, "DATA");
    ASSERT_GE(read.size(), head.size()) << before;
    EXPECT_LE(read.size(), head.size() + 2 * 4096) << before;
    EXPECT_TRUE(read.starts_with(head)) << before;
  }
}

TEST(ReadHead, IsTheWholeFileWithoutThatLine) {
  const TempFolder folder;
  const std::string bytes = "a\n# DATA\n" + std::string(10'000, 'b') + "\nDATA";
  EXPECT_EQ(read_head(folder.write("f", bytes), "DATA"), bytes);
  EXPECT_EQ(read_head(folder.write("empty", ""), "DATA"), "");
  EXPECT_THROW(read_head(folder / "missing", "DATA"), DataError);
}

TEST(ReadFile, ReadsAnEmptyFile) {
  const TempFolder folder;
  EXPECT_EQ(read_file(folder.write("empty", "")), "");
}

}  // namespace
}  // namespace mosbench
