#include "datasets/disk/files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <csignal>
#include <future>
#include <iterator>

#include "datasets/disk/partial_file.hpp"
#include "datasets/text/errors.hpp"
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

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  std::ranges::sort(names);
  return names;
}

TEST(WriteFileAtomic, ReplacesAndTakesOverWhatAKilledRunLeft) {
  const TempFolder folder;
  const auto file = folder.write("result.json", "old and longer");
  folder.write(partial_of("result.json").native(), "left by a killed run, longest of all");
  write_file_atomic(file, "new");
  EXPECT_EQ(read_file(file), "new");
  EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("result.json"));
  commit_file(folder / "a/b/c.json", "committed");
  EXPECT_EQ(read_file(folder / "a/b/c.json"), "committed");
  EXPECT_THAT(names_in(folder / "a/b"), testing::ElementsAre("c.json"));
}

TEST(WriteFileAtomic, LeavesFilesOfOthersThatAreNamedAsIfInPart) {
  const TempFolder folder;
  const auto others = folder.write("report.html.partial", "a download");
  write_file_atomic(folder / "report.html", "new");
  EXPECT_EQ(read_file(others), "a download");
}

TEST(WriteFileAtomic, HasAFileOfItsOwnForEachOfTwoWriters) {
  const TempFolder folder;
  const auto file = folder.write("f", "old");
  PartialFile slow(file);
  slow.write("slow");
  write_file_atomic(file, "fast");
  EXPECT_EQ(read_file(file), "fast");
  EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("f", "f.mosbench.partial"));
  slow.put_in_place_of(file);
  EXPECT_EQ(read_file(file), "slow");
  EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("f"));
}

TEST(WriteFileAtomic, GivesAWholeFileWhoeverOfManyWritersIsLast) {
  const TempFolder folder;
  const auto file = folder / "f";
  constexpr std::size_t kBytes = 20'000;
  std::vector<std::future<void>> writers;
  for (char letter = 'a'; letter < 'i'; ++letter) {
    writers.push_back(std::async(std::launch::async, [&file, letter] {
      for (int round = 0; round < 50; ++round) {
        write_file_atomic(file, std::string(kBytes, letter));
      }
    }));
  }
  for (auto& writer : writers) writer.get();
  const std::string bytes = read_file(file);
  EXPECT_EQ(bytes, std::string(kBytes, bytes.at(0)));
  EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("f"));
}

TEST(WriteFileAtomic, FollowsLinksAndKeepsThem) {
  namespace fs = std::filesystem;
  const TempFolder folder;
  folder.write("disk/result.json", "old");
  fs::create_symlink("disk/result.json", folder / "link");
  fs::create_symlink(folder / "link", folder / "link_to_link");
  write_file_atomic(folder / "link_to_link", "new");
  EXPECT_EQ(read_file(folder / "disk/result.json"), "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link") && fs::is_symlink(folder / "link_to_link"));
  EXPECT_THAT(names_in(folder / "disk"), testing::ElementsAre("result.json"));
  fs::create_symlink("disk/absent", folder / "dangling");
  write_file_atomic(folder / "dangling", "made");
  EXPECT_EQ(read_file(folder / "disk/absent"), "made");
  fs::create_symlink("loop", folder / "loop");
  EXPECT_THAT(message_of<DataError>([&] { write_file_atomic(folder / "loop", "x"); }),
              HasSubstr("symbolic links"));
}

TEST(WriteFileAtomic, WritesIntoAFifoInsteadOfReplacingIt) {
  const TempFolder folder;
  const auto fifo = folder / "fifo";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  std::filesystem::create_symlink("fifo", folder / "link");
  for (const auto& name : {fifo, folder / "link"}) {
    auto reader = std::async(std::launch::async, [&fifo] {
      std::ifstream in(fifo);
      return std::string{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    });
    commit_file(name, "bytes");
    EXPECT_EQ(reader.get(), "bytes");
    EXPECT_TRUE(std::filesystem::is_fifo(fifo));
  }
}

TEST(WriteFileAtomic, WritesToADeviceInsteadOfReplacingIt) {
  const TempFolder folder;
  const auto device = folder / "null";  // the null device under another name
  if (mknod(device.c_str(), S_IFCHR | 0600, makedev(1, 3)) != 0) {
    GTEST_SKIP() << "devices cannot be made here";
  }
  if (!std::ofstream(device)) GTEST_SKIP() << "devices cannot be opened here";
  write_file_atomic(device, "bytes");
  EXPECT_TRUE(std::filesystem::is_character_file(device));
  EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("null"));
}

TEST(WriteFileAtomic, NamesTheFileWhenItsFolderIsAFile) {
  const TempFolder folder;
  folder.write("taken", "");
  const auto message =
      message_of<DataError>([&] { write_file_atomic(folder / "taken/result.json", "x"); });
  EXPECT_THAT(message, AllOf(HasSubstr("taken/result.json"), HasSubstr("expected a writable")));
}

TEST(WriteFileAtomic, KeepsTheOldFileAndSaysWhyWhenThereIsNoRoom) {
  const TempFolder folder;
  const auto file = folder.write("result.json", "old");
  struct rlimit before {};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const struct rlimit small { 1000, before.rlim_max };
  const auto signal_before = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto message =
      message_of<DataError>([&] { write_file_atomic(file, std::string(2000, 'x')); });
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, signal_before);
  EXPECT_THAT(message, AllOf(HasSubstr("result.json"), HasSubstr("File too large")));
  EXPECT_EQ(read_file(file), "old");
  EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("result.json"));
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
