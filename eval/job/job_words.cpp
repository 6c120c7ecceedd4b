#include "eval/job/job_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/result/settings_json.hpp"

namespace mosbench {
namespace {

/// Settings while their words are read, one after the other.
class ChangeReader {
 public:
  explicit ChangeReader(const MethodKind& method) : method_(method), settings_(method.defaults) {}

  void read_file(const std::filesystem::path& file) {
    for (const std::string& name : apply_settings_file(file, settings_)) keep(name);
  }

  void read_assignment(const std::string& assignment) {
    apply_setting_assignment(assignment, settings_);
    keep(assignment.substr(0, assignment.find('=')));
  }

  /// moving=now, ever or ever:SECONDS: a short word of the methods that have it.
  void read_word(std::string_view name, const std::string& text) {
    const auto word_of = [&](const MethodKind& kind) {
      const auto found = std::ranges::find(kind.words, name, &SettingWord::name);
      return found == kind.words.end() ? nullptr : &*found;
    };
    const MethodKind& owner =
        word_of(method_) != nullptr ? method_ : *std::ranges::find_if(methods(), word_of);
    const SettingWord& word = *word_of(owner);
    if (text == word.usual) return;
    const std::string with_number = fmt::format("{}:", word.value);
    const bool has_number =
        text.starts_with(with_number) && parse_double(text.substr(with_number.size())).has_value();
    if (text != word.value && !has_number) {
      throw UsageError(fmt::format("{}: '{}' is not known, expected {}, {} or {}{}", name, text,
                                   word.usual, word.value, with_number, word.number));
    }
    if (&owner != &method_) {
      throw UsageError(fmt::format("{}={}: method {} {}, expected {}", name, text, method_.name,
                                   word.lacking, owner.name));
    }
    for (const std::string_view taking : word.takes) {
      const std::string number =
          has_number ? text.substr(with_number.size()) : to_string(settings_.find(taking)->highest);
      read_assignment(fmt::format("{}={}", taking, number));
    }
    for (const PresetValue& set : word.sets) {
      settings_.set(set.setting, set.value);
      keep(set.setting);
    }
  }

  std::vector<SettingChange> changes;

 private:
  void keep(std::string_view name) {
    changes.push_back({std::string(name), settings_.find(name)->value});
  }

  const MethodKind& method_;
  Settings settings_;
};

Segment segment_of(const JobWords& words) {
  Segment segment{.method = &method_of(words.method, words.preset)};
  if (words.preset) segment.preset = &preset_named(*words.preset);
  ChangeReader reader(*segment.method);
  if (words.config_file) reader.read_file(*words.config_file);
  reader.read_word("moving", words.moving);
  for (const std::string& assignment : words.assignments) reader.read_assignment(assignment);
  segment.changes = std::move(reader.changes);
  if (words.moving != "now") segment.label = words.moving;
  std::ranges::replace(segment.label, ':', '-');
  return segment;
}

}  // namespace

Data data_of(const DataWords& words) {
  return {.path = words.input,
          .kind = dataset_kind_option(words.dataset),
          .sequences = words.sequences,
          .reading = words.reading};
}

Dataset open_dataset(const DataWords& words) {
  return open_dataset(words.input,
                      {dataset_kind_option(words.dataset), words.sequences, words.reading});
}

Job job_of(const JobWords& words) {
  Job job;
  job.segment = segment_of(words);
  job.odometry = named_odometry(words.odometry, words.reading);
  job.data = data_of(words);
  if (job.odometry) job.data.reading.poses = ByOdometry{};
  if (words.protocol) job.rule.protocol = &protocol_named(*words.protocol);
  if (words.range) job.rule.range = parsed_range(*words.range);
  return job;
}

SettingChange change_of(const std::string& assignment, const MethodKind& method) {
  ChangeReader reader(method);
  reader.read_assignment(assignment);
  return reader.changes.front();
}

std::optional<DatasetKind> dataset_kind_option(const std::string& name) {
  if (name == "auto") return std::nullopt;
  if (const std::optional<DatasetKind> kind = dataset_kind_from_string(name)) return kind;
  throw UsageError(
      fmt::format("--dataset: '{}' is not known, expected auto, {}", name, dataset_kind_names()));
}

RangeGate parsed_range(const std::string& text) {
  RangeGate range;
  int used = 0;
  const int fields = std::sscanf(text.c_str(), "%lf,%lf%n", &range.min_m, &range.max_m, &used);
  const bool whole = fields == 2 && static_cast<std::size_t>(used) == text.size();
  if (whole && range.min_m >= 0.0 && (range.max_m > range.min_m || range.max_m == -1.0)) {
    return range;
  }
  throw UsageError(fmt::format(
      "--range: '{}' is no range, expected MIN,MAX in metres with 0 <= MIN < MAX (MAX -1: none)",
      text));
}

RangeGate range_option(const std::string& text, const Protocol& protocol) {
  const RangeGate range = parsed_range(text);
  check_range(range, protocol);
  return range;
}

}  // namespace mosbench
