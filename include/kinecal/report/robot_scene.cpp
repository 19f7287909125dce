// Building the scene of a calibration.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/robot_scene.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/errors/plane_fit.hpp"
#include "kinecal/errors/point_to_mesh.hpp"
#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/kinematics/floating_joint.hpp"
#include "kinecal/parameters/chain_parameters.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/report/left_out.ipp"
#include "kinecal/text/frame_name.hpp"
#include "kinecal/text/reading.hpp"
#include "kinecal/trust/uncertainty/feature_places.hpp"

namespace kinecal {

namespace detail {
namespace {

// The features of a scene: measured and predicted points before and after, and their errors.

// Measured and predicted points for each kind of error block.

/// A pair of points; nullopt if one of them is NaN.
[[nodiscard]] std::optional<ScenePair> scene_pair(const Vector3<double>& measured,
                                                  const Vector3<double>& predicted) {
  if (!measured.allFinite() || !predicted.allFinite()) return std::nullopt;
  const auto numbers = [](const Vector3<double>& p) { return ScenePoint{p.x(), p.y(), p.z()}; };
  return ScenePair{numbers(measured), numbers(predicted)};
}

/// A point, and the point of a line of sight at its depth; nullopt behind the camera.
[[nodiscard]] std::optional<ScenePair> pair_at_depth(const PlacedFeature& predicted,
                                                     const PlacedFeature& ray) {
  const double depth = ray.axis.dot(predicted.point - ray.origin);
  if (!(depth > 0.0)) return std::nullopt;
  return scene_pair(ray.origin + ray.point * (depth / ray.axis.dot(ray.point)), predicted.point);
}

/// Where two lines of sight are nearest to each other; nullopt if they are parallel.
[[nodiscard]] std::optional<ScenePair> pair_of_rays(const PlacedFeature& a,
                                                    const PlacedFeature& b) {
  const Vector3<double> u = a.point.normalized(), v = b.point.normalized();
  const Vector3<double> way = b.origin - a.origin;
  const double c = u.dot(v), across = 1.0 - c * c;
  if (!(across > 1e-12)) return std::nullopt;
  const double along_a = (way.dot(u) - c * way.dot(v)) / across,
               along_b = (c * way.dot(u) - way.dot(v)) / across;
  return scene_pair(a.origin + u * along_a, b.origin + v * along_b);
}

/// The point at a distance from another one, towards the measured point.
[[nodiscard]] std::optional<ScenePair> pair_at_distance(const Vector3<double>& measured,
                                                        const Vector3<double>& from,
                                                        double distance) {
  return scene_pair(measured, from + (measured - from).normalized() * distance);
}

/// The plane through points; nullopt if they do not determine one.
[[nodiscard]] std::optional<Plane<double>> plane_through(
    const std::vector<Vector3<double>>& points) {
  if (points.size() < 3) return std::nullopt;
  const PlaneFit<double> fit(points);
  if (!fit.determined()) return std::nullopt;
  return fit.plane();
}

/// The foot of each point of a sensor on the plane of the other sensor's; both ways.
[[nodiscard]] std::vector<std::optional<ScenePair>> pairs_of_planes(
    const std::vector<PlacedFeature>& a, const std::vector<PlacedFeature>& b) {
  const auto fit = [](const std::vector<PlacedFeature>& features) {
    std::vector<Vector3<double>> points;
    for (const PlacedFeature& feature : features) {
      if (feature.seen) points.push_back(feature.point);
    }
    return plane_through(points);
  };
  const auto of_a = fit(a), of_b = fit(b);
  if (!of_a || !of_b) return {};
  std::vector<std::optional<ScenePair>> pairs;
  const auto add = [&](const std::vector<PlacedFeature>& features, const Plane<double>& plane) {
    for (const PlacedFeature& feature : features) {
      if (!feature.seen) continue;
      const double off = plane.normal.dot(feature.point - plane.centroid);
      pairs.push_back(scene_pair(feature.point, feature.point - plane.normal * off));
    }
  };
  add(a, *of_b);
  add(b, *of_a);
  return pairs;
}

/// The normal of a plane when only distances of points are known: r = n . p + d.
///
/// In the principal axes of the points, the two components along their extent follow from a linear
/// fit.  Points near a plane hardly determine the third; the length of n gives it, with the sign
/// that fits.
class PlaneOfDistances {
 public:
  void add(const Vector3<double>& p, double r) {
    points_.push_back(p);
    distances_.push_back(r);
  }
  /// (3) unit vector; nullopt if the points are on one line.
  [[nodiscard]] std::optional<Vector3<double>> normal() const {
    const auto plane = plane_through(points_);
    if (!plane) return std::nullopt;
    const Vector3<double>&centroid = plane->centroid, &across = plane->normal;
    double mean = 0.0;
    for (const double r : distances_) mean += r / static_cast<double>(distances_.size());
    Matrix3<double> scatter = Matrix3<double>::Zero();
    Vector3<double> moment = Vector3<double>::Zero();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Vector3<double> q = points_[i] - centroid;
      scatter += q * q.transpose();
      moment += q * (distances_[i] - mean);
    }
    // The minimum of |q . n - r|^2 over n perpendicular to `across`: a term holds what is along it
    // at zero.
    const Matrix3<double> out = across * across.transpose(), in = Matrix3<double>::Identity() - out;
    const Matrix3<double> held = in * scatter * in + out * scatter.trace();
    const Vector3<double> along = held.inverse() * (in * moment);
    const double rest = std::sqrt(std::max(0.0, 1.0 - along.squaredNorm()));
    const auto misfit = [&](const Vector3<double>& n) {
      double sum = 0.0;
      for (std::size_t i = 0; i < points_.size(); ++i) {
        const double off = n.dot(points_[i] - centroid) - (distances_[i] - mean);
        sum += off * off;
      }
      return sum;
    };
    const Vector3<double> up = along + across * rest, down = along - across * rest;
    return (misfit(up) <= misfit(down) ? up : down).normalized();
  }

