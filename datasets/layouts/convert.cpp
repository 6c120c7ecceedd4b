#include "datasets/layouts/convert.hpp"

#include <algorithm>
#include <set>
#include <system_error>

#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/files/folder_listing.hpp"
#include "datasets/files/split_file.hpp"
#include "datasets/layouts/helimos_layout.hpp"
#include "datasets/layouts/sequence_writer.hpp"
#include "datasets/layouts/simulated_origin.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

void refuse_filled(const fs::path& out) {
  std::error_code error;
  fs::directory_iterator entries(out, error);
  if (error == std::errc::no_such_file_or_directory) return;
  if (error) throw DataError(out, "cannot be looked into", "a folder for the data set");
  if (entries == fs::directory_iterator()) return;
  throw UsageError(out.string() + ": holds files already, expected an empty folder in --out");
}

std::string flat(std::string name) {
  std::ranges::replace(name, '/', '_');
  return name;
}

std::unique_ptr<SequenceWriter> writer_for(const ConvertOptions& options, const fs::path& folder) {
  if (options.as_bag) return write_as_doals_bag(folder, options.compression);
  if (options.layout == DatasetKind::kDoals) return write_as_doals(folder);
  return write_as_kitti(folder);
}

/// HeLiMOS's split files are one set for all sensors.
void write_splits(const Dataset& dataset, const fs::path& folder) {
  for (const char* name : {"train", "val", "test"}) {
    const auto split = std::ranges::find(dataset.splits, name, &Split::name);
    if (split == dataset.splits.end()) continue;
    std::set<std::uint64_t> numbers;
    for (const SplitPart& part : split->parts) {
      if (!part.stems) continue;
      for (const std::string& stem : *part.stems) {
        if (const auto number = stem_number(stem)) numbers.insert(*number);
      }
    }
    if (!numbers.empty()) write_split(folder / (std::string(name) + ".txt"), numbers);
  }
}

}  // namespace

fs::path converted_folder(DatasetKind layout, const std::string& name, std::size_t position) {
  switch (layout) {
    case DatasetKind::kDoals:
      if (fs::path(name).filename().string().starts_with("sequence_")) return name;
      return fs::path(flat(name)) / "sequence_1";
    case DatasetKind::kHelimos:
      if (std::ranges::find(kHelimosSensors, name) != kHelimosSensors.end()) {
        return helimos_folder() / name;
      }
      if (position < kHelimosSensors.size()) return helimos_folder() / kHelimosSensors[position];
      throw UsageError("--layout helimos has room for 4 sequences, not for " + name +
                       ", expected fewer in --sequences");
    default:
      return fs::path("sequences") / flat(name);
  }
}

void convert(const Dataset& dataset, const ConvertOptions& options,
             const std::function<void(std::size_t done, std::size_t total)>& progress) {
  if (!is_written(options.layout)) {
    throw UsageError("layout " + std::string(to_string(options.layout)) + " is read only");
  }
  refuse_filled(options.out);
  std::size_t total = 0;
  for (const auto& sequence : dataset.sequences) total += sequence->size();
  if (auto origin = simulated_origin(dataset.root)) {
    origin->layout = options.layout;
    write_file_atomic(options.out / kSimulatedMarker, format_simulated_origin(*origin));
  }
  if (options.layout == DatasetKind::kHelimos)
    write_splits(dataset, options.out / helimos_folder());
  std::size_t done = 0;
  for (std::size_t i = 0; i < dataset.sequences.size(); ++i) {
    const Sequence& sequence = *dataset.sequences[i];
    const auto writer =
        writer_for(options, options.out / converted_folder(options.layout, sequence.name(), i));
    for (std::size_t k = 0; k < sequence.size(); ++k) {
      writer->add(sequence.read(k));
      if (progress) progress(++done, total);
    }
    writer->finish();
  }
}

}  // namespace mosbench
