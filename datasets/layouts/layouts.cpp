#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "datasets/layouts/layout.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {

// The row of each data set stands in the file of its name.
const Layout& doals_layout();
const Layout& sipailou_layout();
const Layout& helimos_layout();
const Layout& semantickitti_layout();
const Layout& apollo_layout();
const Layout& moe_layout();
const Layout& kth_layout();
const Layout& mdetector_layout();
const Layout& opensceneflow_layout();
const Layout& nuscenes_layout();
const Layout& helipr_layout();
const Layout& kitti_raw_layout();
const Layout& kitti_tracking_layout();
const Layout& recording_layout();

std::span<const Layout* const> layouts() {
  static const std::array all = {
      &doals_layout(),          &sipailou_layout(), &helimos_layout(), &semantickitti_layout(),
      &apollo_layout(),         &moe_layout(),      &kth_layout(),     &mdetector_layout(),
      &opensceneflow_layout(),  &nuscenes_layout(), &helipr_layout(),  &kitti_raw_layout(),
      &kitti_tracking_layout(), &recording_layout()};
  return all;
}

const Layout& layout_of(DatasetKind kind) {
  return **std::ranges::find(layouts(), kind, &Layout::kind);
}

std::optional<std::filesystem::path> mark_folder_of(const LayoutWriter& writer,
                                                    const std::filesystem::path& place) {
  const bool is_file = *writer.last_file({}) == '\0';
  return is_file ? std::nullopt : std::optional(place);
}

std::string lost_stamps_text(std::size_t scans, const Layout& layout) {
  return fmt::format("the stamps of {} are left out: layout {} has none, its scans are 0.1 s apart",
                     counted(scans, "scan"), layout.name);
}

std::string dataset_kind_names() {
  std::string names;
  for (const Layout* row : layouts()) names += (names.empty() ? "" : ", ") + std::string(row->name);
  return names;
}

std::optional<DatasetKind> dataset_kind_from_string(std::string_view name) {
  for (const Layout* row : layouts()) {
    if (row->name == name) return row->kind();
  }
  return std::nullopt;
}

}  // namespace mosbench