 private:
  std::vector<Vector3<double>> points_;
  std::vector<double> distances_;
};

// The observed and predicted features of a sample as points in the base.

/// The points of a problem for given parameters.
class ScenePoints {
 public:
  /// @param values  of all parameters of the table
  ScenePoints(const AnyProblem& problem, std::span<const double> values)
      : problem_(problem), values_(values), places_(problem, values) {}

  /// The pairs that a term compares in a sample, by feature; nullopt where undefined, empty if its
  /// kind cannot be drawn.
  /// @param sample  from AnyProblem::paired()
  [[nodiscard]] std::vector<std::optional<ScenePair>> pairs(const Term& term,
                                                            const Sample& sample) const {
    using enum Quantity;
    const auto quantities = term.quantities;
    const std::vector<Quantity> kinds(quantities.begin(), quantities.end());
    std::vector<std::vector<PlacedFeature>> seen;
    for (const int s : term.sensors) {
      const Observation* observation = sample.observation(sensor(s).mount().name);
      if (observation == nullptr || !is_known(sensor(s))) return {};
      seen.push_back(places_.placed(s, *observation, sample));
    }
    if (seen.empty()) return {};
    if (kinds == std::vector{plane, plane}) return pairs_of_planes(seen[0], seen[1]);
    std::vector<std::optional<ScenePair>> all;
    for (const std::size_t i : compared(term, sample)) {
      const PlacedFeature &a = seen.front()[i], &b = seen.back()[i];
      if (kinds == std::vector{point}) {
        all.push_back(alone(term, a.point));
      } else if (kinds == std::vector{point, pixel}) {
        all.push_back(pair_at_depth(a, b));
      } else if (kinds == std::vector{ray, ray}) {
        all.push_back(pair_of_rays(a, b));
      } else if (kinds == std::vector{point, point} || kinds == std::vector{pose, pose}) {
        const bool second = !is_camera(term.sensors[0]) && is_camera(term.sensors[1]);
        all.push_back(both(term, second ? b.point : a.point, second ? a.point : b.point));
      }
    }
    return all;
  }

  /// The points of a term's first sensor, in the base.
  /// @param sample  with an observation of it
  [[nodiscard]] std::vector<PlacedFeature> measured(const Term& term, const Sample& sample) const {
    const int s = term.sensors.front();
    return places_.placed(s, *sample.observation(sensor(s).mount().name), sample);
  }

