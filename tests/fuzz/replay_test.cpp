#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "datasets/hdf5/hdf5_module.hpp"
#include "tests/fuzz/parse_anything.hpp"

namespace mosbench {
namespace {

std::vector<std::string> corpus_of(const fuzz::Parser& parser) {
  std::vector<std::string> inputs;
  const auto folder = std::filesystem::path(MOSBENCH_SOURCE_DIR) / "tests/fuzz/corpus";
  for (const auto& entry : std::filesystem::directory_iterator(folder / parser.name)) {
    std::ifstream file(entry.path(), std::ios::binary);
    inputs.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  std::sort(inputs.begin(), inputs.end());  // folders list in any order, mutations are seeded
  return inputs;
}

/// One to four edits: a bit, a byte, a cut, a doubled piece, a piece of another input, a number
/// that is at a limit.
class Mutator {
 public:
  explicit Mutator(std::uint32_t seed) : random_(seed) {}

  std::string mutate(std::string bytes, const std::string& other) {
    for (std::size_t edits = 1 + below(4); edits > 0; --edits) edit(bytes, other);
    return bytes;
  }

 private:
  std::size_t below(std::size_t limit) { return random_() % limit; }

  void edit(std::string& bytes, const std::string& other) {
    static const std::vector<std::string> kPieces = {"\n",
                                                     "\r\n",
                                                     ",",
                                                     " ",
                                                     "-",
                                                     ".",
                                                     "e",
                                                     "e-2147483648",
                                                     "nan",
                                                     "inf",
                                                     "+",
                                                     "1e309",
                                                     "0x",
                                                     "\"",
                                                     std::string(1, '\0'),
                                                     "4294967295",
                                                     "9223372036854775807",
                                                     "18446744073709551616",
                                                     "Tr:",
                                                     "\xff"};
    const std::size_t at = below(bytes.size() + 1);
    switch (below(6)) {
      case 0:
        if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 1:
        if (at < bytes.size()) bytes[at] = static_cast<char>(below(256));
        break;
      case 2:
        bytes.erase(at, below(16));
        break;
      case 3:
        bytes.insert(at, bytes.substr(below(bytes.size() + 1), below(64)));
        break;
      case 4:
        bytes.insert(at, other.substr(below(other.size() + 1), below(64)));
        break;
      default:
        bytes.insert(at, kPieces[below(kPieces.size())]);
        break;
    }
  }

  std::mt19937 random_;
};

class EveryParser : public testing::TestWithParam<fuzz::Parser> {
 protected:
  void SetUp() override {
    if (GetParam().name == std::string("hdf5") && !has_hdf5()) {
      GTEST_SKIP() << "this build is without libhdf5";
    }
  }
  void replay(const std::string& input) {
    bool value = false;
    ASSERT_NO_THROW(value = fuzz::gives_value(GetParam().parse, input)) << "input: " << input;
    ++(value ? values_ : errors_);
  }
  std::size_t values_ = 0;
  std::size_t errors_ = 0;
};

TEST_P(EveryParser, GivesAValueOrADataErrorForItsCorpus) {
  for (const std::string& input : corpus_of(GetParam())) replay(input);
  EXPECT_GT(values_, 0U) << "the corpus has no good input";
  EXPECT_GT(errors_, 0U) << "the corpus has no bad input";
}

TEST_P(EveryParser, GivesAValueOrADataErrorForMutationsOfItsCorpus) {
  const auto corpus = corpus_of(GetParam());
  ASSERT_GE(corpus.size(), 3U);
  Mutator mutator(20240521);
  for (std::size_t i = 0; i < GetParam().mutations; ++i) {
    replay(mutator.mutate(corpus[i % corpus.size()], corpus[(i * 7 + 1) % corpus.size()]));
  }
  // Both ways out are walked, so the mutations are neither harmless nor all noise.
  EXPECT_GT(values_, 30U);
  EXPECT_GT(errors_, 30U);
}

TEST_P(EveryParser, GivesAValueOrADataErrorForFilesOfOtherFormats) {
  for (const fuzz::Parser& owner : fuzz::kParsers) {
    for (const std::string& input : corpus_of(owner)) replay(input);
  }
}

INSTANTIATE_TEST_SUITE_P(Fuzz, EveryParser, testing::ValuesIn(fuzz::kParsers),
                         [](const auto& parser) { return std::string(parser.param.name); });

}  // namespace
}  // namespace mosbench
