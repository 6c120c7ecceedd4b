#include "eval/cli/old_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

using Words = std::vector<std::string>;

constexpr std::string_view kReaders = "run profile score breakdown stats convert doctor odometry";

constexpr std::array kOldFlags = {
    OldFlag{kReaders, "--pose-format", true, "--read", "pose_format={}"},
    OldFlag{kReaders, "--pose-frame", true, "--read", "pose_frame={}"},
    OldFlag{kReaders, "--pose-direction", true, "--read", "pose_direction={}"},
    OldFlag{kReaders, "--max-pose-gap-s", true, "--read", "max_pose_gap_s={}"},
    OldFlag{kReaders, "--map-frame", true, "--read", "map_frame={}"},
    OldFlag{kReaders, "--pose-topic", true, "--read", "pose_topic={}"},
    OldFlag{kReaders, "--bin-columns", true, "--read", "bin_columns={}"},
    OldFlag{kReaders, "--moving-speed-m-s", true, "--read", "moving_speed_m_s={}"},
    OldFlag{kReaders, "--hdl64-correction", false, "--read", "hdl64_correction=on"},
    OldFlag{kReaders, "--raw-scans", false, "--deskew", "none"},
    OldFlag{"run profile", "--config", true, "--set", "@{}"},
    OldFlag{"run profile", "--variant", true, "--set", "variant={}"},
    OldFlag{"run profile", "--moving", true, "--set", "moving={}"},
    OldFlag{"odometry", "--preset", true, "--odometry", ":{}", "", ""},
    OldFlag{"odometry", "--config", true, "--odometry", "@{}"},
    OldFlag{"odometry", "--set", true, "--odometry", "{}"},
    OldFlag{"run convert", "--odometry-preset", true, "--odometry", ":{}", "", ""},
    OldFlag{"run convert", "--odometry-config", true, "--odometry", "@{}"},
    OldFlag{"run convert", "--odometry-set", true, "--odometry", "{}"},
    OldFlag{"run convert odometry", "--drop-moving", false, "--odometry", "drop_moving=on"},
    OldFlag{"run", "--scores", false, "--write", "scores"},
    OldFlag{"odometry", "--format", true, "--out", "{}:", "", "", true},
    OldFlag{"convert", "--compression", true, "--layout", "{}", ":"},
    OldFlag{"score", "--mask", true, "--format", "{}", ":", "label-masked"},
    OldFlag{"score", "--level", true, "--format", "{}", ":", "dynablox"},
    OldFlag{"score", "--setting", true, "--method", "{}", ", ", "unnamed"},
    OldFlag{"curve rank reproduce table study", "--format", true, "--as"},
    OldFlag{"study", "--profile", true, "--on"},
    OldFlag{"study", "--output", true, "-o"},
    OldFlag{"study", "--measure", false, ""},
    OldFlag{"profile", "--trace", true, "--out"},
    OldFlag{"trajectory", "--plot", true, "--out"},
    OldFlag{"trajectory", "--per-pose", false, "--by", "pose"},
    OldFlag{"compare", "--output-format", true, "--as"},
    OldFlag{"stats", "--csv", false, "--as", "csv"},
    OldFlag{"stats", "--per-scan", false, "--by", "scan"},
    OldFlag{"trajectory", "--csv", false, "--as", "csv"},
    OldFlag{"trajectory", "--format", true, "--read", "pose_format={}"},
    OldFlag{"trajectory", "--max-time-difference-s", true, "--read", "max_time_difference_s={}"},
    OldFlag{"trajectory", "--calib", true, "--camera", "{}", ":", "neither"},
    OldFlag{"trajectory", "--delta-m", true, "--delta", "{}m"},
    OldFlag{"trajectory", "--all-pairs", false, "--delta", "all", ",", "1"},
    OldFlag{"render", "--scan", true, "--scans", "{}"},
    OldFlag{"render", "--sequence", true, "--sequences", "{}"},
    OldFlag{"render", "--azimuth", true, "--view", "{}", ":", "orbit"},
    OldFlag{"render", "--turn", true, "--view", "{}", "+", "orbit"},
    OldFlag{"render", "--boxes", false, "--show", "boxes"},
    OldFlag{"render", "--reasons", false, "--show", "reasons"},
};

constexpr std::array kOldCommands = {
    OldCommand{"leaderboard", "rank {}"},
    OldCommand{"curve", "stats {} --by threshold"},
    OldCommand{"breakdown", "stats {} --by range,height,object"},
    OldCommand{"stats", "compare {} --by sequence", 2},
    OldCommand{"diff", "compare {} --by scan,object"},
    OldCommand{"bless", "compare {1} {0} --accept"},
    OldCommand{"map-score", "score {1} --map {0}"},
    OldCommand{"completion", "help --completion {}"},
    OldCommand{"reproduce", "run table:{0}"},
    OldCommand{"study run", "run {}"},
    OldCommand{"study plan", "run {} --dry-run"},
    OldCommand{"study cell", "run {0} --only {,}"},
    OldCommand{"study table", "rank {}"},
    OldCommand{"study", "run {}"},
};

/// Where the value of a flag stands, behind "=" or as a word of its own.
struct Found {
  Words::iterator word;
  std::size_t value_at = 0;  ///< in `word`
};