  /// The features that a term compares: those that all of its sensors saw.
  [[nodiscard]] std::vector<std::size_t> compared(const Term& term, const Sample& sample) const {
    std::vector<std::size_t> all;
    std::size_t count = 0;
    std::vector<const Observation*> seen;
    for (const int s : term.sensors) {
      seen.push_back(sample.observation(sensor(s).mount().name));
      if (seen.back() == nullptr) return all;
      count = seen.size() == 1 ? seen[0]->features.size()
                               : std::min(count, seen.back()->features.size());
    }
    for (std::size_t i = 0; i < count; ++i) {
      const bool by_all = std::all_of(seen.begin(), seen.end(),
                                      [i](const auto* of) { return is_seen(of->features[i]); });
      if (by_all) all.push_back(i);
    }
    return all;
  }

 private:
  [[nodiscard]] const MountedSensor& sensor(int s) const {
    return problem_.sensors()[static_cast<std::size_t>(s)];
  }
  [[nodiscard]] bool is_camera(int s) const { return sensor(s).sensor().in_own_frame(); }

  /// Points, rays and poses have a place.
  [[nodiscard]] static bool is_known(const MountedSensor& sensor) {
    const std::optional<Quantity> places = sensor.sensor().places();
    return places && *places != Quantity::reading;
  }

  /// A point compared with a sphere, or with a plane whose foot is computed later.
  [[nodiscard]] std::optional<ScenePair> alone(const Term& term, const Vector3<double>& p) const {
    if (term.options.type != PointToSphere::kType) return scene_pair(p, p);
    const auto v = own<4>(term.parameters);
    return pair_at_distance(p, {v[0], v[1], v[2]}, v[3]);
  }
  [[nodiscard]] std::optional<ScenePair> both(const Term& term, const Vector3<double>& measured,
                                              const Vector3<double>& predicted) const {
    if (term.options.type == PointDistance::kType) {
      return pair_at_distance(measured, predicted, own<1>(term.parameters)[0]);
    }
    if (term.feature_size < 3) return std::nullopt;  // points that need not coincide
    return scene_pair(measured, predicted);
  }

  template <std::size_t N>
  [[nodiscard]] std::array<double, N> own(const std::vector<int>& parameters) const {
    std::array<double, N> all{};
    for (std::size_t i = 0; i < std::min(N, parameters.size()); ++i) {
      if (parameters[i] >= 0) all[i] = values_[static_cast<std::size_t>(parameters[i])];
    }
    return all;
  }

  const AnyProblem& problem_;
  std::span<const double> values_;
  FeaturePlaces places_;
};

/// Residuals of the shown samples: by sample and term.
using SceneResiduals = std::map<std::pair<int, int>, std::vector<double>>;

[[nodiscard]] SceneResiduals scene_residuals(const AnyProblem& problem,
                                             std::span<const double> values,
                                             const std::vector<std::size_t>& shown) {
  SceneResiduals all;
  (void)evaluate(problem, values, nullptr, [&](int t, int sample, const TermResiduals& of) {
    if (!std::binary_search(shown.begin(), shown.end(), static_cast<std::size_t>(sample))) return;
    all[{sample, t}].assign(of.residual.begin(), of.residual.end());
  });
  return all;
}

/// Points of blocks that compare with a plane: their feet are computed once all points are known.
[[nodiscard]] bool is_point_to_plane(const Term& term) {
  return term.options.type == PointToPlane::kType;
}

/// Thousands of points, drawn as a cloud.
[[nodiscard]] bool is_on_surface(const Term& term) {
  return term.options.type == PointToMesh::kType;
}

/// True if a block's features can be drawn; single points with a sphere or a plane.
[[nodiscard]] bool can_be_drawn(const Term& term) {
  if (is_on_surface(term)) return false;
  return term.quantities.size() != 1 || is_point_to_plane(term) ||
         term.options.type == PointToSphere::kType;
}

/// Limits the features of a sample: the worst quarter, others evenly.
std::size_t thin_features(std::vector<SceneFeature>& features, std::size_t most) {
  const std::size_t all = features.size();
  if (all <= most) return all;
  std::vector<std::size_t> order(all);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return features[a].distance.value_or(0.0) > features[b].distance.value_or(0.0);
  });
  const std::size_t worst = most / 4;
  std::sort(order.begin() + static_cast<std::ptrdiff_t>(worst), order.end());
  std::vector<std::size_t> chosen(order.begin(),
                                  order.begin() + static_cast<std::ptrdiff_t>(worst));
  const std::size_t others = all - worst, wanted = most - worst;
  for (std::size_t i = 0; i < wanted; ++i) chosen.push_back(order[worst + i * others / wanted]);
  std::sort(chosen.begin(), chosen.end());
  std::vector<SceneFeature> kept;
  for (const std::size_t i : chosen) kept.push_back(std::move(features[i]));
  features = std::move(kept);
  return most;
}

