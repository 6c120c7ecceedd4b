#include "eval/tables/paper_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {

std::span<const PaperTable> paper_tables() {
  static const std::array<PaperTable, 6> kTables = {
      PaperTable{"I",
                 "DOALS, moving IoU in % (paper, Table I)",
                 DatasetKind::kDoals,
                 "mean of the 20 labelled scans of a place's two sequences",
                 {{"ST", {"station/sequence_1", "station/sequence_2"}, 20},
                  {"SV", {"shopville/sequence_1", "shopville/sequence_2"}, 20},
                  {"HG", {"hauptgebaeude/sequence_1", "hauptgebaeude/sequence_2"}, 20},
                  {"ND", {"niederdorf/sequence_1", "niederdorf/sequence_2"}, 20}},
                 "DOALS (DOI 10.3929/ethz-c-000788171), its bags or scans exported from them"},
      PaperTable{"II",
                 "Sipailou Campus, moving IoU in % (paper, Table II)",
                 DatasetKind::kSipailou,
                 "all points of a split pooled: valid is sequence 06, test 00 and 07",
                 {{"valid", {"06"}, 3191}, {"test", {"00", "07"}, 6201}},
                 "Sipailou Campus (github.com/xieKKKi/MotionBEV)"},
      PaperTable{"III",
                 "HeLiMOS, moving IoU in % (paper, Table III)",
                 DatasetKind::kHelimos,
                 "points pooled per sensor; Avg is the plain mean of the four",
                 {{"L", {"Avia"}, std::nullopt},
                  {"A", {"Aeva"}, std::nullopt},
                  {"O", {"Ouster"}, std::nullopt},
                  {"V", {"Velodyne"}, 3164, "helimos-all"},
                  {"Avg", {"Avia", "Aeva", "Ouster", "Velodyne"}, std::nullopt}},
                 "HeLiMOS (github.com/url-kaist/HeLiMOS-PointCloud-Toolbox)"},
      PaperTable{"apollo",
                 "Apollo, moving IoU in % (HMM-MOS README)",
                 DatasetKind::kApollo,
                 "all points of both sequences pooled",
                 {{"IoU", {"00", "03"}, 2500}},
                 "Apollo LiDAR-MOS, sequences 00 and 03 (www.ipb.uni-bonn.de)"},
      PaperTable{"moe",
                 "MOE, moving IoU in % (HMM-MOS README)",
                 DatasetKind::kMoe,
                 "points pooled per sequence",
                 {{"00", {"00"}, std::nullopt},
                  {"01", {"01"}, std::nullopt},
                  {"02", {"02"}, std::nullopt}},
                 "MOE (github.com/DeepDuke/MOE-Dataset)"},
      PaperTable{"mdetector",
                 "M-detector's sets, moving IoU in % (HMM-MOS README)",
                 DatasetKind::kMdetector,
                 "points pooled per sequence, mean of sequences",
                 {{"Avia", {"Avia"}, std::nullopt},
                  {"KITTI", {"KITTI"}, std::nullopt},
                  {"nuScenes", {"nuScenes"}, std::nullopt},
                  {"Waymo", {"Waymo"}, std::nullopt}},
                 "M-detector's four sets (github.com/hku-mars/M-detector), one folder each"}};
  return kTables;
}

const PaperTable& paper_table_named(std::string_view name) {
  const auto found = std::ranges::find(
      paper_tables(), lower_case(std::string(name)),
      [](const PaperTable& table) { return lower_case(std::string(table.name)); });
  if (found != paper_tables().end()) return *found;
  throw UsageError(
      fmt::format("table: '{}' is not known, expected I, II, III, apollo, moe or mdetector", name));
}

bool contains(const TableColumn& column, const std::string& sequence) {
  return std::ranges::any_of(column.sequences, [&](std::string_view name) {
    return sequence == name || sequence.starts_with(std::string(name) + '/');
  });
}

bool contains(const PaperTable& table, const std::string& sequence) {
  return std::ranges::any_of(table.columns,
                             [&](const TableColumn& column) { return contains(column, sequence); });
}

}  // namespace mosbench
