#include "datasets/layouts/convert.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "datasets/disk/claim.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/formats/kitti_calib.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/sequence/simulated_origin.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

fs::path mark_of(const fs::path& root) { return partial_of(root / "convert"); }

void refuse_foreign(const fs::path& root, const std::set<fs::path>& expected) {
  const std::string mark = mark_of(root).filename();
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    const fs::path name = entry.path().lexically_relative(root);
    const std::string file = name.filename();
    const bool is_folder = entry.is_directory() && !entry.is_symlink();
    if (is_folder || file == mark || expected.contains(name)) continue;
    if (file.ends_with(partial_of("").native())) continue;
    throw UsageError(entry.path().string() +
                     ": is no file of this conversion, expected an empty folder in " +
                     option("out"));
  }
}

/// Marks a folder to which `convert` writes, until all is written. `statement` says what is
/// converted from where to what: the same conversion may go on after a kill.
class UnfinishedConversion {
 public:
  /// `expected` are the files that the conversion writes, named from `root`. Throws UsageError when
  /// the folder holds another one, or another conversion was not finished there.
  UnfinishedConversion(const fs::path& root, const std::string& statement,
                       const std::set<fs::path>& expected)
      : root_(root), is_resumed_(is_unfinished_conversion(root)) {
    if (!is_resumed_) {
      refuse_foreign(root, {});
      commit_file(mark_of(root), statement);
    } else if (read_file(mark_of(root)) == statement) {
      refuse_foreign(root, expected);
    } else {
      throw UsageError(root.string() +
                       ": holds an unfinished conversion of other files or to another layout, "
                       "expected an empty folder in " +
                       option("out"));
    }
  }

  /// Removes the mark: all is written.
  void finish() const {
    fs::remove(mark_of(root_));
    sync_names_of(root_);
  }

  /// Removes all that was written, unless an earlier conversion went on.
  void give_up() {
    if (is_resumed_) return;
    reserve_.reset();
    std::error_code failed;
    const fs::path mark = mark_of(root_);
    for (const auto& entry : fs::directory_iterator(root_, failed)) {
      std::error_code error;
      if (entry.path() != mark) fs::remove_all(entry.path(), error);
      if (error) failed = error;
    }
    // As long as something is left, the mark lets the same conversion go on.
    if (!failed) fs::remove(mark, failed);
  }

 private:
  static constexpr std::size_t kReserveBytes = 1U << 20U;

  std::filesystem::path root_;
  bool is_resumed_;
  /// Where memory ran out, looking into a folder needs some.
  std::unique_ptr<char[]> reserve_ = std::make_unique<char[]>(kReserveBytes);
};

SplitNumbers split_numbers(const Dataset& dataset) {
  SplitNumbers splits;
  for (const Split& split : dataset.splits) {
    for (const SplitPart& part : split.parts) {
      if (!part.stems) continue;
      for (const std::string& stem : *part.stems) {
        if (const auto number = stem_number(stem)) splits[split.name].insert(*number);
      }
    }
  }
  return splits;
}

/// Where a sequence is written, from the root, and how.
struct Target {
  fs::path folder;
  fs::path pose_file;  ///< that appears when all of it is on the disk
  DataMark mark;
  WriteOptions writing;
};

/// How a layout keeps no origins of rays.
constexpr std::string_view kLostOrigins =
    "rays of all points start at the first LiDAR, as the copy does not keep which are whose: of ";

/// Returns what is doubtful about the poses, and about the copy of a rig.
std::vector<std::string> doubts_to_keep(const Sequence& sequence) {
  std::vector<std::string> doubts = doubts_that_stay(sequence.recording().doubts, sequence);
  if (const std::string& lidars = sequence.reading().lidars; !lidars.empty()) {
    doubts.push_back(fmt::format("{}{}", kLostOrigins, lidars));
  }
  return doubts;
}

/// Returns the mark of what is made of a sequence.
DataMark new_mark(const Sequence& sequence, DatasetKind layout) {
  DataMark mark = mark_as_read(sequence);
  if (mark.simulated) mark.simulated->layout = to_string(layout);
  return mark;
}