/// Adds the features of a problem's samples to a scene.
class SceneFeatures {
 public:
  SceneFeatures(const AnyProblem& problem, const Findings& findings, std::span<const double> before,
                std::span<const double> after, const std::vector<std::size_t>& shown)
      : problem_(problem),
        findings_(findings),
        points_{ScenePoints(problem, before), ScenePoints(problem, after)},
        residuals_{scene_residuals(problem, before, shown), scene_residuals(problem, after, shown)},
        planes_(static_cast<std::size_t>(problem.num_terms())) {}

  [[nodiscard]] std::vector<SceneFeature> of(int sample, const Sample& recorded) {
    const std::optional<Sample> paired = problem_.paired(recorded);
    std::vector<SceneFeature> features;
    for (int t = 0; t < problem_.num_terms(); ++t) {
      const Term& term = problem_.term(t);
      if (!can_be_drawn(term)) continue;
      const std::size_t first = features.size();
      for (std::size_t when = 0; when < 2; ++when) {
        const auto residuals = residuals_[when].find({sample, t});
        if (residuals == residuals_[when].end()) continue;  // it does not apply, or is undefined
        const auto pairs = points_[when].pairs(term, paired ? *paired : recorded);
        if (features.size() == first) add(t, sample, pairs.size(), features);
        for (std::size_t i = 0; i < std::min(pairs.size(), features.size() - first); ++i) {
          set(term, when, i, residuals->second, pairs[i], features[first + i]);
        }
      }
    }
    std::erase_if(features, [](const SceneFeature& of) { return !of.before && !of.after; });
    return features;
  }

  /// Sets the points of a sample that are compared with the surface of the robot.
  /// @param most  of each block and time
  void set_matched(int sample, const Sample& recorded, std::size_t most, SceneSample& shown) const {
    const std::optional<Sample> paired = problem_.paired(recorded);
    for (int t = 0; t < problem_.num_terms(); ++t) {
      const Term& term = problem_.term(t);
      if (!is_on_surface(term)) continue;
      for (const std::size_t when : {0U, 1U}) {
        const auto residuals = residuals_[when].find({sample, t});
        if (residuals == residuals_[when].end()) continue;
        if (when == 0 && !has_before(findings_, problem_, term)) continue;
        add_evenly(points_[when], term, paired ? *paired : recorded, residuals->second, most,
                   when == 0 ? shown.matched_before : shown.matched_after);
      }
    }
  }

  /// Sets the feet of points on planes.
  void set_feet(RobotScene& scene) const {
    std::vector<std::optional<Vector3<double>>> normals;
    for (const PlaneOfDistances& plane : planes_) normals.push_back(plane.normal());
    for (SceneSample& sample : scene.samples) {
      for (SceneFeature& feature : sample.features) {
        const auto t = static_cast<std::size_t>(feature.block);
        if (!is_point_to_plane(problem_.term(feature.block))) continue;
        move(feature.before, normals[t]);
        move(feature.after, normals[t]);
      }
      std::erase_if(sample.features,
                    [](const SceneFeature& of) { return !of.before && !of.after; });
    }
  }

 private:
  void add(int t, int sample, std::size_t count, std::vector<SceneFeature>& features) const {
    const bool plane = !problem_.term(t).pairs_features();
    for (std::size_t i = 0; i < count; ++i) {
      const auto n = static_cast<std::ptrdiff_t>(i);
      features.push_back(
          {.block = t,
           .name = plane ? fmt::format("point {}", i + 1) : problem_.feature(t, sample, n).text(),
           .before = {},
           .after = {}});
    }
  }

