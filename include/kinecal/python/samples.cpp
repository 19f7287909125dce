// Samples in Python: from arrays, from files, and as arrays again.
// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>
#include <sstream>
#include <utility>

#include "kinecal/files/cameras/read_camera_file.hpp"
#include "kinecal/files/poses/poses.hpp"
#include "kinecal/files/recordings/read_recording.hpp"
#include "kinecal/files/recordings/write_recording.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/python/sample_list.ipp"
#include "kinecal/samples/joint_moves.hpp"

namespace kinecal::python {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

/// A feature of an array; nullopt if it was not seen.
std::optional<Feature> feature_at(const SensorArray& of, const double* numbers, std::size_t size) {
  Feature feature{.frame = of.frame};
  for (std::size_t i = 0; i < size; ++i) {
    if (std::isnan(numbers[i])) return std::nullopt;
  }
  if (size < 16) {
    for (std::size_t i = 0; i < size; ++i) feature.point(static_cast<Eigen::Index>(i)) = numbers[i];
    return feature;
  }
  feature.rotation.emplace();
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) (*feature.rotation)(i, k) = numbers[4 * i + k];
    feature.point(i) = numbers[4 * i + 3];
  }
  return feature;
}

/// Adds what a sensor saw to samples.  Features that were not seen are left out where they have ids, else they keep
/// their place as NaN: it identifies the others.
/// @param first  row of the first sample
void add_observations(const SensorArray& of, std::size_t first, std::vector<Sample>& samples) {
  const std::size_t rows = size_of(of.features, 0), count = size_of(of.features, 1);
  const std::size_t row_size = rows == 0 ? 0 : static_cast<std::size_t>(of.features.size()) / rows;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double* numbers = of.features.data() + (rows == 1 ? 0 : first + i) * row_size;
    Observation observation;
    observation.sensor = of.sensor;
    observation.camera = of.camera;
    bool is_seen = false;
    for (std::size_t k = 0; k < count; ++k) {
      std::optional<Feature> feature =
          feature_at(of, numbers + k * (row_size / count), row_size / count);
      is_seen = is_seen || feature.has_value();
      if (!feature && !of.ids.empty()) continue;
      if (!feature) {
        feature = Feature{.frame = of.frame, .point = Vector3<double>::Constant(kMissing)};
      }
      if (!of.ids.empty()) feature->id = of.ids[k];
      observation.features.push_back(*std::move(feature));
    }
    if (is_seen) samples[i].observations.push_back(std::move(observation));
  }
}

}  // namespace

std::vector<Sample> SampleArrays::samples(std::size_t first, std::size_t end) const {
  std::vector<Sample> result(end - first);
  for (std::size_t i = first; i < end; ++i) {
    Sample& sample = result[i - first];
    const double* position = positions.data() + i * joints.size();
    sample.joint_names = joints;
    sample.joint_positions.assign(position, position + joints.size());
    sample.source = name + ":" + std::to_string(i + 1);
    for (const auto& [condition, values] : conditions) {
      sample.conditions[condition] = values.data()[i];
    }
    if (stamps && !std::isnan(stamps->data()[i])) {
      sample.stamp = std::chrono::nanoseconds(std::llround(1e9 * stamps->data()[i]));
    }
  }
  for (const SensorArray& sensor : sensors) add_observations(sensor, first, result);
  set_joint_moves(result);
  set_joint_velocities(result);
  return result;
}

