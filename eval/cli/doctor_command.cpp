#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "datasets/doctor/doctor.hpp"
#include "eval/cli/checkup_report.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/dataset_flags.hpp"
#include "eval/runs/run_plan.hpp"

namespace mosbench {
namespace {

constexpr const char* kDoctorFooter =
    R"(Looks for faults that cost hours when they are noticed late: scans without labels or poses, truncated
or frozen scans, unknown label ids, labels beyond the labelled range, points in millimetres, stamps out
of order, splits that name absent scans, counts that differ from the published ones, and poses in
another convention. The convention is measured: pairs of scans are aligned under each one, and the one
with the largest overlap of surfaces is named, or several when the scans cannot decide. Rows of poses
that are exchanged or off the trajectory are named, too. A shift by one row shows only where the motion
changes from scan to scan; the report says when it does not. All files are listed; some dozens of scans
are read.

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

Answer check_dataset(const DoctorFlags& options) {
  const Checkup checkup = check_up(
      options.input, {dataset_kind_option(options.dataset), options.sequences, options.reading});
  std::string report =
      options.json ? checkup_json(checkup) : checkup_text(checkup, options.input.string());
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