  void set(const Term& term, std::size_t when, std::size_t i, const std::vector<double>& residuals,
           const std::optional<ScenePair>& pair, SceneFeature& feature) {
    (when == 0 ? feature.before : feature.after) = pair;
    const auto size = static_cast<std::size_t>(term.feature_size);
    if (!term.pairs_features() || (i + 1) * size > residuals.size()) return;
    double squares = 0.0;
    for (std::size_t k = i * size; k < (i + 1) * size; ++k) squares += residuals[k] * residuals[k];
    if (pair && is_point_to_plane(term)) {
      const ScenePoint& p = (*pair)[0];
      planes_[static_cast<std::size_t>(feature.block)].add({p[0], p[1], p[2]}, residuals[i]);
      // The distance is kept here until the normal is known.
      (when == 0 ? feature.before : feature.after) = ScenePair{p, {residuals[i], 0.0, 0.0}};
    }
    if (when == 0) return;
    feature.distance = std::sqrt(squares);
    feature.error = reading(*feature.distance, term.options.unit);
  }

  static void add_evenly(const ScenePoints& points, const Term& term, const Sample& sample,
                         const std::vector<double>& residuals, std::size_t most,
                         SceneCloud& cloud) {
    const std::vector<std::size_t> compared = points.compared(term, sample);
    const std::vector<PlacedFeature> measured = points.measured(term, sample);
    const std::size_t all = std::min(compared.size(), residuals.size()), kept = std::min(all, most);
    for (std::size_t n = 0; n < kept; ++n) {
      const std::size_t i = n * all / kept;
      const Vector3<double>& p = measured[compared[i]].point;
      cloud.points.push_back({p.x(), p.y(), p.z()});
      cloud.distances.push_back(std::abs(residuals[i]));
    }
  }

  static void move(std::optional<ScenePair>& pair, const std::optional<Vector3<double>>& normal) {
    if (!pair) return;
    if (!normal) {
      pair.reset();
      return;
    }
    auto& [p, foot] = *pair;
    const double off = foot[0];
    for (std::size_t k = 0; k < 3; ++k) foot[k] = p[k] - off * (*normal)(static_cast<int>(k));
  }

  const AnyProblem& problem_;
  const Findings& findings_;
  std::array<ScenePoints, 2> points_;
  std::array<SceneResiduals, 2> residuals_;
  std::vector<PlaneOfDistances> planes_;  ///< of each term
};

void add_features(const AnyProblem& problem, const Findings& findings,
                  std::span<const Sample> samples, const std::vector<std::size_t>& shown,
                  const SceneLimits& limits, RobotScene& scene) {
  std::vector<double> before, after;
  for (const Parameter& parameter : findings.result.table) {
    before.push_back(parameter.initial);
    after.push_back(parameter.value);
  }
  SceneFeatures features(problem, findings, before, after, shown);
  std::size_t all = 0, kept = 0;
  constexpr std::size_t kMostPoints = 5'000;  // of a cloud
  const std::size_t count = std::max<std::size_t>(1, shown.size()),
                    each = std::max<std::size_t>(4, limits.features / count),
                    points = std::min(limits.points / count, kMostPoints);
  for (std::size_t n = 0; n < shown.size(); ++n) {
    SceneSample& sample = scene.samples[n];
    sample.features = features.of(static_cast<int>(shown[n]), samples[shown[n]]);
    features.set_matched(static_cast<int>(shown[n]), samples[shown[n]], points, sample);
    all += sample.features.size();
    kept += thin_features(sample.features, each);
  }
  features.set_feet(scene);
  if (kept == all) return;
  scene.thinned +=
      (scene.thinned.empty() ? "" : ", ") + fmt::format("{} of {} features in them", kept, all);
}

// Floating joints in a scene.

/// True for a floating joint that moves a sensor or target, so that the samples have its pose.
[[nodiscard]] bool is_measured(const AnyProblem& problem, const Joint& joint) {
  const auto is_part = [&](const ChainJoint& part) { return part.floating == joint.name; };
  if (joint.type != JointType::floating) return false;
  for (const MountedSensor& sensor : problem.sensors()) {
    for (const SampledChain& chain : sensor.chains()) {
      const auto& joints = chain.chain().joints;
      if (std::any_of(joints.begin(), joints.end(), is_part)) return true;
    }
  }
  return false;
}

/// A coordinate of a floating joint, without links and drive; nothing is drawn between its links.
[[nodiscard]] SceneJoint scene_coordinate(const Joint& joint, std::size_t i) {
  SceneJoint shown;
  const bool slides = i < 3;
  shown.name = joint.name;
  shown.type = slides ? JointType::prismatic : JointType::continuous;
  if (i == 0) shown.origin = joint.origin;
  shown.axis = {};
  shown.axis[slides ? i : 5 - i] = 1.0;
  shown.is_virtual = true;
  return shown;
}

