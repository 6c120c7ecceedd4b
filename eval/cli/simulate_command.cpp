#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "datasets/perturb/perturbation.hpp"
#include "datasets/simulator/simulate.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
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
  const auto& perturb = options.simulation.perturb;
  return fmt::format("simulated {} of scene {}, seed {}{}, as {} in {}\n",
                     counted(options.simulation.scans, "scan"), options.simulation.scene,
                     options.simulation.seed,
                     perturb ? ", disturbed by " + to_string(*perturb) : "", options.layout,
                     options.simulation.out.string());
}

}  // namespace

CommandRun add_simulate(CLI::App& command) {
  auto options = std::make_shared<SimulateFlags>();
  SimulateOptions& simulation = options->simulation;
  add(command, "--layout LAYOUT", options->layout, simulated_layout_names())->required();
  add(command, "--scene SCENE", simulation.scene, "Name of a scene, or a JSON file")->required();
  add(command, "--scans", simulation.scans, "Scans per sequence")
      ->required()
      ->check(CLI::Range(std::size_t{1}, std::size_t{1000000}));
  add(command, "--seed", simulation.seed, "Seed of everything random")
      ->required()
      ->check(number_in(0.0, 18446744073709551615.0));
  add(command, "--out DIR", simulation.out, "Root of the data set to write")->required();
  const auto perturb = [options](const std::string& text) {
    options->simulation.perturb = parse_perturbation(text);
  };
  add(command, "--perturb KIND=STRENGTH,...,seed=N", perturb,
      "Disturb what is written, in this order, see `mosbench list perturbations`");
  add_threads_flag(command, simulation.threads);
  return [options] { return Answer{simulate_dataset(*options)}; };
}

}  // namespace mosbench
