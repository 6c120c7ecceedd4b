#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "datasets/doctor/doctor.hpp"
#include "eval/cli/checkup_report.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/dataset_flags.hpp"
#include "eval/results/reading_json.hpp"
#include "eval/results/shell_text.hpp"
#include "eval/runs/run_plan.hpp"

namespace mosbench {
namespace {

constexpr const char* kDoctorFooter =
    R"(Looks for faults that cost hours when they are noticed late: scans without labels or poses, truncated
or frozen scans, unknown label ids, labels beyond the labelled range, points in millimetres, stamps out
of order or in another unit, gaps in time, splits that name absent scans, counts that differ from the
published ones, and poses that do not fit the scans. Scans are registered with one another, and the
motions they show are compared with the poses: as given, and in other conventions (inverse, transposed,
rows shifted by up to 15, scaled, a sensor mounted otherwise, ...). The one that fits is named, or several
when the scans cannot decide; so are frozen rows, lost scans, jumps, noise, and rows that are exchanged.
Labels are compared with what other scans see: what moves leaves its place. All files are listed; up to
some hundred scans are read. scripts/check/doctor_plants.py plants faults and counts what is found.

Exit codes: 0 nothing found, 1 warnings, 3 the data set cannot be read.

Examples:
  mosbench doctor ~/kitti
  mosbench doctor ~/doals/station/sequence_1
  mosbench doctor ~/kitti --sequences 08 --poses suma.txt --pose-frame camera
  mosbench doctor sim/doals --json)";

struct DoctorFlags {
  std::filesystem::path input;
  std::string dataset = "auto";
  std::vector<std::string> sequences;
  ReadingOptions reading;
  bool json = false;
};

/// DATA and the flags that say how it was read, for the command that comes next.
std::string asked(const DoctorFlags& options) {
  std::string words = shell_word(options.input.string());
  if (options.dataset != "auto") words += " --dataset " + options.dataset;
  if (!options.sequences.empty()) {
    words += " --sequences " + shell_word(fmt::format("{}", fmt::join(options.sequences, ",")));
  }
  return words + told_flags(options.reading);
}

Answer check_dataset(const DoctorFlags& options) {
  const Checkup checkup = check_up(
      options.input, {dataset_kind_option(options.dataset), options.sequences, options.reading});
  std::string report = options.json ? checkup_json(checkup) : checkup_text(checkup, asked(options));
  return {report, checkup.has(Severity::kError) ? 3 : checkup.has(Severity::kWarning) ? 1 : 0};
}

}  // namespace

CommandRun add_doctor(CLI::App& command) {
  auto options = std::make_shared<DoctorFlags>();
  add_dataset_flags(command, options->input, options->dataset, options->sequences,
                    options->reading);
  command.add_flag("--json", options->json, "Print JSON instead of text");
  command.footer(kDoctorFooter);
  return [options] { return check_dataset(*options); };
}

}  // namespace mosbench