// The robot of a scene: links, joints, virtual frames and cameras.

/// Adds links, joints and cameras to a scene.
class SceneRobot {
 public:
  SceneRobot(const AnyProblem& problem, const ParameterTable& table, RobotScene& scene)
      : problem_(problem), table_(table), scene_(scene) {
    for (const std::string& link : problem.robot().link_names()) add_link(link);
    scene_.base = links_.at(problem.base());
    for (const Joint& joint : problem.robot().joints()) add_joint(joint);
  }

  /// Adds the frames beyond a link that contain features of the samples.
  void add_frames(std::span<const Sample> samples) {
    std::set<std::pair<std::string, std::string>> known;
    for (const Sample& sample : samples) {
      for (const MountedSensor& sensor : problem_.sensors()) {
        const Observation* seen =
            sensor.sensor().in_own_frame() ? nullptr : sample.observation(sensor.mount().name);
        if (seen == nullptr) continue;
        const std::string* last = nullptr;  // most features have the frame of the previous one
        for (const Feature& feature : seen->features) {
          if (last != nullptr && *last == feature.frame) continue;
          last = &feature.frame;
          const std::string* frame = frame_among(problem_.frames(), feature.frame);
          const bool beyond = frame != nullptr && !problem_.robot().has_joint(*frame);
          if (beyond && known.insert({sensor.mount().frame, *frame}).second) {
            add_frame(sensor.mount().frame, *frame);
          }
        }
      }
    }
  }

  /// Adds the cameras with their settings in the first sample that has them.
  void add_cameras(std::span<const Sample> samples) {
    for (const MountedSensor& sensor : problem_.sensors()) {
      if (!sensor.sensor().is_camera()) continue;
      for (const Sample& sample : samples) {
        const Observation* seen = sample.observation(sensor.mount().name);
        if (seen != nullptr && seen->camera && add_camera(sensor, *seen)) break;
      }
    }
  }

 private:
  int add_link(const std::string& name) {
    std::string unique = name;
    for (int n = 2; links_.contains(unique); ++n) unique = name + " (" + std::to_string(n) + ")";
    links_.emplace(unique, static_cast<int>(scene_.links.size()));
    scene_.links.push_back({unique});
    return static_cast<int>(scene_.links.size()) - 1;
  }

  /// A floating joint as its coordinates, with links between that have no names.
  void add_floating(const Joint& joint) {
    int parent = links_.at(joint.parent);
    for (std::size_t i = 0; i < kFloatingCoordinates.size(); ++i) {
      SceneJoint shown = scene_coordinate(joint, i);
      shown.parent = parent;
      shown.child = i + 1 < kFloatingCoordinates.size() ? add_link("") : links_.at(joint.child);
      shown.drive = position_of(floating_coordinate(joint.name, i));
      parent = shown.child;
      scene_.joints.push_back(std::move(shown));
    }
  }

  void add_joint(const Joint& joint) {
    if (is_measured(problem_, joint)) return add_floating(joint);
    SceneJoint shown{.name = joint.name,
                     .type = joint.type,
                     .parent = links_.at(joint.parent),
                     .child = links_.at(joint.child),
                     .origin = joint.origin,
                     .axis = {joint.axis.x(), joint.axis.y(), joint.axis.z()}};
    const Mimic by = drive(problem_.robot(), joint);
    if (moves(joint.type)) {
      shown.drive = position_of(by.joint);
      shown.multiplier = by.multiplier;
      shown.offset = by.offset;
    }
    ChainJoint corrected;
    corrected.name = joint.name;
    corrected.type = joint.type;
    corrected.corrected = problem_.frames().contains(joint.name);
    corrected.drive = by;
    add_corrections(corrected, shown);
  }

  void add_frame(const std::string& link, const std::string& frame) {
    const int parent = links_.at(link);
    SceneJoint shown;
    shown.name = frame;
    shown.parent = parent;
    shown.child = add_link(frame);
    shown.is_virtual = true;
    ChainJoint corrected;
    corrected.name = frame;
    corrected.corrected = true;
    add_corrections(corrected, shown);
  }

