#include "eval/cli/method_options.hpp"

#include "eval/cli/reading_flags.hpp"

namespace mosbench {

void add_method_options(CLI::App& command, RunOptions& options) {
  command.add_option("DATA", options.input, "Root of a data set, or one sequence folder")
      ->required();
  command.add_option("--dataset", options.dataset, "auto, " + dataset_kind_names())
      ->capture_default_str();
  command.add_option("--sequences", options.sequences, "Names to run, a,b (default: all)")
      ->delimiter(',')
      ->allow_extra_args(false);
  command.add_option("--method", options.method,
                     "One that `mosbench list methods` shows (default: hmm-mos)");
  command.add_option("--preset", options.preset, "Published settings (default: by data set)");
  command.add_option("--variant", options.variant,
                     "Short for --set variant=NAME: paper-2024 (default) or release-2025");
  command.add_option("--config", options.config_file, "JSON object of settings of the method");
  command.add_option("--set", options.assignments, "key=value ..., over everything else")
      ->allow_extra_args(false);
  add_reading_flags(command, options.reading);
  command.add_option("--threads", options.threads, "Results do not depend on it (default: all)")
      ->check(CLI::Range(1U, 1024U));
}

}  // namespace mosbench
