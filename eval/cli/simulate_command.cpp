#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "datasets/simulator/simulate.hpp"
#include "datasets/simulator/simulated_layouts.hpp"
#include "datasets/text/counted.hpp"
#include "datasets/text/errors.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/dataset_flags.hpp"
#include "eval/results/progress.hpp"
#include "eval/results/tell.hpp"

namespace mosbench {
namespace {

constexpr const char* kSimulateFooter =
    R"(Writes a data set with exact truth in the layout of a real one. The same scene, seed and number of
scans give the same files for any number of threads. `mosbench list scenes` shows the built-in
scenes. For a scene of your own, simulate one scan of a similar one, edit the scene.json that is
written next to the scans, and pass that file as SCENE. Errors name the key that is missing, unknown
or out of range.

Examples:
  mosbench simulate --layout semantickitti --scene street --scans 40 --seed 1 --out sim/street
  mosbench simulate --layout doals --scene mall --scans 100 --seed 7 --out sim/doals
  mosbench simulate --layout doals --scene mall --scans 9 --seed 7 --out fog --perturb fog_per_m=0.1
  mosbench simulate --layout helimos --scene street --scans 1 --seed 1 --out near
  cp near/scene.json my_street.json
  mosbench simulate --layout helimos --scene my_street.json --scans 200 --seed 1 --out sim/helimos)";

struct SimulateFlags {
  std::string layout;
  SimulateOptions simulation;
};

std::string simulate_dataset(SimulateFlags options) {
  const std::optional<DatasetKind> layout = simulated_layout_from_string(options.layout);
  if (!layout) {
    throw UsageError(fmt::format("--layout: '{}' is not known, expected {}", options.layout,
                                 simulated_layout_names()));
  }
  options.simulation.layout = *layout;
  std::optional<Progress> progress;
  const auto count = [&](std::size_t, std::size_t total) {
    if (!progress) progress.emplace("simulate", total);
    progress->advance();
  };
  for (const std::string& sentence : simulate(options.simulation, count)) tell(sentence);
  return fmt::format("simulated {} of scene {}, seed {}, as {} in {}\n",
                     counted(options.simulation.scans, "scan"), options.simulation.scene,
                     options.simulation.seed, options.layout, options.simulation.out.string());
}

}  // namespace

CommandRun add_simulate(CLI::App& command) {
  auto options = std::make_shared<SimulateFlags>();
  SimulateOptions& simulation = options->simulation;
  command.add_option("--layout", options->layout, simulated_layout_names())
      ->type_name("LAYOUT")
      ->required();
  command.add_option("--scene", simulation.scene, "Name of a scene, or a JSON file")
      ->type_name("SCENE")
      ->required();
  command.add_option("--scans", simulation.scans, "Scans per sequence")
      ->required()
      ->check(CLI::Range(std::size_t{1}, std::size_t{1000000}));
  command.add_option("--seed", simulation.seed, "Seed of everything random")
      ->required()
      ->check(CLI::NonNegativeNumber);
  command.add_option("--out", simulation.out, "Root of the data set to write")
      ->type_name("DIR")
      ->required();
  add_perturb_flag(command, simulation.perturb, "Disturb what is written");
  add_threads_flag(command, simulation.threads);
  command.footer(kSimulateFooter);
  return [options] { return Answer{simulate_dataset(*options)}; };
}

}  // namespace mosbench
