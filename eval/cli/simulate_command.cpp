#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "datasets/simulator/simulate.hpp"
#include "datasets/simulator/simulated_sequence.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/dataset_flags.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

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
  return [options] { return Answer{simulate_dataset(*options)}; };
}

}  // namespace mosbench
