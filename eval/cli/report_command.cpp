#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "eval/cli/commands.hpp"
#include "eval/report/report.hpp"

namespace mosbench {
namespace {

constexpr const char* kReportFooter =
    R"(Writes one HTML file that opens in any browser without network or server: the scans in 3-D with true and
false points, charts over the scans, tables and provenance. RESULT is a folder that `mosbench run`
wrote, one above it, or a result.json. Results of the same scans can be looked at side by side. Points are read again
from where the run read them, or from --data.

--scans takes a list of K (that one scan), A-B (from A to B), every:N and worst:N (so many), counted from 0,
or one of
  auto   the worst tenth first, then scans spread evenly, as many as fit (default)
  all    from the first on, as many as fit
  none   only numbers; needs neither data set nor labels, so results of `mosbench score` do, too
What was left out stands in the file.

Examples:
  mosbench report results/runs/doals -o report.html
  mosbench report results/runs/online results/runs/delayed -o compare.html --scans worst:20
  mosbench report results/runs/sipailou -o small.html --scans 100-149,every:50 --max-mb 10
  mosbench report results/runs/helimos -o moved.html --data ~/HeLiMOS/Deskewed_LiDAR)";

struct ReportFlags {
  std::vector<std::filesystem::path> inputs;
  std::filesystem::path out;
  std::string scans = "auto";
  ReportOptions report;
};

std::string write_report(ReportFlags& options) {
  options.report.scans = ScanChoice(options.scans);
  const Report report = build_report(options.inputs, options.report);
  write_file_atomic(options.out, report.html);
  std::string text = fmt::format("report of {} {} in {}, {:.1f} MB\n", report.results,
                                 report.results == 1 ? "result" : "results", options.out.string(),
                                 static_cast<double>(report.html.size()) / 1e6);
  for (const std::string& remark : report.remarks) text += remark + '\n';
  return text;
}

}  // namespace

void add_report_command(CLI::App& app, std::string& answer) {
  auto options = std::make_shared<ReportFlags>();
  CLI::App* command = app.add_subcommand("report", "Write an HTML page to look at results");
  command->add_option("RESULT", options->inputs, "Folders of mosbench run")->required();
  command->add_option("-o,--out", options->out, "The file to write")->required();
  command->add_option("--data", options->report.dataset_root,
                      "Where the scans are (default: where the run read them)");
  command->add_option("--scans", options->scans, "Scans to show in 3-D")->capture_default_str();
  command->add_option("--max-mb", options->report.max_mb, "Largest file, 1e6 bytes")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  command->footer(kReportFooter);
  command->callback([options, &answer] { answer = write_report(*options); });
}

}  // namespace mosbench