std::vector<Target> targets_of(const Dataset& dataset, DatasetKind layout,
                               const WriteOptions& asked) {
  const LayoutWriter& writer = *layout_of(layout).writer;
  std::vector<Target> targets;
  for (std::size_t i = 0; i < dataset.sequences.size(); ++i) {
    const Sequence& sequence = *dataset.sequences[i];
    Target& target = targets.emplace_back();
    target.mark = new_mark(sequence, layout);
    target.folder = writer.folder(sequence.name(), i);
    target.writing = asked;
    if (target.mark.is_set()) target.writing.mark = format_mark(target.mark);
    target.writing.scans = sequence.size();
    target.writing.radial_velocities = sequence.recording().has_radial_velocities;
    const std::string last = writer.last_file(target.writing);
    target.pose_file = last.empty() ? target.folder : target.folder / last;
  }
  return targets;
}

/// Returns every file that may be written, named from the root.
std::set<fs::path> expected_files(const Dataset& dataset, const LayoutWriter& writer,
                                  const std::vector<Target>& targets) {
  std::set<fs::path> files = {kSimulatedMarker};
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const auto mark_folder = mark_folder_of(writer, targets[i].folder);
    if (mark_folder) {
      files.insert({*mark_folder / kSimulatedMarker, *mark_folder / kDisturbedMarker});
    }
    files.insert({targets[i].pose_file, pose_origin_file(targets[i].pose_file)});
    for (const fs::path& file : writer.files(*dataset.sequences[i])) {
      files.insert((targets[i].folder / file).lexically_normal());
    }
  }
  return files;
}

/// Says what is converted to what.
std::string statement_of(const Dataset& dataset, const ConvertOptions& options) {
  nlohmann::ordered_json json = {{"layout", to_string(options.layout)},
                                 {"bag", to_string(options.writing.bag)},
                                 {"compression", options.writing.compression}};
  for (const auto& sequence : dataset.sequences) {
    json["sequences"].push_back({{"name", sequence->name()},
                                 {"reading", plan_of(*sequence)},
                                 {"file_stamp", file_stamp(*sequence)}});
  }
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

/// Marks what is made of sequences with a mark, and the whole where all of them are simulated.
void write_marks(const LayoutWriter& writer, const std::vector<Target>& targets,
                 const ConvertOptions& options) {
  bool all_simulated = true;
  for (const Target& target : targets) {
    const auto folder = mark_folder_of(writer, target.folder);
    all_simulated = all_simulated && target.mark.simulated && folder;
    if (!target.mark.is_set() || !folder) continue;
    write_file_atomic(options.out / *folder / marker_name(target.mark), format_mark(target.mark));
  }
  if (all_simulated) {
    write_file_atomic(options.out / kSimulatedMarker, format_mark(targets.back().mark));
  }
}

void write_shared_files(const Dataset& dataset, const LayoutWriter& writer,
                        const std::vector<Target>& targets, const ConvertOptions& options) {
  write_marks(writer, targets, options);
  if (writer.write_splits != nullptr) writer.write_splits(options.out, split_numbers(dataset));
}

/// Counts what is not written.
struct LostContent {
  KeptTruth keeps = KeptTruth::kId;
  std::size_t unlabelled_points = 0, labelled_scans = 0, points_beyond_view = 0;
  std::size_t radial_velocities = 0, stamps = 0, rig_scans = 0;

  void add(const Frame& frame) {
    static const CameraView kView = written_kitti_mounting().view;
    radial_velocities += frame.radial_velocity_m_s.size();
    if (frame.stamp_ns) ++stamps;
    if (!frame.origins.empty()) ++rig_scans;
    if (!frame.truth) return;
    ++labelled_scans;
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      if (((*frame.truth)[i] & 0xFFFFU) == 0) {
        ++unlabelled_points;
      } else if (keeps == KeptTruth::kInView && !kView.sees(position_of(frame.points[i]))) {
        ++points_beyond_view;
      }
    }
  }

  std::vector<std::string> sentences(const Layout& layout) const {
    std::vector<std::string> sentences;
    if (std::string lost = truth_sentence(layout); !lost.empty()) sentences.push_back(lost);
    if (radial_velocities > 0 && !layout.writer->keeps_radial_velocities) {
      sentences.push_back(
          fmt::format("the radial velocities of {} are left out: layout {} has none",
                      counted(radial_velocities, "point"), layout.name));
    }
    if (rig_scans > 0) {
      sentences.push_back(fmt::format(
          "{} merged of several LiDARs: in the copy, rays of all points start at the first",
          counted(rig_scans, "scan was", "scans were")));
    }
    if (stamps > 0 && !layout.writer->keeps_stamps) {
      sentences.push_back(lost_stamps_text(stamps, layout));
    }
    return sentences;
  }

 private:
  /// Empty where the layout keeps all truth.
  std::string truth_sentence(const Layout& layout) const {
    if (keeps == KeptTruth::kMoving && unlabelled_points > 0) {
      return fmt::format(
          "{} of the label id 0, which most data sets give to what nobody labelled, {} static: "
          "layout {} knows static and moving alone",
          counted(unlabelled_points, "point"), unlabelled_points == 1 ? "becomes" : "become",
          layout.name);
    }
    if (keeps == KeptTruth::kInView && points_beyond_view > 0) {
      return fmt::format(
          "{}: layout {} has none there",
          counted(points_beyond_view, "point beyond the view of camera 2 loses its label",
                  "points beyond the view of camera 2 lose their labels"),
          layout.name);
    }
    if (keeps == KeptTruth::kNone && labelled_scans > 0) {
      return fmt::format("the labels of {} are left out: layout {} has none",
                         counted(labelled_scans, "scan"), layout.name);
    }
    return "";
  }
};

