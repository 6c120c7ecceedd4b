#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "datasets/doctor/doctor.hpp"
#include "eval/cli/checkup_report.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/dataset_flags.hpp"
#include "eval/cli/suggested_command.hpp"
#include "eval/engine/run_plan.hpp"
#include "eval/results/caller.hpp"

namespace mosbench {
namespace {

constexpr const char* kDoctorFooter =
    R"(Looks for faults that cost hours when they are noticed late: scans without labels or poses,
truncated or frozen scans, unknown label ids, labels beyond the labelled range, points in
millimetres, stamps out of order or in another unit, gaps in time, splits that name absent scans,
counts that differ from the published ones, and poses that do not fit the scans. Scans are
registered with one another, and the motions they show are compared with the poses: as given, and in
other conventions (inverse, transposed, rows shifted by up to 15, scaled, a sensor mounted
otherwise, ...). The one that fits is named, or several when the scans cannot decide; so are frozen
rows, lost scans, jumps, noise, and rows that are exchanged. Labels are compared with what other
scans see: what moves leaves its place. All files are listed; up to some hundred scans are read.
scripts/check/doctor_plants.py plants faults and counts what is found.

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
};

Answer check_dataset(const DoctorFlags& options) {
  const Checkup checkup = check_up(
      options.input, {dataset_kind_option(options.dataset), options.sequences, options.reading},
      caller().at_each_scan);
  return {
      .text = checkup_text(checkup, dataset_words(options.input, options.dataset, options.sequences,
                                                  checkup.remedy().applied_to(options.reading))),
      .exit_code = checkup.has(Severity::kError)     ? 3
                   : checkup.has(Severity::kWarning) ? 1
                                                     : 0,
      .json = checkup_json(checkup)};
}

}  // namespace

CommandRun add_doctor(CLI::App& command) {
  auto options = std::make_shared<DoctorFlags>();
  add_dataset_flags(command, options->input, options->dataset, options->sequences,
                    options->reading);
  command.footer(kDoctorFooter);
  return [options] { return check_dataset(*options); };
}

}  // namespace mosbench
