#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <iterator>
#include <map>

#include "eval/protocols/confusion.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/python/bindings.hpp"
#include "eval/result/result.hpp"
#include "eval/result/result_json.hpp"

namespace mosbench::python {
namespace {

using namespace py::literals;

py::dict dict_of(const Confusion& counts) {
  return py::dict("tp"_a = counts.tp, "fp"_a = counts.fp, "fn"_a = counts.fn, "tn"_a = counts.tn,
                  "ignored"_a = counts.ignored, "unknown_ids"_a = counts.unknown_ids);
}

/// Returns an id of the class under the map: those of a range whose ids no later range takes.
std::uint32_t id_of(const IdMap& map, TruthClass wanted) {
  const LabelTable table(map);
  for (const IdRange& range : map.ranges) {
    for (std::uint32_t id = range.first; id <= range.last; ++id) {
      if (table[id] == wanted && table.is_known(id)) return id;
    }
  }
  throw py::value_error("the protocol knows no such class");
}

/// Returns ids as the map knows them; true of a bool stands for moving.
std::vector<std::uint32_t> ids_of(const py::array& labels, const IdMap& map,
                                  const std::string& name) {
  std::vector<std::uint32_t> ids = labels_of(labels, name);
  if (labels.dtype().kind() != 'b') return ids;
  const std::uint32_t of_static = id_of(map, TruthClass::kStatic);
  const std::uint32_t of_moving = id_of(map, TruthClass::kMoving);
  for (std::uint32_t& id : ids) id = id != 0 ? of_moving : of_static;
  return ids;
}

Confusion count(const py::array& predicted, const py::array& truth, const std::string& protocol,
                const std::optional<py::array>& points) {
  const Protocol& rules = protocol_named(protocol);
  const std::vector<std::uint32_t> prediction = ids_of(predicted, rules.prediction, "predicted");
  const std::vector<std::uint32_t> true_ids = ids_of(truth, rules.truth, "truth");
  if (prediction.size() != true_ids.size()) {
    throw py::value_error(fmt::format("predicted: has {} points, expected {} as truth has",
                                      prediction.size(), true_ids.size()));
  }
  if (!points && rules.range_rule != RangeRule::kNone) {
    throw py::value_error(fmt::format(
        "points: are not given, expected those of the scan, because protocol {} limits the range",
        protocol));
  }
  if (!points) return score_scan(rules, true_ids, prediction, {});
  const ArrayPoints coordinates(*points);
  std::vector<Point> padded;
  return score_scan(rules, true_ids, prediction, coordinates.span(padded));
}

/// What `dict_of` made of counts.
Confusion confusion_of(const std::map<std::string, std::uint64_t>& counts) {
  return {.tp = counts.at("tp"),
          .fp = counts.at("fp"),
          .fn = counts.at("fn"),
          .tn = counts.at("tn"),
          .ignored = counts.at("ignored"),
          .unknown_ids = counts.at("unknown_ids")};
}

/// A NaN is undefined: None.
py::dict dict_of(const MetricValues& values) {
  py::dict metrics;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool defined = values[i] == values[i];
    metrics[py::str(std::string(kMetrics[i].key))] = defined ? py::cast(values[i]) : py::none();
  }
  return metrics;
}

py::dict dict_of(const ScanRow& row) {
  return py::dict("stem"_a = row.stem, "points"_a = row.points,
                  "moving"_a = row.predicted_moving_points, "judged"_a = row.judged,
                  "threshold"_a = row.threshold,
                  "counts"_a = row.counts ? py::object(dict_of(*row.counts)) : py::none());
}

py::list sequence_results(const ResultSet& set) {
  py::list sequences;
  for (const Result& result : set.sequences) {
    const std::vector<SequenceCounts> counts = {counts_of(result)};
    py::list scans;
    for (const ScanRow& row : result.scans) scans.append(dict_of(row));
    sequences.append(py::dict("name"_a = result.sequence.text(), "folder"_a = result.folder(),
                              "header"_a = header_json(result).dump(),
                              "metrics"_a = dict_of(aggregate(*result.protocol, counts)),
                              "method_ms_per_scan"_a = method_ms_per_scan(result),
                              "warnings"_a = notices_of(result), "scans"_a = scans));
  }
  return sequences;
}

/// Returns what a folder of results says; metrics are fractions, aggregated as the protocol says.
py::dict load_results(const std::filesystem::path& folder) {
  const ResultSet set = [&] {
    const py::gil_scoped_release released;
    return load_result_set(folder);
  }();
  const Result& first = set.front();
  return py::dict("method"_a = first.method, "setting"_a = first.setting,
                  "dataset"_a = first.dataset, "protocol"_a = std::string(first.protocol->name),
                  "simulated"_a = first.is_simulated(), "warnings"_a = warnings(set),
                  "metrics"_a = dict_of(aggregate(*first.protocol, counts_of(set.sequences))),
                  "sequences"_a = sequence_results(set));
}

}  // namespace

void bind_scores(py::module_& module) {
  module.def("protocol_names", [] { return names_of(protocols()); });
  using Points = std::optional<py::array>;
  module.def("count", [](const py::array& predicted, const py::array& truth,
                         const std::string& protocol, const Points& points) {
    return dict_of(count(predicted, truth, protocol, points));
  });
  module.def("metrics", [](const py::array& predicted, const py::array& truth,
                           const std::string& protocol, const Points& points) {
    const std::vector<SequenceCounts> one = {{count(predicted, truth, protocol, points)}};
    return dict_of(aggregate(protocol_named(protocol), one));
  });
  using Counts = std::map<std::string, std::uint64_t>;
  module.def(
      "pooled", [](const std::vector<std::vector<Counts>>& sequences, const std::string& protocol) {
        std::vector<SequenceCounts> counts;
        for (const std::vector<Counts>& scans : sequences) {
          std::ranges::transform(scans, std::back_inserter(counts.emplace_back()), confusion_of);
        }
        return dict_of(aggregate(protocol_named(protocol), counts));
      });
  module.def("load_results", load_results);
}

}  // namespace mosbench::python
