// The registry with its built-in types.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/registry.hpp"

#include <algorithm>
#include <stdexcept>

namespace kinecal {

namespace detail {
namespace {

using Keys = std::vector<std::vector<std::string>>;
using NumberKeys = std::vector<std::pair<std::string, double>>;

/// The entry of a built-in sensor.
template <Sensor M>
[[nodiscard]] SensorEntry built_in_sensor() {
  return sensor_entry_of(M{}, [](AnyProblem& problem, const BuiltInSensor& sensor,
                                 const Mount& mount) { problem.add_built_in(sensor, mount); });
}

/// The entry of the cameras with all lenses.
[[nodiscard]] SensorEntry camera_entry() {
  SensorEntry entry = built_in_sensor<LensCamera<PlumbBob>>();
  const auto with = [](const SensorOptions& options) {
    return lens_camera(options.lens.empty() ? PlumbBob::kName : options.lens, options.image);
  };
  entry.lenses.assign(lens_names().begin(), lens_names().end());
  entry.make = [with](const SensorOptions& options) { return any_built_in(with(options)); };
  entry.add = [with](AnyProblem& problem, const Mount& mount, const SensorOptions& options) {
    problem.add_built_in(with(options), mount);
  };
  return entry;
}

/// Adds a camera with another lens to the type of such cameras.
/// @throws std::invalid_argument  if the name of the lens is taken
void add_lens(SensorEntry own, SensorEntry& cameras) {
  const std::string lens = own.lenses.front();
  const auto& known = cameras.lenses;
  if (std::find(known.begin(), known.end(), lens) != known.end() || !lens_named(lens).empty()) {
    throw std::invalid_argument("lens '" + lens + "' of sensor type '" + own.type +
                                "' is registered already");
  }
  cameras.lenses.push_back(lens);
  cameras.make = [lens, own = own.make, others = cameras.make](const SensorOptions& options) {
    return options.lens == lens ? own(options) : others(options);
  };
  cameras.add = [lens, own = own.add, others = cameras.add](AnyProblem& problem, const Mount& mount,
                                                            const SensorOptions& options) {
    (options.lens == lens ? own : others)(problem, mount, options);
  };
}

/// @param make  makes the block from the numbers of a configuration
template <ErrorBlock B, class Make>
[[nodiscard]] BlockEntry built_in_block(const Keys& keys, NumberKeys numbers, Make make,
                                        const std::string& type = B::kType) {
  BlockEntry entry;
  entry.type = type;
  entry.read_as = B::kType;
  entry.unit = B::kUnit;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    entry.sensors.push_back({keys[i], kQuantities<B>[i]});
  }
  entry.numbers = std::move(numbers);
  entry.looks_before = conditions_before<B>();
  entry.parameters = [make](const BlockConfig& block) {
    const auto infos = parameters_of(B(make(block)));
    return std::vector<ParameterInfo>(infos.begin(), infos.end());
  };
  entry.add = [make](AnyProblem& problem, const BlockConfig& block, const TermOptions& options) {
    problem.add_built_in(block.name, B(make(block)), block.models, options);
  };
  return entry;
}

/// @throws std::invalid_argument  if a length is negative
[[nodiscard]] double length_of(const BlockConfig& block, const char* key) {
  const double length = block.numbers.at(key);
  if (length < 0.0) throw std::invalid_argument(std::string(key) + " is negative");
  return length;
}

/// The numbers of a drive, with their defaults.
/// @{
[[nodiscard]] NumberKeys numbers_of(const DifferentialDrive&) {
  return {{"wheel_radius", 1.0}, {"track_width", 0.0}};  // 0: what the driver has is not known
}
[[nodiscard]] NumberKeys numbers_of(const MecanumDrive&) {
  return {{"wheel_radius", 1.0}, {"track_width", 1.0}, {"wheelbase", 1.0}};
}
[[nodiscard]] NumberKeys numbers_of(const TricycleDrive&) {
  return {{"wheel_radius", 1.0}, {"wheelbase", 1.0}};
}
[[nodiscard]] NumberKeys numbers_of(const ReportedOdometry&) {
  return {{"track_width", 0.0}};  // what the driver has; 0: not known
}
/// @}

/// @throws std::invalid_argument  if a length is not positive
[[nodiscard]] double size_of(const BlockConfig& block, const char* key) {
  const double length = block.numbers.at(key);
  if (!(length > 0.0)) throw std::invalid_argument(std::string(key) + " is not positive");
  return length;
}

/// A drive of these numbers.
/// @{
void set_drive(const BlockConfig& block, DifferentialDrive& drive) {
  const double width = length_of(block, "track_width");
  drive = {size_of(block, "wheel_radius"), width > 0.0 ? width : DifferentialDrive{}.track_width};
}
void set_drive(const BlockConfig& block, MecanumDrive& drive) {
  drive = {size_of(block, "wheel_radius"), size_of(block, "track_width"),
           size_of(block, "wheelbase")};
}
void set_drive(const BlockConfig& block, TricycleDrive& drive) {
  drive = {size_of(block, "wheel_radius"), size_of(block, "wheelbase")};
}
void set_drive(const BlockConfig& block, ReportedOdometry&) {
  (void)length_of(block, "track_width");
}
/// @}

/// The entry of a drive against what a sensor on the base saw.
template <ErrorBlock B>
[[nodiscard]] BlockEntry base_entry() {
  NumberKeys numbers = numbers_of(decltype(B::drive){});
  for (const char* key : {"x", "y", "yaw"}) numbers.emplace_back(key, 0.0);
  for (const char* key : {"translation_scale", "rotation_scale"}) numbers.emplace_back(key, 1.0);
  return built_in_block<B>({}, std::move(numbers), [](const BlockConfig& block) {
    const auto number = [&](const char* key) { return block.numbers.at(key); };
    B made;
    set_drive(block, made.drive);
    made.mount = {number("x"), number("y"), number("yaw")};
    made.translation_scale = number("translation_scale");
    made.rotation_scale = number("rotation_scale");
    return made;
  });
}

/// The entry of a gyroscope.  Its driver's scale is for base_calibration.yaml; 0: not known.
template <ErrorBlock B>
[[nodiscard]] BlockEntry gyro_entry() {
  return built_in_block<B>({}, {{"gyro_scale", 0.0}}, [](const BlockConfig& block) {
    (void)length_of(block, "gyro_scale");
    return B{};
  });
}

[[nodiscard]] BlockEntry prior_entry() {
  BlockEntry entry;
  entry.type = entry.read_as = "outrageous";
  entry.unit = "1";
  entry.numbers = {{"joint_scale", 1.0}, {"position_scale", 1.0}, {"rotation_scale", 1.0}};
  for (const char* mean : kPriorMeans) entry.numbers.emplace_back(mean, 0.0);
  entry.has_param = true;
  entry.parameters = [](const BlockConfig&) { return std::vector<ParameterInfo>(); };
  entry.add = [](AnyProblem& problem, const BlockConfig& block, const TermOptions& options) {
    const auto number = [&](const char* key) { return block.numbers.at(key); };
    Prior prior{block.param, number("joint_scale"), number("position_scale"),
                number("rotation_scale")};
    for (std::size_t i = 0; i < prior.mean.size(); ++i) prior.mean[i] = number(kPriorMeans[i]);
    problem.add_prior(block.name, prior, options);
  };
  return entry;
}

}  // namespace
}  // namespace detail

