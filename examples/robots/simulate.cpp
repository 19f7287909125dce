// SPDX-License-Identifier: Apache-2.0
#include "simulate.hpp"

#include <algorithm>

namespace kinecal::examples {
namespace {

constexpr double kEncoder = 2e-5;  // standard deviation, radians or metres

/// Sizes of the URDF's errors.
double deviation(const Robot& robot, const ExampleParameter& parameter, SeededRandom& random) {
  const auto is = [&](const std::string_view part) { return parameter.part == part; };
  if (is("x") || is("y") || is("z")) return random.either_sign(0.005, 0.01);
  if (is("a") || is("b") || is("c")) return random.either_sign(1.0, 2.0) * kDegree;
  if (is("z_offset")) return random.either_sign(0.003, 0.007);
  if (is("z_scaling")) return random.either_sign(0.005, 0.015);
  if (!parameter.part.empty()) return random.either_sign(0.01, 0.02);
  const bool turning = turns(robot.joint(parameter.owner).type);
  return turning ? random.either_sign(2.0, 4.0) * kDegree : random.either_sign(0.005, 0.01);
}

ParameterTable random_truth(const RobotExample& example, SeededRandom& random) {
  ParameterTable truth;
  for (const ExampleParameter& parameter : example.free) {
    truth.add({.name = parameter.name, .value = deviation(example.robot, parameter, random)});
  }
  return truth;
}

double uniform_position(const Joint& joint, SeededRandom& random) {
  const double most = turns(joint.type) ? std::numbers::pi : 0.5;  // without limits
  return joint.limits && joint.limits->upper > joint.limits->lower
             ? random.uniform(joint.limits->lower, joint.limits->upper)
             : random.uniform(-most, most);
}

bool is_camera(const ExampleSensor& sensor) {
  return sensor.type != ChainPoint::kType;
}

Measuring measuring_of(const ExampleSensor& eye) {
  return eye.measuring.value_or(eye.type == PinholeCamera::kType ? kPinhole : Measuring{});
}

/// The target at the tip of a chain.
Target target_of(const ExampleSensor& carrier, const ExampleSensor& eye) {
  return carrier.target.value_or(is_camera(eye) ? Target{} : kReflector);
}

/// The points of a target in its frame.
std::vector<Vector3<double>> points_of(const Target& target) {
  std::vector<Vector3<double>> points;
  for (int row = 0; row < target.rows; ++row) {
    for (int column = 0; column < target.columns; ++column) {
      const double x = target.step_x * (column - 0.5 * (target.columns - 1));
      const double y = target.step_y * (row - 0.5 * (target.rows - 1));
      points.emplace_back(target.centre[0] + x, target.centre[1] + y, target.centre[2]);
    }
  }
  return points;
}

/// Distance of a point from a camera's field of view: zero inside, growing outside.
double outside(const Intrinsics& camera, const Measuring& measuring,
               const Vector3<double>& p_camera) {
  const double z = p_camera.z();
  if (z < measuring.near) return 3.0 - p_camera.normalized().z() + measuring.near - z;
  constexpr double kUsed = 0.9, kMost = 1.0;  // of the image; of each part below
  const double x = std::abs(camera.fx * p_camera.x() / z) / camera.cx - kUsed;
  const double y = std::abs(camera.fy * p_camera.y() / z) / camera.cy - kUsed;
  return std::clamp(x, 0.0, kMost) + std::clamp(y, 0.0, kMost) +
         std::clamp(z - measuring.far, 0.0, kMost);
}

/// How far a target faces away from an eye.
/// @param eye_T_target  its pose in the eye's frame
double turned_away(const Target& target, const Pose<double>& eye_T_target) {
  const bool is_flat = target.columns > 1 || target.rows > 1;
  if (!target.one_sided && !is_flat) return 0.0;
  constexpr double kWidest = 60.0 * kDegree;
  const double towards = -eye_T_target.rotation.col(2).dot(eye_T_target.translation.normalized());
  return std::max(0.0, std::cos(kWidest) - (target.one_sided ? towards : std::abs(towards)));
}

}  // namespace

Simulation::Simulation(const RobotExample& example, std::uint64_t seed)
    : example_(example),
      random_(seed),
      truth_(random_truth(example, random_)),
      robot_(example.robot, truth_, example.frames) {
  for (const Joint& joint : example.robot.joints()) {
    if (moves(joint.type) && !joint.mimic) joints_.push_back(&joint);
  }
}

std::vector<Sample> Simulation::samples(int pairs, int planes) {
  std::vector<Sample> all;
  for (const ExampleBlock& block : example_.blocks) {
    const Scene scene = scene_of(block);
    for (int n = 0; n < (scene.plane ? planes : pairs); ++n) {
      all.push_back(sample_of(block, scene));
      all.back().source = block.name + ", simulated sample " + std::to_string(n + 1);
    }
  }
  return all;
}

double Simulation::metres_a_pixel(const std::string& camera) const {
  const auto& [sum, count] = depths_.at(camera);
  return sum / count / intrinsics_of(example_camera_info()).fx;
}

Simulation::Scene Simulation::scene_of(const ExampleBlock& block) const {
  std::vector<const ExampleSensor*> sensors;
  for (const std::string& name : block.sensors) {
    const auto named = [&](const ExampleSensor& s) { return s.mount.name == name; };
    sensors.push_back(&*std::find_if(example_.sensors.begin(), example_.sensors.end(), named));
  }
  if (block.plane && is_camera(*sensors[0])) return {sensors[0], nullptr, block.plane};
  if (sensors.size() == 2) {
    const ExampleSensor *a = sensors[0], *b = sensors[1];
    if (is_camera(*a) != is_camera(*b)) return is_camera(*a) ? Scene{a, b, {}} : Scene{b, a, {}};
    if (!is_camera(*a) && a->moves != b->moves) return a->moves ? Scene{b, a, {}} : Scene{a, b, {}};
  }
  throw std::invalid_argument(
      "error block '" + block.name +
      "': simulated are a camera and a chain, a camera and a plane, and two chains of which one "
      "moves; give the program --samples of your own");
}

Pose<double> Simulation::tip(const ExampleSensor& sensor, const Positions& positions) const {
  return robot_.pose(example_.base, sensor.mount.frame, positions);
}

double Simulation::target_violation(const Scene& scene, const Positions& positions) const {
  const Target target = target_of(*scene.carrier, *scene.eye);
  const Pose<double> base_T_target =
      robot_.pose(example_.base, scene.carrier->mount.frame, positions, example_.virtual_frame);
  const Pose<double> eye_T_target = tip(*scene.eye, positions).inverse() * base_T_target;
  double violation = turned_away(target, eye_T_target);
  if (!is_camera(*scene.eye)) return violation;
  const Intrinsics camera = intrinsics_of(example_camera_info());
  for (const Vector3<double>& point : points_of(target)) {
    violation += outside(camera, measuring_of(*scene.eye), eye_T_target * point);
  }
  return violation;
}

double Simulation::plane_violation(const Scene& scene, const Positions& positions) const {
  const Pose<double> base_T_eye = tip(*scene.eye, positions);
  const double height = scene.plane->normal.dot(base_T_eye.translation) + scene.plane->distance;
  const double approach =
      -scene.plane->normal.dot(base_T_eye.rotation.col(2)) * std::copysign(1.0, height);
  return std::max(0.0, std::abs(height) / measuring_of(*scene.eye).far - approach);
}

std::vector<Vector3<double>> Simulation::plane_points(const Scene& scene,
                                                      const Positions& positions) const {
  const Pose<double> base_T_eye = tip(*scene.eye, positions);
  const double height = scene.plane->normal.dot(base_T_eye.translation) + scene.plane->distance;
  const Intrinsics camera = intrinsics_of(example_camera_info());
  const Measuring measuring = measuring_of(*scene.eye);
  std::vector<Vector3<double>> points;
  for (const double v : {-0.8, -0.3, 0.2, 0.7}) {  // of half the image
    for (const double u : {-0.8, -0.4, 0.0, 0.4, 0.8}) {
      const Vector3<double> ray(u * camera.cx / camera.fx, v * camera.cy / camera.fy, 1.0);
      const double depth = -height / scene.plane->normal.dot(base_T_eye.rotation * ray);
      if (depth > measuring.near && depth < 1.5 * measuring.far) points.push_back(ray * depth);
    }
  }
  return points;
}

Observation Simulation::observe(const ExampleSensor& eye,
                                const std::vector<Vector3<double>>& points) {
  const Measuring measuring = measuring_of(eye);
  Observation seen{eye.mount.name, {}, {}};
  std::array<double, 6> errors{};
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const int known = truth_.find(parameter_name(eye.mount.name, DepthCamera::kParameters[i].name));
    if (known >= 0) errors[i] = truth_[known].value;
  }
  if (is_camera(eye)) seen.camera = example_camera_info();
  auto& [depth, count] = depths_[eye.mount.name];
  for (const Vector3<double>& point : points) {
    depth += point.z();
    ++count;
    Vector3<double> reported = point;
    if (eye.type == DepthCamera::kType) {
      reported = recorded_point(intrinsics_of(*seen.camera), point, errors,
                                {measuring.pixel, measuring.depth}, random_);
    } else if (eye.type == PinholeCamera::kType) {
      const Eigen::Vector2d pixel =
          PinholeCamera{}.predict(point, PinholeCamera{}.settings(seen),
                                  std::array{errors[0], errors[1], errors[2], errors[3]});
      reported = {pixel.x() + measuring.pixel * random_.normal(),
                  pixel.y() + measuring.pixel * random_.normal(), 0.0};
    } else {
      for (int i = 0; i < 3; ++i) reported(i) += measuring.point * random_.normal();
    }
    seen.features.push_back({eye.mount.frame, reported});
  }
  return seen;
}