namespace {

SampleList read_sample_files(const std::vector<std::string>& files) {
  SampleList list;
  {
    const py::gil_scoped_release others_may_run;
    for (const std::string& file : files) {
      Recording read = read_recording(file, list.diagnostics);
      std::move(read.samples.begin(), read.samples.end(), std::back_inserter(list.samples));
      if (list.urdf.empty()) list.urdf = std::move(read.urdf);
    }
  }
  list.diagnostics.throw_if_errors();
  return list;
}

Numbers positions_of(const SampleList& list, const std::vector<std::string>& joints) {
  Numbers positions(std::vector<py::ssize_t>{static_cast<py::ssize_t>(list.samples.size()),
                                             static_cast<py::ssize_t>(joints.size())});
  double* out = positions.mutable_data();
  for (const Sample& sample : list.samples) {
    for (const std::string& joint : joints) *out++ = sample.position(joint).value_or(kMissing);
  }
  return positions;
}

std::vector<std::string> joints_of_samples(const SampleList& list) {
  std::vector<std::string> joints;
  std::set<std::string> known;
  for (const Sample& sample : list.samples) {
    for (const std::string& joint : sample.joint_names) {
      if (known.insert(joint).second) joints.push_back(joint);
    }
  }
  return joints;
}

/// The features of a sensor, (n, k, 3), by place, and their ids (n, k), -1 without; NaN where there are fewer.
py::tuple features_of(const SampleList& list, const std::string& sensor) {
  std::size_t most = 0;
  for (const Sample& sample : list.samples) {
    if (const Observation* seen = sample.observation(sensor))
      most = std::max(most, seen->features.size());
  }
  const auto rows = static_cast<py::ssize_t>(list.samples.size()),
             width = static_cast<py::ssize_t>(most);
  Numbers points(std::vector<py::ssize_t>{rows, width, 3});
  py::array_t<int> ids(std::vector<py::ssize_t>{rows, width});
  std::fill_n(points.mutable_data(), points.size(), kMissing);
  std::fill_n(ids.mutable_data(), ids.size(), -1);
  for (std::size_t i = 0; i < list.samples.size(); ++i) {
    const Observation* seen = list.samples[i].observation(sensor);
    for (std::size_t k = 0; seen != nullptr && k < seen->features.size(); ++k) {
      const Feature& feature = seen->features[k];
      for (std::size_t c = 0; c < 3; ++c) {
        points.mutable_data()[3 * (i * most + k) + c] = feature.point(static_cast<Eigen::Index>(c));
      }
      ids.mutable_data()[i * most + k] = feature.id.value_or(-1);
    }
  }
  return py::make_tuple(std::move(points), std::move(ids));
}

std::vector<std::string> sensors_of(const SampleList& list) {
  std::set<std::string> sensors;
  for (const Sample& sample : list.samples) {
    for (const Observation& seen : sample.observations) sensors.insert(seen.sensor);
  }
  return {sensors.begin(), sensors.end()};
}

/// Intrinsics by numbers.
/// @param numbers  fx fy cx cy, pixels; then distortion as its model orders it
CameraInfo camera_of(int width, int height, const std::vector<double>& numbers,
                     const std::string& model) {
  CameraInfo camera;
  camera.width = width;
  camera.height = height;
  camera.distortion_model = model;
  camera.d.assign(numbers.begin() + 4, numbers.end());
  camera.k = {numbers[0], 0.0, numbers[2], 0.0, numbers[1], numbers[3], 0.0, 0.0, 1.0};
  camera.r = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  camera.p = {numbers[0], 0.0, numbers[2], 0.0, 0.0, numbers[1],
              numbers[3], 0.0, 0.0,        0.0, 1.0, 0.0};
  return camera;
}

/// @param argument  "camera.yaml", or "camera.yaml:cam1" of a file with several
CameraInfo camera_of_file(const std::string& argument) {
  Diagnostics found;
  CameraInfo camera = read_camera_argument(argument, found);
  found.throw_if_errors();
  return camera;
}

void set_camera_of(SampleList& list, const std::string& sensor, const CameraInfo& camera) {
  bool is_seen = false;
  for (Sample& sample : list.samples) {
    for (Observation& seen : sample.observations) {
      if (seen.sensor != sensor) continue;
      seen.camera = camera;
      is_seen = true;
    }
  }
  if (!is_seen) throw InputError("cameras: '" + sensor + "' observed nothing");
}

/// Samples without observations: poses that were chosen.
SampleList read_poses(const std::string& file) {
  SampleList list;
  for (const CapturePose& pose : read_poses_yaml(file, list.diagnostics)) {
    Sample sample;
    sample.joint_names = pose.joint_names;
    sample.joint_positions = pose.positions;
    sample.source = file + ":" + std::to_string(list.samples.size() + 1);
    list.samples.push_back(std::move(sample));
  }
  list.diagnostics.throw_if_errors();
  return list;
}

void save_samples(const SampleList& list, const std::string& path) {
  const py::gil_scoped_release others_may_run;
  if (output_encoding(path)) {
    write_recording(path, list.samples, list.urdf);
    return;
  }
  std::ostringstream text;
  write_samples(text, list.samples);
  write_text_file(path, text.str());
}

}  // namespace

void bind_samples(py::module_& module) {
  py::class_<CameraInfo>(module, "Camera")
      .def(py::init(&camera_of), py::arg("width"), py::arg("height"), py::arg("numbers"),
           py::arg("model"))
      .def(py::init(&camera_of_file), py::arg("file"));
  py::class_<SensorArray>(module, "SensorArray")
      .def(py::init([](std::string sensor, std::string frame, Numbers features,
                       std::vector<int> ids, std::optional<CameraInfo> camera) {
             return SensorArray{std::move(sensor), std::move(frame), std::move(features),
                                std::move(ids), std::move(camera)};
           }),
           py::arg("sensor"), py::arg("frame"), py::arg("features"), py::arg("ids"),
           py::arg("camera"));
  py::class_<SampleArrays>(module, "SampleArrays")
      .def(py::init([](std::vector<std::string> joints, Numbers positions,
                       std::vector<SensorArray> sensors, std::map<std::string, Numbers> conditions,
                       std::optional<Numbers> stamps, std::string name) {
             return SampleArrays{std::move(joints),     std::move(positions), std::move(sensors),
                                 std::move(conditions), std::move(stamps),    std::move(name)};
           }),
           py::arg("joints"), py::arg("positions"), py::arg("sensors"), py::arg("conditions"),
           py::arg("stamps"), py::arg("name"))
      .def("__len__", &SampleArrays::size)
      .def("samples", [](const SampleArrays& of) {
        const py::gil_scoped_release others_may_run;
        SampleList list;
        list.samples = of.samples(0, of.size());
        return list;
      });
  py::class_<SampleList>(module, "Samples")
      .def("__len__", [](const SampleList& list) { return list.samples.size(); })
      .def("joints", &joints_of_samples)
      .def("sensors", &sensors_of)
      .def("positions", &positions_of, py::arg("joints"))
      .def("features", &features_of, py::arg("sensor"))
      .def("sources",
           [](const SampleList& list) {
             std::vector<std::string> sources;
             for (const Sample& sample : list.samples) sources.push_back(sample.source);
             return sources;
           })
      .def("take",
           [](const SampleList& list, const std::vector<std::size_t>& numbers) {
             SampleList some{.urdf = list.urdf};
             for (const std::size_t i : numbers) some.samples.push_back(list.samples.at(i));
             return some;
           })
      .def("append",
           [](SampleList& list, const SampleList& more) {
             list.samples.insert(list.samples.end(), more.samples.begin(), more.samples.end());
           })
      .def("set_camera", &set_camera_of, py::arg("sensor"), py::arg("camera"))
      .def("save", &save_samples, py::arg("path"))
      .def_readonly("urdf", &SampleList::urdf);
  module.def("read_poses", &read_poses, py::arg("file"));
  module.def("read_samples", &read_sample_files, py::arg("files"));
}

}  // namespace kinecal::python
