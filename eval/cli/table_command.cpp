#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "datasets/disk/files.hpp"
#include "eval/cli/commands.hpp"
#include "eval/results/tell.hpp"
#include "eval/tables/table_print.hpp"

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
  mosbench table III results/runs/helimos results/runs/4dmos-delayed --as latex
  mosbench table II results/runs/sipailou --as csv > table2.csv)";

struct TableFlags {
  std::string name;
  std::vector<std::string> results;
  std::optional<std::filesystem::path> published;
};

Answer table(const TableFlags& options) {
  std::vector<ResultSet> runs;
  for (const std::string& path : options.results) {
    for (ResultSet& run : load_result_sets(path)) runs.push_back(std::move(run));
  }
  const std::vector<PublishedCell> published =
      options.published ? parse_published(read_file(*options.published), *options.published)
                        : built_in_cells();
  const PaperTable& paper = paper_table_named(options.name);
  for (const std::string& sentence : left_out(paper, runs)) tell(sentence);
  return table_answer(fill_table(paper, published, runs));
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
  command.footer(kTableFooter);
  return [options] { return table(*options); };
}

}  // namespace mosbench
