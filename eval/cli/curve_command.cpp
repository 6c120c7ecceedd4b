#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "eval/answer/render.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/output_file.hpp"
#include "eval/report/curve_report.hpp"

namespace mosbench {
namespace {

constexpr const char* kCurveFooter =
    R"(RUN is a folder that `mosbench run --scores` wrote: the points, the truth and the score of every
point are read again, all scans that the protocol counts are pooled. A point counts as moving from a
threshold of its score on; sweeping it gives precision over recall, its area (average precision:
precision times the rise of recall, summed) and the threshold with the best IoU on these scans. The
labels of the run need not lie on the curve, because methods do more than compare a score. Results
without scores and those of `mosbench score` are refused (exit code 3).

Examples:
  mosbench curve results/runs/street    # of mosbench run sim/street --scores
  mosbench curve results/runs/street --as csv -o street.png > street.csv)";

struct CurveFlags {
  std::filesystem::path run;
  std::optional<std::filesystem::path> dataset_root, picture;
};

Answer curve(const CurveFlags& options) {
  if (options.picture) check_output(*options.picture);
  Answer answer = curve_answer(curve_of_run(options.run, options.dataset_root));
  if (options.picture) write_output(*options.picture, render(answer, Format::kPng));
  return answer_beside(options.picture.value_or(""), std::move(answer));
}

}  // namespace

CommandRun add_curve(CLI::App& command) {
  auto options = std::make_shared<CurveFlags>();
  command.add_option("RUN", options->run, "Folder that `mosbench run --scores` wrote")
      ->type_name("DIR")
      ->required();
  command
      .add_option("--data", options->dataset_root,
                  "Folder of the data set (default: where the run read it)")
      ->type_name("DIR");
  command.add_option("-o,--out", options->picture, "PNG file to draw the curve to; - is stdout")
      ->type_name("FILE");
  command.footer(kCurveFooter);
  return [options] { return curve(*options); };
}

}  // namespace mosbench