Registry::Registry() {
  using detail::built_in_block;
  sensors_ = {detail::built_in_sensor<ChainPoint>(), detail::built_in_sensor<DepthCamera>(),
              detail::camera_entry(), detail::built_in_sensor<ChainPose>(),
              detail::built_in_sensor<BentBoard>()};

  const auto number = [](const BlockConfig& block, const char* key) {
    return block.numbers.at(key);
  };
  const detail::Keys pair = {{"model_a"}, {"model_b"}};
  const auto point_to_point = [](const BlockConfig&) { return PointToPoint{}; };
  add(built_in_block<PointToPoint>(pair, {}, point_to_point));
  add(built_in_block<PointToPoint>({{"camera", "model_a"}, {"arm", "model_b"}}, {}, point_to_point,
                                   "camera3d_to_arm"));
  add(built_in_block<PointToPixel>({{"model_3d"}, {"model_2d"}}, {{"scale", 1.0}},
                                   [](const BlockConfig&) { return PointToPixel{}; }));
  // The default is the ground, z = 0 of the base link.
  const detail::NumberKeys plane = {{"a", 0.0}, {"b", 0.0}, {"c", 1.0}, {"d", 0.0}, {"scale", 1.0}};
  const auto point_to_plane = [number](const BlockConfig& block) {
    return PointToPlane(number(block, "a"), number(block, "b"), number(block, "c"),
                        number(block, "d"));
  };
  add(built_in_block<PointToPlane>({{"model", "model_a"}}, plane, point_to_plane));
  add(built_in_block<PointToPlane>({{"camera", "model_a", "model"}}, plane, point_to_plane,
                                   "camera3d_to_ground"));
  add(built_in_block<PlaneToPlane>(
      pair, {{"normal_scale", 1.0}, {"offset_scale", 1.0}}, [number](const BlockConfig& block) {
        return PlaneToPlane{number(block, "normal_scale"), number(block, "offset_scale")};
      }));
  add(built_in_block<PointToMesh>({{"model", "model_a", "camera"}, {}}, {{"scale", 1.0}},
                                  [](const BlockConfig&) { return PointToMesh{}; }));
  add(detail::prior_entry());
  for (BlockEntry& entry : blocks_) entry.is_upstream = true;
  add(built_in_block<PointToOutline>({{}, {"model", "model_2d", "camera"}}, {{"scale", 1.0}},
                                     [](const BlockConfig&) { return PointToOutline{}; }));
  add(built_in_block<PointDistance>(
      pair, {{"length", 0.0}, {"scale", 1.0}},
      [](const BlockConfig& block) { return PointDistance{detail::length_of(block, "length")}; }));
  add(built_in_block<PointToLine>(
      {{"model", "model_a"}},
      {{"x", 0.0}, {"y", 0.0}, {"z", 0.0}, {"a", 0.0}, {"b", 0.0}, {"c", 1.0}, {"scale", 1.0}},
      [number](const BlockConfig& block) {
        return PointToLine({number(block, "x"), number(block, "y"), number(block, "z")},
                           {number(block, "a"), number(block, "b"), number(block, "c")});
      }));
  add(built_in_block<PointToSphere>(
      {{"model", "model_a"}}, {{"x", 0.0}, {"y", 0.0}, {"z", 0.0}, {"radius", 0.0}, {"scale", 1.0}},
      [number](const BlockConfig& block) {
        return PointToSphere{{number(block, "x"), number(block, "y"), number(block, "z")},
                             detail::length_of(block, "radius")};
      }));
  add(built_in_block<PointOnPlane>(pair, {{"scale", 1.0}},
                                   [](const BlockConfig&) { return PointOnPlane{}; }));
  add(built_in_block<PointOnLine>(pair, {{"scale", 1.0}},
                                  [](const BlockConfig&) { return PointOnLine{}; }));
  add(built_in_block<GravitySeen>(
      {{"model", "model_a"}}, {{"x", 0.0}, {"y", 0.0}, {"z", 9.80665}, {"scale", 1.0}},
      [number](const BlockConfig& block) {
        return GravitySeen{{number(block, "x"), number(block, "y"), number(block, "z")}};
      }));
  add(built_in_block<PoseToPose>(
      pair, {{"translation_scale", 1.0}, {"rotation_scale", 1.0}},
      [number](const BlockConfig& block) {
        return PoseToPose{number(block, "translation_scale"), number(block, "rotation_scale")};
      }));
  add(built_in_block<RayToRay>(pair, {{"scale", 1.0}},
                               [](const BlockConfig&) { return RayToRay{}; }));
  add(detail::base_entry<DifferentialToPose>());
  add(detail::base_entry<DifferentialToWall>());
  add(detail::base_entry<MecanumToPose>());
  add(detail::base_entry<MecanumToWall>());
  add(detail::base_entry<TricycleToPose>());
  add(detail::base_entry<TricycleToWall>());
  add(detail::base_entry<OdometryToPose>());
  add(detail::base_entry<OdometryToWall>());
  add(detail::gyro_entry<GyroToPose>());
  add(detail::gyro_entry<GyroToWall>());
  detail::NumberKeys of_magnetometer;
  for (const ParameterInfo& own : MagneticField::kParameters)
    of_magnetometer.emplace_back(own.name, own.initial);
  of_magnetometer.emplace_back("scale", 1.0);
  add(built_in_block<MagneticField>({}, of_magnetometer, [number](const BlockConfig& block) {
    MagneticField made;
    for (std::size_t i = 0; i < made.start.size(); ++i)
      made.start[i] = number(block, MagneticField::kParameters[i].name.data());
    if (!(made.start.back() > 0.0)) throw std::invalid_argument("field is not positive");
    return made;
  }));
}

