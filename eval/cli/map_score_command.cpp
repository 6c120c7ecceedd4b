#include <CLI/CLI.hpp>
#include <memory>

#include "eval/answer/answer_text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/static_map/map_score.hpp"

namespace mosbench {
namespace {

constexpr const char* kMapScoreFooter =
    R"(MAP is a map from which a method removed what moved, TRUTH the points that it was made of, in the
same frame, with intensity 1 for dynamic points and 0 for others; of a sequence of KTH's
DynamicMap_Benchmark the folder, too. Both are .pcd or .ply files.

Static accuracy SA is the share of static points that the map still has, dynamic accuracy DA that
of dynamic points that it no longer has, AA = sqrt(SA * DA), HA = 2 SA DA / (SA + DA): so that
benchmark defines them. A map with fewer points than the scans, as one of voxels, loses SA;
--same-within-m says how near a point of the map must be to stand for one of the truth.

`mosbench run --write static-cloud` writes such a map, static.ply (static-cloud-pcd: static.pcd),
with a point per 0.1 m, in the frame of the poses: --same-within-m 0.1 suits it.

Examples:
  mosbench map-score results/runs/00/00/static.ply kth/00 --same-within-m 0.1
  mosbench map-score cleaned.pcd kth/00
  mosbench map-score cleaned.ply gt_cloud.pcd --same-within-m 0.1 --json)";

struct MapScoreFlags {
  std::filesystem::path map, truth;
  double same_within_m = kSameWithin_m;
};

Answer map_score(const MapScoreFlags& flags) {
  const MapScore score = score_map(flags.map, flags.truth, flags.same_within_m);
  return {.sheets = {map_score_sheet(score)}, .json = json_text(map_score_json(score))};
}

}  // namespace

CommandRun add_map_score(CLI::App& command) {
  auto flags = std::make_shared<MapScoreFlags>();
  command.add_option("MAP", flags->map, "Map without what moved")->type_name("FILE")->required();
  command.add_option("TRUTH", flags->truth, "Points with intensity 1 where they are dynamic")
      ->type_name("FILE|DIR")
      ->required();
  command
      .add_option("--same-within-m", flags->same_within_m,
                  "Largest distance of a point of the map that stands for one of the truth, m")
      ->check(CLI::Range(1e-6, 1e3))
      ->capture_default_str();
  command.footer(kMapScoreFooter);
  return [flags] { return map_score(*flags); };
}

}  // namespace mosbench
