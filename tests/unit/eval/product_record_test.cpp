#include <gtest/gtest.h>

#include "eval/store/store.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

TEST(ProductRecord, KnowsMostOfManyFilesAlsoAfterAKill) {
  const TempFolder folder;
  {
    ProductRecord killed(folder.path());
    for (int k = 0; k < 120; ++k) killed.write(std::to_string(k) + ".ply", "points");
  }
  const ProductRecord next(folder.path());
  EXPECT_TRUE(next.has("0.ply"));
  EXPECT_TRUE(next.has("99.ply"));
  EXPECT_FALSE(next.has("100.ply")) << "is made again";
}

TEST(ProductRecord, KnowsAllFilesOnceSaved) {
  const TempFolder folder;
  ProductRecord record(folder.path());
  record.write("one.ply", "points");
  EXPECT_FALSE(ProductRecord(folder.path()).has("one.ply"));
  record.save();
  EXPECT_TRUE(ProductRecord(folder.path()).has("one.ply"));
}

}  // namespace
}  // namespace mosbench
