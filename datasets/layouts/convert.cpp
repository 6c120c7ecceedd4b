#include "datasets/layouts/convert.hpp"

#include <system_error>

#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/files/folder_listing.hpp"
#include "datasets/layouts/helimos_layout.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/layouts/simulated_origin.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

void refuse_filled(const fs::path& out) {
  std::error_code error;
  fs::directory_iterator entries(out, error);
  if (error == std::errc::no_such_file_or_directory) return;
  if (error) throw DataError(out, "cannot be listed", "a folder for the data set");
  if (entries == fs::directory_iterator()) return;
  throw UsageError(out.string() + ": holds files already, expected an empty folder in --out");
}

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

}  // namespace

void convert(const Dataset& dataset, const ConvertOptions& options,
             const std::function<void(std::size_t done, std::size_t total)>& progress) {
  const Layout& layout = layout_of(options.layout);
  if (!layout.writer) throw UsageError("layout " + std::string(layout.name) + " is read only");
  refuse_filled(options.out);
  std::size_t total = 0;
  for (const auto& sequence : dataset.sequences) total += sequence->size();
  if (auto origin = simulated_origin(dataset.root)) {
    origin->layout = options.layout;
    write_file_atomic(options.out / kSimulatedMarker, format_simulated_origin(*origin));
  }
  if (options.layout == DatasetKind::kHelimos) {
    write_helimos_splits(options.out, split_numbers(dataset));
  }
  std::size_t done = 0;
  for (std::size_t i = 0; i < dataset.sequences.size(); ++i) {
    const Sequence& sequence = *dataset.sequences[i];
    WriteOptions writing = options.writing;
    writing.scans = sequence.size();
    const auto writer =
        layout.writer->open(options.out / layout.writer->folder(sequence.name(), i), writing);
    Frame frame;
    for (std::size_t k = 0; k < sequence.size(); ++k) {
      sequence.read(k, frame);
      writer->write(k, frame);
      if (progress) progress(++done, total);
    }
    writer->finish();
  }
}

}  // namespace mosbench