Sample Simulation::sample_of(const ExampleBlock& block, const Scene& scene) {
  Positions positions;
  try {
    positions = find_pose([&](const Positions& p) {
      return scene.plane ? plane_violation(scene, p) : target_violation(scene, p);
    });
  } catch (const std::runtime_error& e) {
    throw std::runtime_error("error block '" + block.name + "': " + e.what());
  }
  Sample sample = sample_at(positions);
  for (auto& [joint, position] : positions) position += kEncoder * random_.normal();
  if (scene.plane) {
    sample.observations = {observe(*scene.eye, plane_points(scene, positions))};
    return sample;
  }
  const Mount& carrier = scene.carrier->mount;
  const std::string& frame =
      example_.virtual_frame.empty() ? carrier.frame : example_.virtual_frame;
  const Pose<double> eye_T_target =
      tip(*scene.eye, positions).inverse() *
      robot_.pose(example_.base, carrier.frame, positions, example_.virtual_frame);
  Observation carried{carrier.name, {}, {}};
  std::vector<Vector3<double>> points;
  for (const Vector3<double>& point : points_of(target_of(*scene.carrier, *scene.eye))) {
    carried.features.push_back({frame, point});
    points.push_back(eye_T_target * point);
  }
  sample.observations = {observe(*scene.eye, points), carried};
  return sample;
}

Positions Simulation::find_pose(const Violation& violation) {
  constexpr int kStarts = 1000, kSearch = 400, kWander = 60;
  for (int start = 0; start < kStarts; ++start) {
    Positions positions;
    for (const Joint* joint : joints_) positions[joint->name] = uniform_position(*joint, random_);
    double least = violation(positions);
    const auto step = [&] {
      const Joint& joint = *joints_[std::size_t(random_.integer(0, int(joints_.size()) - 1))];
      const double before = positions[joint.name], anywhere = uniform_position(joint, random_);
      constexpr double kFar = 0.3;  // of the steps; the others are near
      const double way = random_.uniform(0.0, 1.0) < kFar ? 1.0 : random_.uniform(0.0, 0.2);
      positions[joint.name] = before + way * (anywhere - before);
      const double now = violation(positions);
      if (now <= least) {
        least = now;
      } else {
        positions[joint.name] = before;
      }
    };
    for (int n = 0; n < kSearch && least > 0.0; ++n) step();
    if (least > 0.0) continue;
    for (int n = 0; n < kWander; ++n) step();
    return positions;
  }
  throw std::runtime_error("no pose in which the target is seen");
}

}  // namespace kinecal::examples
