#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "datasets/text/text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/report/report.hpp"
#include "eval/result/output.hpp"

namespace mosbench {
namespace {

struct ReportFlags {
  std::vector<std::filesystem::path> inputs;
  std::filesystem::path out;
  std::string scans = "auto";
  ReportOptions report;
};

Answer write_report(ReportFlags& options) {
  check_output(options.out, Format::kHtml);
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
  add(command, "RESULT DIR", options->inputs,
      "Folders that `mosbench run` or `mosbench score` wrote")
      ->required();
  add(command, "-o,--out FILE", options->out, "HTML file to write; - is stdout")->required();
  add(command, "--data DIR", options->report.dataset_root,
      "Folder of the data set (default: where the run read it)");
  add(command, "--scans SCANS", options->scans, "Scans to show in 3-D")->capture_default_str();
  add(command, "--max-mb", options->report.max_mb, "Largest size of the file, 1e6 bytes")
      ->check(number_in(0.1, 1000.0))
      ->capture_default_str();
  return [options] { return write_report(*options); };
}

}  // namespace mosbench
