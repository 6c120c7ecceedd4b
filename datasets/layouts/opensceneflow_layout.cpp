#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <system_error>
#include <utility>

#include "datasets/disk/folder_listing.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/hdf5/flow_truth.hpp"
#include "datasets/hdf5/hdf5_file.hpp"
#include "datasets/hdf5/hdf5_module.hpp"
#include "datasets/hdf5/scene_flow_sequence.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/layouts/sequence_writer.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using Kind = Hdf5Number::Kind;

template <typename Value>
std::string_view bytes_of(const std::vector<Value>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)};
}

/// The ids of semantic-kitti.yaml that are ground: road, parking, sidewalk, other ground, lane
/// marking, terrain.
bool is_ground_id(std::uint32_t label) {
  const std::uint32_t id = label & 0xFFFFU;
  return id == 40 || id == 44 || id == 48 || id == 49 || id == 60 || id == 72;
}

/// The file beside the one that it becomes, which libhdf5 writes by its name.
class PartialHdf5 {
 public:
  PartialHdf5(fs::path file, const std::string& mark) : file_(std::move(file)) {
    const Hdf5Functions& functions = hdf5_functions(file_);
    try {
      fs::create_directories(fs::absolute(file_).parent_path());
      partial_.emplace(file_);
    } catch (const std::system_error& error) {
      throw not_written(file_, error.code().message());
    }
    check(functions.create(partial_->path(), output_));
    if (!mark.empty()) check(output_->add_mark(mark));
  }

  void add(const std::string& group, std::string_view name, const Hdf5Number& number,
           std::vector<std::uint64_t> shape, std::string_view bytes) {
    Hdf5Array array;
    array.name = name;
    array.number = number;
    array.shape = std::move(shape);
    check(output_->add(group, array, bytes));
  }

  void put_in_place() {
    check(output_->close());
    output_.reset();
    try {
      partial_->sync();
      partial_->put_in_place_of(file_);
    } catch (const std::system_error& error) {
      throw not_written(file_, error.code().message());
    }
    sync_names_of(fs::absolute(file_).parent_path());
  }

 private:
  void check(const std::string& error) const {
    if (!error.empty()) throw not_written(file_, error);
  }

  fs::path file_;
  std::optional<PartialFile> partial_;
  std::unique_ptr<Hdf5Output> output_;
};

/// Keeps frames until those before them are written, and the one after them is there, to which
/// their flow leads: the same frames give the same bytes.
class SceneFlowWriter : public SequenceWriter {
 public:
  SceneFlowWriter(fs::path file, std::string mark)
      : file_(std::move(file)), mark_(std::move(mark)) {
    hdf5_functions(file_);
  }

  void write(std::size_t scan_index, const Frame& frame) override {
    const std::lock_guard lock(mutex_);
    if (!output_) output_.emplace(file_, mark_);
    waiting_.emplace(scan_index, frame);
    for (auto next = waiting_.find(next_ + 1); next != waiting_.end();
         next = waiting_.find(next_ + 1)) {
      const auto first = waiting_.find(next_);
      if (first == waiting_.end()) return;
      add(first->second, &next->second);
      waiting_.erase(first);
      ++next_;
    }
  }

  void finish() override {
    for (const auto& [scan_index, frame] : waiting_) {
      next_ = scan_index;
      add(frame, nullptr);
    }
    waiting_.clear();
    if (!output_) output_.emplace(file_, mark_);
    output_->put_in_place();
  }

 private:
  void add(const Frame& frame, const Frame* next) {
    const std::int64_t stamp_ns = stamp_or_period_ns(next_, frame.stamp_ns);
    if (stamp_ns < 0 || (last_ns_ && stamp_ns <= *last_ns_)) {
      throw DataError(file_, "scan " + frame.stem + " is not later than the one before it",
                      "stamps from 0 on that increase, which name the groups");
    }
    last_ns_ = stamp_ns;
    group_ = std::to_string(stamp_ns);
    points_ = frame.points.size();
    add_points(frame.points);
    add_pose(scene_flow::kPose, frame.map_from_sensor);
    if (!frame.motions) {
      add_labels(frame);
    } else if (next == nullptr) {
      add_truths(scene_flow::kGround, frame.motions->on_ground);
    } else {
      add_motions(frame, step_to(frame, stamp_ns, *next));
    }
  }