void Registry::add(SensorEntry entry) {
  const auto known = std::find_if(sensors_.begin(), sensors_.end(),
                                  [&](const SensorEntry& one) { return one.type == entry.type; });
  if (known != sensors_.end() && !entry.lenses.empty() && !known->lenses.empty()) {
    return detail::add_lens(std::move(entry), *known);
  }
  if (known != sensors_.end()) {
    throw std::invalid_argument("sensor type '" + entry.type + "' is registered already");
  }
  sensors_.push_back(std::move(entry));
}

void Registry::add(BlockEntry entry) {
  if (block(entry.type) != nullptr) {
    throw std::invalid_argument("error block type '" + entry.type + "' is registered already");
  }
  blocks_.push_back(std::move(entry));
}

const SensorEntry* Registry::sensor(const std::string& type) const {
  const auto it = std::find_if(sensors_.begin(), sensors_.end(),
                               [&](const SensorEntry& entry) { return entry.type == type; });
  return it == sensors_.end() ? nullptr : &*it;
}

const BlockEntry* Registry::block(const std::string& type) const {
  const auto it = std::find_if(blocks_.begin(), blocks_.end(),
                               [&](const BlockEntry& entry) { return entry.type == type; });
  return it == blocks_.end() ? nullptr : &*it;
}

Registry& registry() {
  static Registry all;
  return all;
}

const SensorEntry* entry_of(const ModelConfig& model) {
  return model.own ? model.own.get() : registry().sensor(model.type);
}

const BlockEntry* entry_of(const BlockConfig& block) {
  return block.own ? block.own.get() : registry().block(block.type);
}

}  // namespace kinecal