  /// Adds the joint with its corrections.
  void add_corrections(const ChainJoint& joint, SceneJoint& shown) {
    const OffsetAndFrame indices =
        joint_indices(joint, [&](std::string_view owner, std::string_view part) {
          return table_.find(part.empty() ? std::string(owner) : parameter_name(owner, part));
        });
    const auto correction = [&](double Parameter::*value) {
      SceneCorrection of;
      const auto get = [&](int i) { return i < 0 ? 0.0 : table_[i].*value; };
      for (std::size_t k = 0; k < 3; ++k) {
        of.t[k] = get(indices.frame[k]);
        of.r[k] = get(indices.frame[k + 3]);
      }
      of.offset = get(indices.offset) * indices.gain;
      return of;
    };
    const auto has = [](const auto& all) {
      return std::any_of(all.begin(), all.end(), [](int i) { return i >= 0; });
    };
    if (indices.offset >= 0 || has(indices.frame)) {
      shown.before = correction(&Parameter::initial);
      shown.after = correction(&Parameter::value);
    }
    scene_.joints.push_back(std::move(shown));
  }

  [[nodiscard]] int position_of(const std::string& joint) {
    auto& names = scene_.names;
    const auto found = std::find(names.begin(), names.end(), joint);
    const auto place = static_cast<int>(found - names.begin());
    if (found == names.end()) names.push_back(joint);
    return place;
  }

  bool add_camera(const MountedSensor& sensor, const Observation& seen) {
    try {
      const std::vector<double> s = sensor.sensor().settings(seen);
      const auto corrected = [&](std::size_t i) {
        const int parameter = sensor.parameters()[i];
        return s[i] * (1.0 + (parameter < 0 ? 0.0 : table_[parameter].value));
      };
      SceneCamera shown{.name = sensor.mount().name,
                        .link = links_.at(sensor.mount().frame),
                        .width = static_cast<double>(seen.camera->width),
                        .height = static_cast<double>(seen.camera->height),
                        .fx = corrected(0),
                        .fy = corrected(1),
                        .cx = corrected(2),
                        .cy = corrected(3)};
      if (!(shown.width > 0.0)) shown.width = 2.0 * shown.cx;  // not recorded
      if (!(shown.height > 0.0)) shown.height = 2.0 * shown.cy;
      scene_.cameras.push_back(std::move(shown));
      return true;
    } catch (const SettingsError&) {
      return false;
    }
  }

  const AnyProblem& problem_;
  const ParameterTable& table_;
  RobotScene& scene_;
  std::map<std::string, int> links_;
};

/// The robot of a problem, without samples.
[[nodiscard]] RobotScene scene_of_robot(const AnyProblem& problem, const ParameterTable& table,
                                        std::span<const Sample> samples) {
  RobotScene scene;
  SceneRobot robot(problem, table, scene);
  robot.add_frames(samples);
  robot.add_cameras(samples);
  for (int t = 0; t < problem.num_terms(); ++t) scene.blocks.push_back(problem.term(t).name);
  return scene;
}

/// The problem solved last; nullptr if absent.
[[nodiscard]] const CalibrationStep* last_step(const Calibration& calibration,
                                               const CalibrationResult& result) {
  if (calibration.steps.empty()) return nullptr;
  const std::size_t ran = std::max<std::size_t>(1, result.steps.size());
  return &calibration.steps[std::min(ran, calibration.steps.size()) - 1];
}

/// Indices of the samples to show, ascending: bad ones, worst ones, others evenly.
[[nodiscard]] std::vector<std::size_t> shown_samples(const Findings& findings, std::size_t all,
                                                     std::size_t most) {
  std::vector<std::size_t> chosen;
  std::vector<bool> taken(all, all <= most);
  std::size_t left = most;
  if (all > most && !findings.assessments.empty()) {
    std::vector<CaptureError> captures = findings.assessments.back().captures;
    std::stable_sort(captures.begin(), captures.end(), [](const auto& a, const auto& b) {
      return std::pair(a.bad, a.times) > std::pair(b.bad, b.times);
    });
    for (std::size_t i = 0; i < captures.size() && left > most / 2; ++i) {
      const auto sample = static_cast<std::size_t>(captures[i].sample);
      if ((i >= most / 10 && !captures[i].bad) || sample >= all || taken[sample]) continue;
      taken[sample] = true;
      --left;
    }
  }
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < all; ++i) {
    if (!taken[i]) others.push_back(i);
  }
  for (std::size_t i = 0; i < left && all > most; ++i)
    taken[others[i * others.size() / left]] = true;
  for (std::size_t i = 0; i < all; ++i) {
    if (taken[i]) chosen.push_back(i);
  }
  return chosen;
}

