#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "datasets/doctor/doctor.hpp"
#include "eval/cli/checkup_report.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/dataset_flags.hpp"
#include "eval/job/job_words.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

struct DoctorFlags {
  std::filesystem::path input;
  std::string dataset = "auto";
  std::vector<std::string> sequences;
  Reading reading;
};

Answer check_dataset(const DoctorFlags& options) {
  const Checkup checkup = check_up(
      options.input, {dataset_kind_option(options.dataset), options.sequences, options.reading},
      caller().at_each_scan);
  return {.text = checkup_text(
              checkup, to_words(Data{.path = options.input,
                                     .kind = dataset_kind_option(options.dataset),
                                     .sequences = options.sequences,
                                     .reading = checkup.remedy().applied_to(options.reading)})),
          .exit_code = checkup.has(Severity::kError)     ? 3
                       : checkup.has(Severity::kWarning) ? 1
                                                         : 0,
          .json = checkup_json(checkup)};
}

}  // namespace

CommandRun add_doctor(CLI::App& command) {
  auto options = std::make_shared<DoctorFlags>();
  add_dataset_flags(command, options->input, options->dataset, options->sequences,
                    options->reading);
  return [options] { return check_dataset(*options); };
}

}  // namespace mosbench
