#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "datasets/files/files.hpp"
#include "eval/cli/commands.hpp"
#include "eval/tables/table_report.hpp"

namespace mosbench {
namespace {

constexpr const char* kTableFooter =
    R"(Prints a published table with what was measured here beside it: published, measured, difference, 95 %
interval, and a verdict: within (the published value lies in the interval), outside, or not comparable
with the reasons (simulated data, another protocol, variant or setting, scans missing). Cells without
results say what to download and which command fills them.

RESULTS are folders that `mosbench run` or `mosbench score --out` wrote; a method that `score --method`
named becomes a row, too. Published numbers come from results/published.csv.

Examples:
  mosbench table I
  mosbench table III results/runs/helimos results/runs/4dmos-delayed --format latex
  mosbench table II results/runs/sipailou --format csv > table2.csv)";

struct TableFlags {
  std::string name;
  std::vector<std::string> results;
  std::optional<std::filesystem::path> published;
  std::string format = "markdown";
};

std::string table(const TableFlags& options) {
  std::vector<ResultSet> runs;
  for (const std::string& path : options.results) {
    for (ResultSet& run : load_result_sets(path)) runs.push_back(std::move(run));
  }
  const std::vector<PublishedCell> published =
      options.published ? parse_published(read_file(*options.published), *options.published)
                        : built_in_cells();
  return table_report(paper_table_named(options.name), published, runs,
                      table_format_named(options.format));
}

}  // namespace

void add_table_command(CLI::App& app, std::string& answer) {
  auto options = std::make_shared<TableFlags>();
  CLI::App* command =
      app.add_subcommand("table", "A published table with measured values beside it");
  command->add_option("TABLE", options->name, "I, II, III, apollo, moe or mdetector")->required();
  command->add_option("RESULTS", options->results, "Folders of results");
  command->add_option("--published", options->published,
                      "Published numbers in place of the built-in");
  command->add_option("--format", options->format, "markdown, csv, latex or json")
      ->capture_default_str();
  command->footer(kTableFooter);
  command->callback([options, &answer] { answer = table(*options); });
}

}  // namespace mosbench