std::optional<Found> find_flag(Words& words, std::string_view flag) {
  if (flag == "--out") {
    if (const auto found = find_flag(words, "-o")) return found;
  }
  for (auto word = words.begin(); word != words.end() && *word != "--"; ++word) {
    if (*word == flag && word + 1 != words.end()) return Found{word + 1, 0};
    if (word->starts_with(flag) && word->substr(flag.size()).starts_with('=')) {
      return Found{word, flag.size() + 1};
    }
  }
  return std::nullopt;
}

bool is_assignment(const std::string& word) {
  return !word.starts_with('-') && word.find('=') != std::string::npos;
}

/// Takes an old flag out of the words. Returns its value, or nothing where it is not there.
std::optional<std::string> taken(Words& words, const OldFlag& old) {
  if (!old.has_value) {
    const auto word = std::ranges::find(words, old.flag);
    if (word == words.end()) return std::nullopt;
    words.erase(word);
    return "";
  }
  const std::optional<Found> found = find_flag(words, old.flag);
  if (!found) return std::nullopt;
  std::string value = found->word->substr(found->value_at);
  auto end = found->word + 1;
  // Settings may be words of their own: --set a=1 b=2.
  const bool takes_more = old.flag.ends_with("set") && found->value_at == 0;
  for (; takes_more && end != words.end() && is_assignment(*end); ++end) value += "," + *end;
  words.erase(found->word - (found->value_at == 0 ? 1 : 0), end);
  return value;
}

void put(Words& words, const OldFlag& old, const std::string& value) {
  if (old.now.empty()) return;
  const std::string part = fmt::format(fmt::runtime(old.part), value);
  if (const std::optional<Found> known = find_flag(words, old.now)) {
    const std::size_t end = old.in_front ? known->value_at : known->word->size();
    known->word->insert(end, old.in_front ? part : std::string(old.joint) + part);
    return;
  }
  words.emplace_back(old.now);
  words.push_back(old.head.empty() ? part : std::string(old.head) + std::string(old.joint) + part);
}

void replace_flags(Words& words) {
  const std::string command = words.front();
  for (const OldFlag& old : old_flags()) {
    const auto commands = split_at_blanks(old.commands);
    if (std::ranges::find(commands, command) == commands.end()) continue;
    while (const auto value = taken(words, old)) put(words, old, *value);
  }
}

/// Returns the words of today with the arguments of the old command in their places.
Words filled_in(const OldCommand& old, const Words& arguments, const TakesValue& takes_value) {
  const std::vector<std::string_view> now = split_at_blanks(old.now);
  const std::string today(now.front()), before(old.name);
  Words free, flags;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    const bool is_flag = word.starts_with('-') && word != "-";
    (is_flag ? flags : free).push_back(word);
    const bool holds_value = word.find('=') != word.npos;
    if (!is_flag || holds_value || i + 1 == arguments.size()) continue;
    const auto takes = takes_value(today, word), took = takes_value(before, word);
    // A word behind an unknown flag may be its value, and is no argument that makes an old line.
    if (old.arguments != 0 && !takes && !took) return {};
    if (takes.value_or(false) || took.value_or(false)) flags.push_back(arguments[++i]);
  }
  const auto is_help = [](const std::string& word) {
    return word == "--help" || word == "--help-all" || word == "-h";
  };
  const auto help = std::ranges::find_if(flags, is_help);
  if (old.arguments == 0 && help != flags.end()) return {today, *help};
  if (old.arguments != 0 && free.size() != old.arguments) return {};
  // How many have a place of their own.
  std::size_t placed =
      old.now.find("{1}") != old.now.npos ? 2 : old.now.find("{0}") != old.now.npos;
  placed = std::min(placed, free.size());
  const Words others(free.begin() + static_cast<std::ptrdiff_t>(placed), free.end());
  Words words;
  for (const std::string_view pattern : now) {
    if (pattern == "{}") {
      words.insert(words.end(), others.begin(), others.end());
      continue;
    }
    std::string word(pattern == "{,}" ? fmt::format("{}", fmt::join(others, ",")) : pattern);
    for (std::size_t i = 0; i < placed; ++i) {
      const std::string hole = fmt::format("{{{}}}", i);
      if (const auto at = pattern.find(hole); at != pattern.npos) {
        word.replace(at, hole.size(), free[i]);
      }
    }
    words.push_back(word);
  }
  words.insert(words.end(), flags.begin(), flags.end());
  return words;
}

}  // namespace

std::span<const OldFlag> old_flags() { return kOldFlags; }

std::span<const OldCommand> old_commands() { return kOldCommands; }

std::vector<std::string> in_new_words(std::vector<std::string> words,
                                      const TakesValue& takes_value) {
  if (words.empty()) return words;
  replace_flags(words);
  const bool asks_help = words.front() == "help" && words.size() > 1;
  const auto begin = words.begin() + (asks_help ? 1 : 0);
  for (const OldCommand& old : old_commands()) {
    const auto name = split_at_blanks(old.name);
    const auto length = static_cast<std::ptrdiff_t>(name.size());
    if (words.end() - begin < length || !std::equal(name.begin(), name.end(), begin)) continue;
    const Words now = filled_in(old, {begin + length, words.end()}, takes_value);
    if (now.empty()) continue;
    return asks_help ? Words{"help", now.front()} : now;
  }
  return words;
}

}  // namespace mosbench
