#include "datasets/layouts/convert.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "datasets/disk/claim.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/formats/kitti_calib.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/layouts/helimos_layout.hpp"
#include "datasets/layouts/helipr_writer.hpp"
#include "datasets/layouts/kitti_drive_writer.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/layouts/nuscenes_writer.hpp"
#include "datasets/layouts/simulated_origin.hpp"
#include "datasets/layouts/unfinished_conversion.hpp"
#include "datasets/rosbag/ros2_bag_writer.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

HelimosSplits split_numbers(const Dataset& dataset) {
  HelimosSplits splits;
  for (const Split& split : dataset.splits) {
    if (split.name != "train" && split.name != "val" && split.name != "test") continue;
    for (const SplitPart& part : split.parts) {
      if (!part.stems) continue;
      for (const std::string& stem : *part.stems) {
        if (const auto number = stem_number(stem)) splits[split.name].insert(*number);
      }
    }
  }
  return splits;
}

std::vector<fs::path> sequence_folders(const Dataset& dataset, const Layout& layout) {
  std::vector<fs::path> folders;
  for (std::size_t i = 0; i < dataset.sequences.size(); ++i) {
    folders.push_back(layout.writer->folder(dataset.sequences[i]->name(), i));
  }
  return folders;
}

/// Returns every file that may be written, named from the root.
std::set<fs::path> expected_files(const Dataset& dataset, const Layout& layout,
                                  const std::vector<fs::path>& folders) {
  std::set<fs::path> files = {kSimulatedMarker};
  for (std::size_t i = 0; i < folders.size(); ++i) {
    for (const char* name : {"times.txt", "calib.txt", "poses.txt", "indices.csv", "bag.bag",
                             kBagMetadataFile, message_file_of(Ros2Storage::kMcap),
                             message_file_of(Ros2Storage::kSqlite), kPoseOriginFile}) {
      files.insert(folders[i] / name);
    }
    if (layout.writer->one_file) files.insert({folders[i], pose_origin_file(folders[i])});
    for (const fs::path& file : nuscenes_table_files()) files.insert(folders[i] / file);
    for (const auto& names : {kitti_raw_files(dataset.sequences[i]->size()),
                              kitti_tracking_files(dataset.sequences[i]->size())}) {
      for (const fs::path& file : names) files.insert((folders[i] / file).lexically_normal());
    }
    std::vector<fs::path> pose_files = helipr_pose_files();
    for (const char* last : {kNuscenesLastFile, kKittiRawLastFile, kKittiTrackingLastFile}) {
      pose_files.emplace_back(last);
    }
    for (const fs::path& file : pose_files) {
      files.insert(folders[i] / file);
      files.insert((folders[i] / file).parent_path() / kPoseOriginFile);
    }
    for (const char* split : {"train.txt", "val.txt", "test.txt"}) {
      files.insert(folders[i].parent_path() / split);
    }
    const Sequence& sequence = *dataset.sequences[i];
    for (std::size_t k = 0; k < sequence.size(); ++k) {
      files.insert(folders[i] / "velodyne" / (sequence.stem(k) + ".bin"));
      files.insert(folders[i] / "labels" / (sequence.stem(k) + ".label"));
      const std::int64_t stamp_ns = stamp_or_period_ns(k, sequence.stamp_ns(k));
      for (const fs::path& file : helipr_scan_files(stamp_ns)) files.insert(folders[i] / file);
      for (const fs::path& file : nuscenes_scan_files(sequence.stem(k))) {
        files.insert(folders[i] / file);
      }
    }
  }
  return files;
}

/// Returns the file that appears when all of a sequence is on the disk.
fs::path pose_file_of(const LayoutWriter& writer, const fs::path& folder,
                      const WriteOptions& writing) {
  if (writer.one_file) return folder;
  return folder / writer.last_file(writing);
}

/// Says what is converted to what.
std::string statement_of(const Dataset& dataset, const ConvertOptions& options) {
  nlohmann::ordered_json json = {{"layout", to_string(options.layout)},
                                 {"bag", to_string(options.writing.bag)},
                                 {"compression", options.writing.compression}};
  for (const auto& sequence : dataset.sequences) {
    json["sequences"].push_back({{"name", sequence->name()},
                                 {"reading", members_of(sequence->reading())},
                                 {"file_stamp", file_stamp(*sequence)}});
  }
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

/// Returns how the data set was disturbed; empty where it was read as it is.
std::string disturbance_of(const Dataset& dataset) {
  const auto& perturb = dataset.sequences.front()->reading().perturb;
  return perturb ? to_string(*perturb) : "";
}

void write_shared_files(const Dataset& dataset, const ConvertOptions& options) {
  if (auto origin = simulated_origin(dataset.root)) {
    origin->layout = options.layout;
    if (const std::string perturb = disturbance_of(dataset); !perturb.empty()) {
      origin->perturb = origin->perturb ? *origin->perturb + ", then " + perturb : perturb;
    }
    write_file_atomic(options.out / kSimulatedMarker, format_simulated_origin(*origin));
  }
  if (options.layout == DatasetKind::kHelimos) {
    write_helimos_splits(options.out, split_numbers(dataset));
  }
}

/// Counts what is not written.
struct LostContent {
  KeptTruth keeps = KeptTruth::kId;
  std::size_t unlabelled_points = 0, labelled_scans = 0, points_beyond_view = 0;
  std::size_t radial_velocities = 0, stamps = 0;

  void add(const Frame& frame) {
    static const CameraView kView = written_kitti_mounting().view;
    radial_velocities += frame.radial_velocity_m_s.size();
    if (frame.stamp_ns) ++stamps;
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

std::vector<std::string> convert(
    const Dataset& dataset, const ConvertOptions& options,
    const std::function<void(std::size_t done, std::size_t total)>& progress) {
  const Layout& layout = layout_of(options.layout);
  if (!layout.writer) throw UsageError("layout " + std::string(layout.name) + " is read only");
  const std::vector<fs::path> folders = sequence_folders(dataset, layout);
  const FolderLock lock(options.out);
  const UnfinishedConversion unfinished(options.out, statement_of(dataset, options),
                                        expected_files(dataset, layout, folders));
  std::size_t total = 0;
  for (const auto& sequence : dataset.sequences) total += sequence->size();
  std::size_t done = 0;
  LostContent lost{.keeps = layout.writer->keeps};
  const auto advance = [&] {
    if (progress) progress(++done, total);
  };
  try {
    write_shared_files(dataset, options);
    for (std::size_t i = 0; i < dataset.sequences.size(); ++i) {
      const Sequence& sequence = *dataset.sequences[i];
      const fs::path folder = options.out / folders[i];
      WriteOptions writing = options.writing;
      writing.scans = sequence.size();
      writing.radial_velocities = sequence.recording().has_radial_velocities;
      const fs::path pose_file = pose_file_of(*layout.writer, folder, writing);
      // Finished by a conversion that was killed.
      if (is_there(pose_file) && is_there(pose_origin_file(pose_file))) {
        for (std::size_t k = 0; k < sequence.size(); ++k) advance();
      } else {
        if (options.before_sequence) options.before_sequence(i);
        convert_sequence(sequence, *layout.writer->open(folder, writing), lost, advance);
        write_pose_origin(pose_file, pose_origin_of(sequence.reading().poses));
      }
    }
    unfinished.finish();
  } catch (...) {
    unfinished.give_up();
    throw;
  }
  return lost.sentences(layout);
}

}  // namespace mosbench
