#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <mosbench/method.hpp>
#include <mosbench/odometry.hpp>
#include <mutex>

#include "eval/job/method_choice.hpp"
#include "eval/python/bindings.hpp"
#include "eval/result/machine.hpp"
#include "eval/result/settings_json.hpp"

namespace mosbench::python {
namespace {

using namespace py::literals;

/// Throws UsageError; a symbol of the paper, with which the meaning of its setting begins, is
/// answered by that setting.
void check_setting(const std::string& name, const Settings& settings) {
  for (const Setting& setting : settings.all()) {
    if (!setting.meaning.starts_with(name + ",")) continue;
    throw py::value_error(
        fmt::format("setting: '{}' is not known, expected {}", name, setting.name));
  }
  row_named(settings.all(), name, "setting");
}

const MethodKind& method_known(const std::string& name) {
  return row_named(methods(), name, "method");
}

/// Returns the defaults of a method, or of odometry, with the values of a preset.
Settings base_settings(const std::string& method, const std::optional<std::string>& preset) {
  const MethodKind& kind = method_known(method);
  return preset ? settings_of(preset_named(*preset), kind) : kind.defaults;
}

Settings odometry_settings(const std::string& name, const std::optional<std::string>& preset) {
  Settings settings = row_named(odometries(), name, "odometry").defaults;
  if (!preset) return settings;
  for (const OdometryPreset& row : odometry_presets()) {
    if (row.name != *preset || row.odometry != name) continue;
    for (const auto& [setting, value] : row.settings) settings.set(setting, value);
    return settings;
  }
  throw py::value_error(fmt::format("preset: '{}' is none of odometry {}", *preset, name));
}

/// Returns the values that are set, in the method's order.
py::dict dict_of(const Settings& settings) {
  py::dict values;
  for (const Setting& setting : settings.all()) {
    if (setting.is_set) values[py::str(std::string(setting.name))] = py::cast(setting.value);
  }
  return values;
}

py::list descriptions_of(const Settings& settings) {
  py::list rows;
  for (const Setting& setting : settings.all()) {
    rows.append(py::dict("name"_a = std::string(setting.name),
                         "default"_a = setting.is_set ? py::cast(setting.value) : py::none(),
                         "legal"_a = legal_values(setting),
                         "meaning"_a = std::string(setting.meaning)));
  }
  return rows;
}

py::array_t<std::uint8_t> numbers_of(const std::vector<Reason>& reasons) {
  std::vector<std::uint8_t> numbers;
  for (const Reason reason : reasons) numbers.push_back(static_cast<std::uint8_t>(reason));
  return array_of(std::move(numbers));
}

py::dict result_of(LabelledScan&& scan, bool with_scores, bool with_reasons) {
  py::dict stages;
  for (const StageTime& stage : scan.stages) {
    const py::str name(std::string(stage.name));
    const double before = stages.contains(name) ? stages[name].cast<double>() : 0.0;
    stages[name] = before + stage.wall_ms;
  }
  return py::dict(
      "index"_a = scan.scan_index, "labels"_a = array_of(std::move(scan.labels)),
      "scores"_a = with_scores ? py::object(array_of(std::move(scan.scores))) : py::none(),
      "reasons"_a = with_reasons ? py::object(numbers_of(scan.reasons)) : py::none(),
      "objects"_a = array_or_none(std::move(scan.objects)), "threshold"_a = scan.threshold,
      "judged"_a = scan.judged, "stages_ms"_a = stages);
}

/// A method that Python threads may push to: the lock is what a thread without the GIL needs.
class LockedMethod {
 public:
  LockedMethod(const std::string& name, const Settings& settings, unsigned threads,
               std::optional<std::size_t> scan_count, bool scores)
      : scores_(scores),
        reasons_(scores && method_known(name).gives_reasons),
        method_(method_known(name).make(
            settings, {.threads = threads, .scan_count = scan_count, .scores = scores})) {
    keep_freed_memory();
  }

