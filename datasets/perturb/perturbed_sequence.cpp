#include <algorithm>
#include <numeric>
#include <utility>

#include "datasets/perturb/perturb_kinds.hpp"

namespace mosbench {
namespace {

/// Returns the same word for a name everywhere (FNV-1a).
std::uint64_t word_of(std::string_view name) {
  std::uint64_t word = 0xCBF29CE484222325u;
  for (const char c : name) word = (word ^ static_cast<unsigned char>(c)) * 0x100000001B3u;
  return word;
}

class PerturbedSequence : public SequenceAround {
 public:
  PerturbedSequence(std::unique_ptr<Sequence> inner, const Perturbation& perturbation)
      : SequenceAround(std::move(inner)) {
    ScanList list{recording().scans, std::vector<std::size_t>(size())};
    std::iota(list.sources.begin(), list.sources.end(), std::size_t{0});
    const Draws draws = Draws(perturbation.seed).of(word_of(name()));
    for (std::size_t i = 0; i < perturbation.steps.size(); ++i) {
      const PerturbStep& step = perturbation.steps[i];
      const PerturbKind& kind = perturb_kind_named(step.kind);
      if (step.strength == kind.none) continue;
      add(kind, {step.strength, draws.of(i), perturbation, this->inner().recording()}, list);
    }
    sources_ = std::move(list.sources);
    mutable_recording().scans = std::move(list.scans);
    mutable_recording().reading.perturb = perturbation;
    mutable_recording().remarks.push_back("disturbed on purpose: " + to_string(perturbation));
  }

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    const std::size_t source = sources_.at(scan_index);
    inner().read(source, frame);
    for (const ChangePoints& change : changes_) change(source, frame);
    frame.map_from_sensor = map_from_sensor(scan_index);
    frame.stamp_ns = stamp_ns(scan_index);
  }

  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override {
    if (!changes_truth_ || !has_truth(scan_index)) {
      return inner().read_truth(sources_.at(scan_index));
    }
    Frame frame;
    read(scan_index, frame);
    return std::move(frame.truth).value();
  }

 private:
  void add(const PerturbKind& kind, const PerturbContext& context, ScanList& list) {
    if (kind.change_scans != nullptr) kind.change_scans(context, list);
    if (kind.point_change != nullptr) changes_.push_back(kind.point_change(context));
    changes_truth_ = changes_truth_ || kind.changes_truth;
  }

  std::vector<std::size_t> sources_;
  std::vector<ChangePoints> changes_;
  bool changes_truth_ = false;
};

}  // namespace

std::unique_ptr<Sequence> perturbed(std::unique_ptr<Sequence> inner,
                                    const Perturbation& perturbation) {
  return std::make_unique<PerturbedSequence>(std::move(inner), perturbation);
}

}  // namespace mosbench