void convert_sequence(const Sequence& sequence, SequenceWriter& writer, LostContent& lost,
                      const std::function<void()>& advance) {
  Frame frame;
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    sequence.read(k, frame);
    lost.add(frame);
    writer.write(k, frame);
    advance();
  }
  writer.finish();
}

}  // namespace

bool is_unfinished_conversion(const fs::path& root) { return is_there(mark_of(root)); }

ReadingMembers plan_of(const Sequence& sequence) {
  const Recording& recording = sequence.recording();
  const std::size_t lost = recording.left_out.size(), unasked = recording.not_asked.size();
  ReadingMembers plan = {{"scans on disk", std::to_string(sequence.size() + lost + unasked)},
                         {"scans without a pose", std::to_string(lost)}};
  const ReadingDone& reading = recording.reading;
  if (reading.drop_scans.empty()) plan.emplace_back("drop_scans", "off");
  if (reading.drop_ego.empty()) plan.emplace_back("drop_ego", "off");
  if (!reading.deskew && !reading.undistortion) plan.emplace_back("deskew", "none");
  std::ranges::move(members_of(reading), std::back_inserter(plan));
  if (const DataMark mark = mark_as_read(sequence); mark.is_set()) {
    plan.emplace_back("mark", marker_name(mark));
  }
  plan.emplace_back("scans written", std::to_string(sequence.size()));
  return plan;
}

std::vector<std::string> convert(
    const Dataset& dataset, const ConvertOptions& options,
    const std::function<void(std::size_t done, std::size_t total)>& progress) {
  const Layout& layout = layout_of(options.layout);
  if (!layout.writer) throw UsageError("layout " + std::string(layout.name) + " is read only");
  const LayoutWriter& writer = *layout.writer;
  const std::vector<Target> targets = targets_of(dataset, options.layout, options.writing);
  const FolderLock lock(options.out);
  UnfinishedConversion unfinished(options.out, statement_of(dataset, options),
                                  expected_files(dataset, writer, targets));
  std::size_t total = 0;
  for (const auto& sequence : dataset.sequences) total += sequence->size();
  std::size_t done = 0;
  LostContent lost{.keeps = writer.keeps};
  const auto advance = [&] {
    if (progress) progress(++done, total);
  };
  try {
    write_shared_files(dataset, writer, targets, options);
    for (std::size_t i = 0; i < dataset.sequences.size(); ++i) {
      const Sequence& sequence = *dataset.sequences[i];
      const fs::path pose_file = options.out / targets[i].pose_file;
      // Finished by a conversion that was killed.
      if (is_there(pose_file) && is_there(pose_origin_file(pose_file))) {
        for (std::size_t k = 0; k < sequence.size(); ++k) advance();
        continue;
      }
      if (options.before_sequence) options.before_sequence(i);
      const auto files = writer.open(options.out / targets[i].folder, targets[i].writing);
      convert_sequence(sequence, *files, lost, advance);
      write_pose_origin(pose_file, pose_origin_of(sequence.reading().poses),
                        doubts_to_keep(sequence));
    }
    unfinished.finish();
  } catch (...) {
    unfinished.give_up();
    throw;
  }
  return lost.sentences(layout);
}

}  // namespace mosbench
