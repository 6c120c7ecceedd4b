#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "datasets/sequence/reading.hpp"

namespace mosbench {

/// What was measured in a sequence, by name: numbers that checks compare with their thresholds, and
/// words for their sentences.
class Facts {
 public:
  using Fact = std::variant<double, std::size_t, std::string>;

  Fact& operator[](std::string_view name) { return facts_[std::string(name)]; }
  /// Returns nothing for what was not measured.
  std::optional<double> number(std::string_view name) const;
  /// Puts facts into the places of a sentence, shares also as percent: "{returns_percent:.0f} % of
  /// {points}".
  std::string told(std::string_view sentence) const;

 private:
  std::map<std::string, Fact, std::less<>> facts_;
};

/// The change of the reading options that mends a fault; none where reading cannot.
struct Remedy {
  std::optional<PoseFrame> pose_frame = std::nullopt;
  std::optional<PoseDirection> pose_direction = std::nullopt;

  explicit operator bool() const { return pose_frame || pose_direction; }
  bool operator==(const Remedy&) const = default;
  Reading applied_to(Reading reading) const;
};

/// Of a note all may be well, with a warning results are doubtful, with an error there are none.
enum class Severity : std::uint8_t { kNote, kWarning, kError };

struct Symptom {
  Severity severity = Severity::kWarning;
  std::string where;  ///< sequence or file
  std::string what;   ///< a plain sentence with what was found and what was expected
  Remedy remedy = {};
};

/// What is judged at a time.
enum class Subject : std::uint8_t {
  kFolder,
  kPoints,
  kLabelIds,
  kStamps,
  kPoses,
  kRows,  ///< of sound poses: others have detours of their own
  kLabels,
  kPublished,
  kWithin  ///< limits that single rows, motions or conventions were compared with already
};

/// A bound between sound data and faulty ones.
struct Limit {
  const char* fact;
  char faulty;  ///< '>' for above the threshold, '<' for at most that
  double threshold;

  bool passed(const Facts& facts) const;
};

/// A fault that is looked for. A new one is a row in `checks()`, and the facts that it compares.
struct Check {
  Subject subject;
  const char* name;
  std::vector<Limit> limits;  ///< all are passed by faulty data
  const char* sentence;       ///< with the names of facts; each line of it is a symptom
  /// Of a subject, no check after this one is asked when this one finds something.
  bool decides = false;
  Severity severity = Severity::kWarning;
  bool mended_by_reading = false;  ///< the remedy of the facts applies
};

/// All checks, the most certain ones of a subject first.
std::span<const Check> checks();

/// Returns what the checks of a subject find at `where`, notes among it. `remedy` is how to read
/// what could be read otherwise.
std::vector<Symptom> judged(std::span<const Check> table, Subject subject, const Facts& facts,
                            const std::string& where, const Remedy& remedy = {});

}  // namespace mosbench