/// Marks a sample as left out.
void mark_left_out(const LeftOutSample& left, SceneSample& shown) {
  shown.number = left.number;
  shown.bad = shown.left_out = true;
  shown.note = left.why;
}

/// Number, source location, joint positions and fault, without features.
/// @param i     index among those used, then those left out
/// @param used  number of the former
[[nodiscard]] SceneSample scene_sample(const RobotScene& scene, const Findings& findings,
                                       const Sample& sample, std::size_t i, std::size_t used) {
  SceneSample shown{
      .number = i < findings.numbers.size() ? findings.numbers[i] : static_cast<int>(i) + 1,
      .source = sample.source,
      .bad = false,
      .left_out = false,
      .note = {},
      .q = {},
      .features = {},
      .stamp = sample.stamp};
  for (const std::string& name : scene.names) {
    const double q = sample.position(name).value_or(0.0);
    shown.q.push_back(std::isfinite(q) ? q : 0.0);
  }
  if (i >= used) mark_left_out(findings.left_out[i - used], shown);
  if (i >= used || findings.assessments.empty()) return shown;
  const Assessment& last = findings.assessments.back();
  const auto error = std::find_if(
      last.captures.begin(), last.captures.end(),
      [i](const CaptureError& of) { return of.bad && static_cast<std::size_t>(of.sample) == i; });
  if (error == last.captures.end()) return shown;
  shown.bad = true;
  shown.note = capture_text(*error, last) + cause_text(findings, static_cast<int>(i));
  return shown;
}

}  // namespace
}  // namespace detail

RobotScene robot_scene(const Calibration& calibration, const Findings& findings,
                       std::span<const Sample> samples, const SceneLimits& limits,
                       std::span<const Sample> left_out) {
  const CalibrationStep* step = detail::last_step(calibration, findings.result);
  if (step == nullptr) return {};
  const std::size_t used = samples.size(), of_left = std::min(left_out.size(), limits.samples / 2);
  const detail::ProblemWithLeftOut all(*step->problem, samples, left_out.first(of_left));
  RobotScene scene = detail::scene_of_robot(all.problem(), findings.result.table, all.samples());
  scene.robot = findings.robot;
  std::vector<std::size_t> shown = detail::shown_samples(findings, used, limits.samples - of_left);
  for (std::size_t i = 0; i < of_left; ++i) shown.push_back(used + i);
  if (shown.size() < used + left_out.size()) {
    scene.thinned = fmt::format("{} of {} samples", shown.size(), used + left_out.size());
  }
  for (const std::size_t i : shown) {
    scene.samples.push_back(detail::scene_sample(scene, findings, all.samples()[i], i, used));
  }
  detail::add_features(all.problem(), findings, all.samples(), shown, limits, scene);
  std::stable_sort(scene.samples.begin(), scene.samples.end(),
                   [](const SceneSample& a, const SceneSample& b) { return a.number < b.number; });
  return scene;
}

Pose<double> child_in_parent(const SceneJoint& joint, std::span<const double> q, bool corrected) {
  Pose<double> pose = joint.origin;
  const std::optional<SceneCorrection>& correction = corrected ? joint.after : joint.before;
  if (correction) {
    const auto& [t, r, offset] = *correction;
    pose = pose * Pose<double>{exp(Vector3<double>(r[0], r[1], r[2])), {t[0], t[1], t[2]}};
  }
  if (!moves(joint.type) || joint.drive < 0) return pose;
  const double measured = q[static_cast<std::size_t>(joint.drive)];
  double position = joint.multiplier * measured + joint.offset;
  if (correction) position += correction->offset;
  const Vector3<double> axis(joint.axis[0], joint.axis[1], joint.axis[2]);
  const Vector3<double> along = axis * position;
  return pose * (turns(joint.type) ? Pose<double>{exp(along), Vector3<double>::Zero()}
                                   : Pose<double>{Matrix3<double>::Identity(), along});
}

}  // namespace kinecal
