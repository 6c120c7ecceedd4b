#include "datasets/formats/mounts_file.hpp"

#include <span>
#include <vector>

#include "datasets/formats/pose_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {

std::map<std::string, Pose> parse_mounts(std::string_view text, const std::filesystem::path& file) {
  constexpr std::size_t kNumbers = 7;
  std::map<std::string, Pose> mounts;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = take_line(text);
    const std::vector<std::string_view> words = split_at_blanks(line.substr(0, line.find('#')));
    if (words.empty()) continue;
    if (words.size() != kNumbers + 1) {
      throw DataError(file, number, counted(words.size(), "word") + " in the row", kMountRow);
    }
    const auto n = parse_numbers(std::span(words).subspan(1), [&](std::string_view word) {
      throw DataError(file, number, quoted(word) + " is no finite number", kMountRow);
    });
    const auto mount = pose_of({n[0], n[1], n[2]}, {n[3], n[4], n[5], n[6]});
    if (!mount) throw DataError(file, number, "the quaternion is not of length 1", kMountRow);
    if (!mounts.emplace(words.front(), *mount).second) {
      throw DataError(file, number, "a second row of " + quoted(words.front()), "one");
    }
  }
  return mounts;
}

}  // namespace mosbench
