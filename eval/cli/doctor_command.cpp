#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "datasets/doctor/doctor.hpp"
#include "eval/cli/checkup_report.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/reading_flags.hpp"
#include "eval/runs/run_plan.hpp"

namespace mosbench {
namespace {

constexpr const char* kDoctorFooter =
    R"(Looks for what costs hours when it is noticed late: scans without labels or poses, cut off or frozen
scans, labels of other ids or beyond the range that is labelled, points in millimetres, stamps out of
order, splits that name absent scans, counts other than published, and poses in another convention.
The latter is measured: pairs of scans are laid over one another under each convention, and the one in
which their surfaces overlap best is named, or those among which the scans cannot tell. Rows of poses
that are exchanged or off the way are named as well. A shift by one row can only be told where the
motion changes from scan to scan; the report says when it does not. All files are listed, some dozens
of scans are read.

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

std::string check_dataset(const DoctorFlags& options) {
  const Checkup checkup = check_up(
      options.input, {dataset_kind_option(options.dataset), options.sequences, options.reading});
  std::string report =
      options.json ? checkup_json(checkup) : checkup_text(checkup, options.input.string());
  if (checkup.has(Severity::kError)) throw Finding(report, 3);
  if (checkup.has(Severity::kWarning)) throw Finding(report);
  return report;
}

}  // namespace

void add_doctor_command(CLI::App& app, std::string& answer) {
  auto options = std::make_shared<DoctorFlags>();
  CLI::App* command = app.add_subcommand("doctor", "Find what is wrong with a data set");
  command->add_option("DATA", options->input, "Root of a data set, or one sequence folder")
      ->required();
  command->add_option("--dataset", options->dataset, "What DATA is, see run")
      ->capture_default_str();
  command->add_option("--sequences", options->sequences, "Names to look at, a,b (default: all)")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_flag("--json", options->json, "Print JSON instead of text");
  add_reading_flags(*command, options->reading);
  command->footer(kDoctorFooter);
  command->callback([options, &answer] { answer = check_dataset(*options); });
}

}  // namespace mosbench