  SensorStep step_to(const Frame& frame, std::int64_t stamp_ns, const Frame& next) const {
    return {next.map_from_sensor.inverse() * frame.map_from_sensor,
            static_cast<double>(stamp_or_period_ns(next_ + 1, next.stamp_ns) - stamp_ns) * 1e-9};
  }

  void add_points(const std::vector<Point>& points) {
    output_->add(group_, scene_flow::kLidar, {Kind::kReal, 4}, {points_, 4}, bytes_of(points));
  }

  void add_pose(std::string_view name, const Pose& pose) {
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = pose.matrix();
    output_->add(group_, name, {Kind::kReal, 8}, {4, 4},
                 {reinterpret_cast<const char*>(rows.data()), sizeof(double) * 16});
  }

  void add_truths(std::string_view name, const std::vector<std::uint8_t>& truths) {
    const std::vector<std::uint8_t> none(truths.empty() ? points_ : 0, 0);
    output_->add(group_, name, {Kind::kTruth, 1}, {points_},
                 bytes_of(truths.empty() ? none : truths));
  }

  /// Truth without speeds, and the ground by its ids.
  void add_labels(const Frame& frame) {
    std::vector<std::uint8_t> ground;
    if (frame.truth) {
      for (const std::uint32_t label : *frame.truth) ground.push_back(is_ground_id(label) ? 1 : 0);
      output_->add(group_, scene_flow::kLabel, {Kind::kUnsigned, 4}, {points_},
                   bytes_of(*frame.truth));
    }
    add_truths(scene_flow::kGround, ground);
  }

  void add_motions(const Frame& frame, const SensorStep& step) {
    const PointMotions& motions = *frame.motions;
    const std::vector<float> flow = flow_of(frame.points, motions.velocities_m_s, step);
    std::vector<std::uint8_t> valid;
    std::vector<std::int16_t> objects;
    for (std::size_t i = 0; i < points_; ++i) {
      const std::uint32_t label = frame.truth ? (*frame.truth)[i] : 0;
      valid.push_back(label != 0 && motions.velocities_m_s[i].allFinite() ? 1 : 0);
      objects.push_back(static_cast<std::int16_t>((label >> 16U) & 0x7FFFU));
    }
    std::vector<std::uint8_t> classes = motions.classes;
    classes.resize(points_);
    add_truths(scene_flow::kGround, motions.on_ground);
    output_->add(group_, scene_flow::kFlow, {Kind::kReal, 4}, {points_, 3}, bytes_of(flow));
    add_truths(scene_flow::kValid, valid);
    output_->add(group_, scene_flow::kClass, {Kind::kUnsigned, 1}, {points_}, bytes_of(classes));
    output_->add(group_, scene_flow::kInstance, {Kind::kInteger, 2}, {points_}, bytes_of(objects));
    add_pose(scene_flow::kEgoMotion, step.next_from_sensor);
    if (!motions.evaluated.empty()) add_truths(scene_flow::kEvaluated, motions.evaluated);
  }

  fs::path file_;
  std::string mark_;                   ///< that stays with the file; may be empty
  std::optional<PartialHdf5> output_;  ///< from the first frame on
  std::mutex mutex_;
  std::map<std::size_t, Frame> waiting_;
  std::size_t next_ = 0;  ///< the scan to be written
  std::optional<std::int64_t> last_ns_;
  std::string group_;  ///< of the scan that is being written
  std::size_t points_ = 0;
};

/// An empty or damaged file is known by its name, and opening it says what is wrong.
bool is_scene_flow_file(const std::filesystem::path& path) {
  std::error_code ignored;
  return is_hdf5_file(path) ||
         (path.extension() == ".h5" && std::filesystem::is_regular_file(path, ignored));
}

std::vector<SequenceFolder> list_scene_flow(const std::filesystem::path& path) {
  if (is_scene_flow_file(path)) return {{path.stem().string(), path, ""}};
  std::vector<SequenceFolder> sequences;
  if (!std::filesystem::is_directory(path)) return sequences;
  for (const StemFile& file : list_by_stem(path, {".h5"})) {
    if (is_scene_flow_file(file.file)) sequences.push_back({file.stem, file.file, ""});
  }
  return sequences;
}

std::unique_ptr<Sequence> open_scene_flow(const SequenceFolder& sequence, const Reading& asked) {
  return open_scene_flow_file(sequence.name, sequence.folder, asked);
}

