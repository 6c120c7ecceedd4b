
#include <CLI/CLI.hpp>
#include <memory>

#include "datasets/disk/files.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/result/tell.hpp"
#include "eval/tables/table_print.hpp"

namespace mosbench {
namespace {

struct TableFlags {
  std::string name;
  std::vector<std::string> results;
  std::optional<std::filesystem::path> published;
  bool allow_stale = false;
};

Answer table(const TableFlags& options) {
  std::vector<ResultSet> runs;
  for (const std::string& path : options.results) {
    for (ResultSet& run : load_result_sets(path)) runs.push_back(std::move(run));
  }
  refuse_stale(runs, options.allow_stale);
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
  add(command, "TABLE", options->name, "I, II, III, apollo, moe or mdetector")->required();
  add(command, "RESULTS DIR", options->results, "Folders of results");
  add(command, "--published FILE", options->published,
      "CSV of published numbers, instead of the built-in ones");
  add_stale_flag(command, options->allow_stale);
  return [options] { return table(*options); };
}

}  // namespace mosbench
