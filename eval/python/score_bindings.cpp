#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "eval/protocols/confusion.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/python/arrays.hpp"
#include "eval/python/bindings.hpp"
#include "eval/result/result_json.hpp"
#include "eval/result/result_set.hpp"

namespace mosbench::python {
namespace {

py::dict dict_of(const Confusion& counts) {
  py::dict values;
  values["tp"] = counts.tp;
  values["fp"] = counts.fp;
  values["fn"] = counts.fn;
  values["tn"] = counts.tn;
  values["ignored"] = counts.ignored;
  values["unknown_ids"] = counts.unknown_ids;
  return values;
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
  py::dict values;
  values["stem"] = row.stem;
  values["points"] = row.points;
  values["moving"] = row.predicted_moving_points;
  values["judged"] = row.judged;
  values["threshold"] = row.threshold;
  values["counts"] = row.counts ? py::object(dict_of(*row.counts)) : py::none();
  return values;
}

py::list sequence_results(const ResultSet& set) {
  py::list sequences;
  for (const Result& result : set.sequences) {
    py::dict sequence;
    sequence["name"] = result.sequence.text();
    sequence["folder"] = result.folder();
    const std::vector<SequenceCounts> counts = {counts_of(result)};
    sequence["header"] = header_json(result).dump();
    sequence["metrics"] = dict_of(aggregate(*result.protocol, counts));
    sequence["method_ms_per_scan"] = method_ms_per_scan(result);
    py::list scans;
    for (const ScanRow& row : result.scans) scans.append(dict_of(row));
    sequence["scans"] = scans;
    sequences.append(sequence);
  }
  return sequences;
}

/// Returns what a folder of results says; metrics are fractions, aggregated as the protocol says.
py::dict load_results(const std::filesystem::path& folder) {
  const ResultSet set = [&] {
    const py::gil_scoped_release released;
    return load_result_set(folder);
  }();
  py::dict results;
  results["method"] = set.front().method;
  results["setting"] = set.front().setting;
  results["dataset"] = set.front().dataset;
  results["protocol"] = std::string(set.front().protocol->name);
  results["simulated"] = set.front().is_simulated();
  results["warnings"] = warnings(set);
  results["metrics"] = dict_of(aggregate(*set.front().protocol, counts_of(set.sequences)));
  results["sequences"] = sequence_results(set);
  return results;
}

}  // namespace

void bind_scores(py::module_& module) {
  module.def("protocol_names", [] {
    std::vector<std::string> names;
    for (const Protocol& protocol : protocols()) names.emplace_back(protocol.name);
    return names;
  });
  module.def("count", [](const py::array& predicted, const py::array& truth,
                         const std::string& protocol, const std::optional<py::array>& points) {
    return dict_of(count(predicted, truth, protocol, points));
  });
  module.def("metrics", [](const py::array& predicted, const py::array& truth,
                           const std::string& protocol, const std::optional<py::array>& points) {
    const std::vector<SequenceCounts> one = {{count(predicted, truth, protocol, points)}};
    return dict_of(aggregate(protocol_named(protocol), one));
  });
  module.def("load_results", load_results);
}

}  // namespace mosbench::python