/// The scans that Argoverse 2's benchmark evaluates have a mask of its own.
std::vector<Split> scene_flow_splits(const std::vector<SequenceFolder>& files,
                                     const std::vector<std::unique_ptr<Sequence>>& sequences,
                                     std::vector<std::string>&) {
  Split evaluated{"eval", {}};
  for (std::size_t i = 0; i < files.size(); ++i) {
    SplitPart part{i, std::set<std::string>{}};
    const auto scans = evaluated_scans(files[i].folder);
    for (std::size_t k = 0; k < sequences[i]->size(); ++k) {
      const std::string& stem = sequences[i]->stem(k);
      if (std::ranges::binary_search(scans, stem)) part.stems->insert(stem);
    }
    if (!part.stems->empty()) evaluated.parts.push_back(std::move(part));
  }
  if (evaluated.parts.empty()) return {};
  return {std::move(evaluated)};
}

std::optional<std::string> recognise_scene_flow(const std::filesystem::path& path) {
  const auto files = list_scene_flow(path);
  if (files.empty()) return std::nullopt;
  if (is_scene_flow_file(path)) return "it is an .h5 file";
  const bool any_whole = std::ranges::any_of(
      files, [](const SequenceFolder& file) { return is_hdf5_file(file.folder); });
  if (!any_whole) return std::nullopt;
  return fmt::format("{} .h5 files are there", files.size());
}

std::optional<std::string> recognise_damaged_scene_flow(const std::filesystem::path& path) {
  const auto files = list_scene_flow(path);
  if (files.empty()) return std::nullopt;
  return fmt::format("{}, none of them whole",
                     counted(files.size(), ".h5 file is there", ".h5 files are there"));
}

std::filesystem::path scene_flow_file(const std::string& name, std::size_t) {
  return flat_name(name) + ".h5";
}

/// The owner of movable things is their instance, an int16 there.
std::uint32_t simulated_scene_flow_label(const SimulatedReturn& seen) {
  constexpr std::uint32_t kInstances = 32768;
  const std::uint32_t label = moving_label(seen);
  if (label == 0 || !is_movable(seen.owner)) return label;
  return with_instance(label, seen.owner_number, kInstances);
}

}  // namespace

std::unique_ptr<SequenceWriter> write_as_scene_flow(const fs::path& file,
                                                    const WriteOptions& options) {
  return std::make_unique<SceneFlowWriter>(file, options.mark);
}

const Layout& opensceneflow_layout() {
  static const Layout row = {
      .name = "opensceneflow",
      .usual = {"opensceneflow", "sceneflow-dynamic"},
      .title = "OpenSceneFlow's .h5: Argoverse 2, Waymo, nuScenes, ZOD, TruckScenes",
      .content = "scenes of about 20 s with scene flow; ZOD and the test splits without",
      .size = "Argoverse 2 sensor: 700 + 150 + 150 scenes; Waymo: 799 + 203",
      .published = "made by the dataprocess scripts of github.com/KTH-RPL/OpenSceneFlow",
      .licence = kUnknownLicence,
      .folders = {"<root>/<scene>.h5, a group per scan, named by its stamp in ns or us:",
                  "  lidar (N, 3 or more), pose (4, 4) map_from_sensor, and where there are any",
                  "  ground_mask, flow (N, 3) to the next scan, flow_is_valid, ego_motion,",
                  "  flow_category_indices, flow_instance_id, eval_mask, dufo"},
      .files = {.sensor_range_m = 450.0},
      .expected = "an .h5 file of OpenSceneFlow, or a folder with such files",
      .list = list_scene_flow,
      .open = open_scene_flow,
      .no_point_times =
          [](const std::filesystem::path& file) {
            return file.string() +
                   " holds points that are moved to the stamp already, expected .bin files";
          },
      .splits = scene_flow_splits,
      .evidence = Evidence::kFolders,
      .recognise = recognise_scene_flow,
      .recognise_part = recognise_damaged_scene_flow,
      .writer = LayoutWriter{
          .open = write_as_scene_flow,
          .folder = scene_flow_file,
          .files = [](const Sequence&) { return std::vector<std::filesystem::path>(); },
          .last_file = [](const WriteOptions&) { return ""; }},
      .truth_by_speed = true,
      .simulation = LayoutSimulation{
          .recordings = {{"{}.h5", "{}", SensorKind::kHdl64e}},
          .truth = "Truth is the flow of rigid bodies from each scan to the next one.",
          .label = simulated_scene_flow_label,
          .has_flow = true}};
  return row;
}

}  // namespace mosbench
