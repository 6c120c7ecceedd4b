#include "datasets/disk/folder_listing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::ElementsAre;

std::vector<std::string> listed(const std::vector<std::string>& stems) {
  const TempFolder folder;
  for (const std::string& stem : stems) write_file_atomic(folder.path() / (stem + ".bin"), "");
  std::vector<std::string> found;
  for (const StemFile& file : list_by_stem(folder.path(), {".bin"})) found.push_back(file.stem);
  return found;
}

// Text puts 10 before 2, and gave poses to the wrong scans.
TEST(FolderListing, PutsNumbersInNamesInOrder) {
  EXPECT_THAT(listed({"scan_10", "scan_9", "scan_1", "scan_100"}),
              ElementsAre("scan_1", "scan_9", "scan_10", "scan_100"));
  EXPECT_THAT(listed({"000010", "9", "0"}), ElementsAre("0", "9", "000010"));
  EXPECT_THAT(listed({"run2-scan1", "run10-scan0", "run2-scan10", "run2-scan9"}),
              ElementsAre("run2-scan1", "run2-scan9", "run2-scan10", "run10-scan0"));
  EXPECT_THAT(listed({"cloud.10", "cloud.9", "cloud"}),
              ElementsAre("cloud", "cloud.9", "cloud.10"));
  EXPECT_THAT(listed({"\xC3\xA4", "z", "a"}), ElementsAre("a", "z", "\xC3\xA4"));
  const std::string beyond_64_bits = "99999999999999999999999";
  EXPECT_THAT(listed({beyond_64_bits, "1" + beyond_64_bits, "7"}),
              ElementsAre("7", beyond_64_bits, "1" + beyond_64_bits));
}

TEST(FolderListing, TakesDigitsBehindAPointForAFraction) {
  EXPECT_THAT(listed({"1650.5", "1650.123", "1649.9", "1650.25"}),
              ElementsAre("1649.9", "1650.123", "1650.25", "1650.5"));
}

TEST(FolderListing, RefusesTwoFilesOfOneScan) {
  EXPECT_THROW(listed({"7", "007"}), DataError);
  EXPECT_THROW(listed({"scan_7", "scan_007"}), DataError);
  EXPECT_NO_THROW(listed({"scan_7", "Scan_7", "scan7"}));
}

}  // namespace
}  // namespace mosbench
