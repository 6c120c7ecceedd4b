#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "datasets/files/errors.hpp"
#include "datasets/simulator/simulate.hpp"
#include "eval/cli/commands.hpp"
#include "eval/results/progress.hpp"

namespace mosbench {
namespace {

constexpr const char* kSimulateFooter =
    R"(Writes a data set with exact truth in the layout of a real one. The same scene, seed and number of
scans give the same files, whatever the number of threads. `mosbench list scenes` shows the scenes
that need no file; FILE is a scene of your own in JSON. Every data set is written with its scene as
scene.json: simulate one scan of a scene that comes near, change that file and pass it. A key that is
missing, unknown or out of range is named.

Examples:
  mosbench simulate --layout semantickitti --scene street --scans 40 --seed 1 --out sim/street
  mosbench simulate --layout doals --scene mall --scans 100 --seed 7 --out sim/doals
  mosbench simulate --layout helimos --scene street --scans 1 --seed 1 --out near && cp near/scene.json my_street.json
  mosbench simulate --layout helimos --scene my_street.json --scans 200 --seed 1 --out sim/helimos)";

struct SimulateFlags {
  std::string layout;
  SimulateOptions simulation;
};

std::string simulate_dataset(SimulateFlags options) {
  const std::optional<DatasetKind> layout = dataset_kind_from_string(options.layout);
  if (!layout || !is_written(*layout)) {
    throw UsageError(fmt::format(
        "--layout: '{}' is not known, expected doals, sipailou, helimos or semantickitti",
        options.layout));
  }
  options.simulation.layout = *layout;
  std::optional<Progress> progress;
  simulate(options.simulation, [&](std::size_t, std::size_t total) {
    if (!progress) progress.emplace("simulate", total);
    progress->advance();
  });
  return fmt::format("simulated {} scans of scene {}, seed {}, as {} in {}\n",
                     options.simulation.scans, options.simulation.scene, options.simulation.seed,
                     options.layout, options.simulation.out.string());
}

}  // namespace

void add_simulate_command(CLI::App& app, std::string& answer) {
  auto options = std::make_shared<SimulateFlags>();
  SimulateOptions& simulation = options->simulation;
  CLI::App* command = app.add_subcommand("simulate", "Write a simulated data set with exact truth");
  command->add_option("--layout", options->layout, "doals, sipailou, helimos or semantickitti")
      ->required();
  command->add_option("--scene", simulation.scene, "Name of a scene, or a JSON file")->required();
  command->add_option("--scans", simulation.scans, "Scans per sequence")
      ->required()
      ->check(CLI::Range(std::size_t{1}, std::size_t{1000000}));
  command->add_option("--seed", simulation.seed, "Of everything random")
      ->required()
      ->check(CLI::NonNegativeNumber);
  command->add_option("--out", simulation.out, "Becomes the root of the data set")->required();
  command->add_option("--threads", simulation.threads, "Files do not depend on it (default: all)")
      ->check(CLI::Range(1U, 1024U));
  command->footer(kSimulateFooter);
  command->callback([options, &answer] { answer = simulate_dataset(*options); });
}

}  // namespace mosbench
