#include "eval/tables/table_report.hpp"

#include <fmt/format.h>

#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/results/tell.hpp"
#include "eval/tables/table_print.hpp"

namespace mosbench {

TableFormat table_format_named(std::string_view name) {
  if (name == "markdown") return TableFormat::kMarkdown;
  if (name == "csv") return TableFormat::kCsv;
  if (name == "latex") return TableFormat::kLatex;
  if (name == "json") return TableFormat::kJson;
  throw UsageError(
      fmt::format("--format: '{}' is not known, expected markdown, csv, latex or json", name));
}

std::string table_report(const PaperTable& table, const std::vector<PublishedCell>& published,
                         const std::vector<ResultSet>& runs, TableFormat format) {
  for (const std::string& sentence : left_out(table, runs)) tell(sentence);
  const FilledTable filled = fill_table(table, published, runs);
  switch (format) {
    case TableFormat::kCsv:
      return table_csv(filled);
    case TableFormat::kLatex:
      return table_latex(filled);
    case TableFormat::kJson:
      return json_text(to_json(filled));
    case TableFormat::kMarkdown:
      break;
  }
  return table_markdown(filled);
}

}  // namespace mosbench
