#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "datasets/disk/files.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/help_text.hpp"
#include "eval/tables/table_report.hpp"

namespace mosbench {
namespace {

constexpr const char* kTableFooter =
    R"(Prints a published table with the values measured here next to it: published, measured, difference,
95 % interval, and a verdict: within (the published value lies in the interval), outside, or not
comparable, with the reasons (simulated data, another protocol or setting, missing scans). Cells
without results say what to download and which command fills them.

RESULTS are folders that `mosbench run` or `mosbench score --out` wrote; a method named by
`score --method` becomes a row, too. Published numbers come from results/published.csv.

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

CommandRun add_table(CLI::App& command) {
  auto options = std::make_shared<TableFlags>();
  command.add_option("TABLE", options->name, "I, II, III, apollo, moe or mdetector")->required();
  command.add_option("RESULTS", options->results, "Folders of results")->type_name("DIR");
  command
      .add_option("--published", options->published,
                  "CSV of published numbers, instead of the built-in ones")
      ->type_name("FILE");
  command.add_option("--format", options->format, "Of what is printed")
      ->type_name(type_of_names({"markdown", "csv", "latex", "json"}))
      ->capture_default_str();
  command.footer(kTableFooter);
  return [options] { return Answer{table(*options)}; };
}

}  // namespace mosbench