  /// `places` are rows of (M, 3), `place_of_point` is one of them per point.
  py::list push(const py::array& array, const py::array& matrix, const DoubleArray& places,
                const py::array_t<std::uint8_t, kPlain>& place_of_point) {
    const ArrayPoints points(array);
    const Pose pose = pose_of(matrix);
    RayOrigins origins;
    for (py::ssize_t i = 0; i < places.size(); i += 3) {
      origins.positions_m.emplace_back(places.data()[i], places.data()[i + 1],
                                       places.data()[i + 2]);
    }
    origins.of_point.assign(place_of_point.data(), place_of_point.data() + place_of_point.size());
    return take([&] { return method_->push(points.span(padded_), pose, origins); });
  }
  py::list finish() {
    return take([&] { return method_->finish(); });
  }
  std::vector<std::string> remarks() const { return method_->remarks(); }
  std::optional<std::size_t> memory_bytes() const {
    const std::optional<MemoryUse> memory = method_->memory();
    return memory ? std::optional(memory->bytes) : std::nullopt;
  }

 private:
  template <typename Work>
  py::list take(Work&& work) {
    std::vector<LabelledScan> scans;
    {
      const py::gil_scoped_release released;
      const std::lock_guard lock(mutex_);
      scans = work();
    }
    py::list results;
    for (LabelledScan& scan : scans) results.append(result_of(std::move(scan), scores_, reasons_));
    return results;
  }

  bool scores_;
  bool reasons_;
  std::vector<Point> padded_;
  std::mutex mutex_;
  std::unique_ptr<Method> method_;
};

/// The same for odometry.
class LockedOdometry {
 public:
  LockedOdometry(const std::string& name, const Settings& settings, unsigned threads)
      : odometry_(row_named(odometries(), name, "odometry").make(settings, threads)) {}

  py::dict push(const py::array& array, std::optional<std::int64_t> stamp_ns,
                const std::vector<std::int64_t>& point_times_ns) {
    const ArrayPoints points(array);
    ScanPose pose;
    {
      const py::gil_scoped_release released;
      const std::lock_guard lock(mutex_);
      pose = odometry_->push(points.span(padded_), {stamp_ns, point_times_ns});
    }
    return py::dict("pose"_a = matrix_of(pose.map_from_sensor.matrix()),
                    "covariance"_a = matrix_of(pose.covariance), "geometry"_a = pose.geometry,
                    "condition"_a = pose.condition, "overlap"_a = pose.overlap,
                    "doubt"_a = pose.doubt);
  }

 private:
  std::vector<Point> padded_;
  std::mutex mutex_;
  std::unique_ptr<Odometry> odometry_;
};

}  // namespace

void bind_methods(py::module_& module) {
  module.attr("STATIC_LABEL") = kStaticLabel;
  module.attr("MOVING_LABEL") = kMovingLabel;
  py::class_<Settings>(module, "Settings")
      .def("set",
           [](Settings& settings, const std::string& name, const SettingValue& value) {
             if (settings.find(name) == nullptr) check_setting(name, settings);
             settings.set(name, value);
           })
      .def("load", [](Settings& settings,
                      const std::filesystem::path& file) { apply_settings_file(file, settings); })
      .def("to_dict", dict_of)
      .def("describe", descriptions_of)
      .def("__copy__", [](const Settings& settings) { return Settings(settings); });
  module.def("method_names", [] { return names_of(methods()); });
  module.def("names_several_methods", names_several_methods);
  module.def("preset_names", [] { return names_of(presets()); });
  module.def("method_name", [](const std::optional<std::string>& method,
                               const std::optional<std::string>& preset) {
    const MethodKind& kind = method_of(method, preset);
    return method.value_or(std::string(kind.name));
  });
  module.def("method_settings", base_settings);
  module.def("odometry_settings", odometry_settings);
  module.def("check_settings", [](const std::string& method, const Settings& settings) {
    method_known(method).check(settings);
  });
  py::class_<LockedMethod>(module, "Method")
      .def(py::init<const std::string&, const Settings&, unsigned, std::optional<std::size_t>,
                    bool>())
      .def("push", &LockedMethod::push)
      .def("finish", &LockedMethod::finish)
      .def("remarks", &LockedMethod::remarks)
      .def("memory_bytes", &LockedMethod::memory_bytes);
  py::class_<LockedOdometry>(module, "Odometry")
      .def(py::init<const std::string&, const Settings&, unsigned>())
      .def("push", &LockedOdometry::push);
}

}  // namespace mosbench::python
