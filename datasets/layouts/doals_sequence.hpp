#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/formats/label_file.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// One of the eight published DOALS sequences.
struct DoalsPublished {
  int number;                         ///< 1 to 8
  std::string_view scene;             ///< folder of the scene
  std::string_view sequence;          ///< folder below it
  std::string_view split;             ///< column of the paper's table: HG, ND, SV, ST
  std::size_t scans;                  ///< length of the recording
  std::array<std::size_t, 10> truth;  ///< labelled scans, counted from 1 (evalIndFile.cpp, HMM-MOS)
};

/// Returns all eight, by number.
std::span<const DoalsPublished> doals_published();

/// Returns the published sequence in `scene`/`sequence`, or null.
const DoalsPublished* find_doals_published(std::string_view scene, std::string_view sequence);

/// One DOALS sequence: its folder with the bag, or the bag, or scans exported to velodyne/ or
/// binFiles/ in the raw firing order with no point dropped and poses.txt; indices.csv with the
/// moving points of the labelled scans. With both, the exported scans are read. Truth is
/// kMovingLabel for listed points and kStaticLabel for all others. A labelled scan is identified by
/// its exact stamp; without stamps by the published list, if the recording has the published
/// length.
class DoalsSequence : public SequenceAround {
 public:
  /// `published` is null for a recording that is none of the published ones. Throws DataError, also
  /// for a stamp or an index in indices.csv that no scan has.
  DoalsSequence(std::string name, const std::filesystem::path& folder,
                const DoalsPublished* published, const Reading& asked = {});

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override;
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override;

 private:
  void open_truth(const DoalsPublished* published);
  std::vector<std::size_t> scans_by_stamp(std::span<const IndicesRow> rows) const;
  std::vector<std::size_t> scans_by_list(std::span<const IndicesRow> rows,
                                         const DoalsPublished* published) const;

  std::filesystem::path indices_file_;
  std::map<std::size_t, IndicesRow> truth_;  ///< by scan
};

}  // namespace mosbench
