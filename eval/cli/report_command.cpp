#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "datasets/text/counted.hpp"
#include "datasets/text/errors.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/output_file.hpp"
#include "eval/report/report.hpp"

namespace mosbench {
namespace {

constexpr const char* kReportFooter =
    R"(Writes one HTML file that opens in any browser without network or server: the scans in 3-D with
true and false points, charts over the scans, tables and provenance. RESULT is a folder that
`mosbench run` or `mosbench score --out` wrote, a folder above such ones (that of a run of several
methods), or a result.json. Several runs of the same scans are ranked in a leaderboard; a menu puts
up to six of them side by side, and a colour shows where they disagree. Runs with --scores have
their precision over recall drawn. Points and labels are read again from where they were read,
or points from --data.

--scans takes a list of K (that scan), A-B (from A to B), every:N (each N-th) and worst:N (the N
worst), counted from 0, or one of
  auto   the worst tenth first, then scans spread evenly, as many as fit (default)
  all    from the first scan on, as many as fit
  none   numbers only; needs neither data set nor labels
The file says what was left out.

Examples:
  mosbench report results/runs/doals -o report.html
  mosbench report results/runs/online results/runs/delayed -o compare.html --scans worst:20
  mosbench report results/runs/all results/runs/4dmos -o methods.html
  mosbench report results/runs/sipailou -o small.html --scans 100-149,every:50 --max-mb 10
  mosbench report results/runs/helimos -o moved.html --data ~/HeLiMOS/Deskewed_LiDAR)";

struct ReportFlags {
  std::vector<std::filesystem::path> inputs;
  std::filesystem::path out;
  std::string scans = "auto";
  ReportOptions report;
};

Answer write_report(ReportFlags& options) {
  check_output(options.out);
  options.report.scans = ScanChoice(options.scans);
  const Report report = build_report(options.inputs, options.report);
  write_output(options.out, report.html);
  std::string text =
      fmt::format("report of {} in {}, {:.1f} MB\n", counted(report.results, "result"),
                  options.out.string(), static_cast<double>(report.html.size()) / 1e6);
  for (const std::string& remark : report.remarks) text += remark + '\n';
  return answer_beside(options.out, {text});
}

}  // namespace

CommandRun add_report(CLI::App& command) {
  auto options = std::make_shared<ReportFlags>();
  command
      .add_option("RESULT", options->inputs,
                  "Folders that `mosbench run` or `mosbench score` wrote")
      ->type_name("DIR")
      ->required();
  command.add_option("-o,--out", options->out, "HTML file to write; - is stdout")
      ->type_name("FILE")
      ->required();
  command
      .add_option("--data", options->report.dataset_root,
                  "Folder of the data set (default: where the run read it)")
      ->type_name("DIR");
  command.add_option("--scans", options->scans, "Scans to show in 3-D")
      ->type_name("SCANS")
      ->capture_default_str();
  command.add_option("--max-mb", options->report.max_mb, "Largest size of the file, 1e6 bytes")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  command.footer(kReportFooter);
  return [options] { return write_report(*options); };
}

}  // namespace mosbench
