#include <CLI/CLI.hpp>
#include <memory>

#include "datasets/doctor/doctor.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/result/tell.hpp"
#include "eval/tables/checkup_print.hpp"

namespace mosbench {
namespace {

Answer check_dataset(const DataWords& words) {
  Data data = data_of(words);
  const Checkup checkup =
      check_up(data.path, {data.kind, data.sequences, data.reading}, caller().at_each_scan);
  data.reading = checkup.remedy().applied_to(data.reading);
  return {.text = checkup_text(checkup, to_words(data)),
          .exit_code = checkup.has(Severity::kError)     ? 3
                       : checkup.has(Severity::kWarning) ? 1
                                                         : 0,
          .json = checkup_json(checkup)};
}

}  // namespace

CommandRun add_doctor(CLI::App& command) {
  auto words = std::make_shared<DataWords>();
  add_dataset_flags(command, *words);
  return [words] { return check_dataset(*words); };
}

}  // namespace mosbench
