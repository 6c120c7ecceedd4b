#include <CLI/CLI.hpp>
#include <memory>

#include "core/base/thread_pool.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/result/machine.hpp"
#include "eval/result/output.hpp"
#include "eval/result/tell.hpp"
#include "eval/tables/profile_print.hpp"

namespace mosbench {
namespace {

struct ProfileFlags {
  JobWords method;
  unsigned threads = hardware_threads();
  std::optional<std::filesystem::path> json, trace;
};

Answer profile(const ProfileFlags& options) {
  if (options.json == "-" && options.trace == "-") {
    throw UsageError("--json and --out: both go to stdout, expected one of them to name a file");
  }
  for (const auto& file : {options.json, options.trace}) {
    if (file) check_output(*file, Format::kJson);
  }
  keep_freed_memory();
  const RunPlan plan = open_job(job_of(options.method), options.threads);
  for (const std::string& note : plan.notes) tell(note);
  std::vector<SequenceProfile> profiles;
  for (const auto& sequence : plan.dataset.sequences) {
    profiles.push_back(profile_sequence(*sequence, plan.settings));
  }
  if (options.json) write_output(*options.json, json_text(profile_json(plan, profiles)));
  if (options.trace) write_output(*options.trace, json_text(profile_trace(profiles)));
  return answer_beside(options.trace == "-" ? "-" : options.json.value_or(""),
                       profile_answer(plan, profiles));
}

}  // namespace

CommandRun add_profile(CLI::App& command) {
  auto options = std::make_shared<ProfileFlags>();
  add_method_flags(command, options->method, options->threads);
  add(command, "--json FILE", options->json, "Write the numbers to this file; - is stdout");
  add(command, "-o,--out FILE", options->trace, "Write a trace to this file; - is stdout");
  return [options] { return profile(*options); };
}

}  // namespace mosbench
