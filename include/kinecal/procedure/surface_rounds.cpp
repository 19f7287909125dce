// Definitions of surface_rounds.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/procedure/surface_rounds.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/loss_names.hpp"
#include "kinecal/files/urdf/visuals.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/procedure/matched_step.hpp"
#include "kinecal/procedure/outline_rounds.hpp"
#include "kinecal/surface/pose_search.hpp"
#include "kinecal/surface/surface_match.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/trust/uncertainty/feature_places.hpp"

namespace kinecal {

namespace detail {
namespace {

constexpr double kWidest = 0.3;      ///< metres, of the first gate
constexpr double kNarrowest = 0.01;  ///< metres, of a gate without a loss
constexpr double kOnRobot = 0.02;    ///< metres: a point within lies on the robot
constexpr int kFewPoints = 400;      ///< of a sample, in coarse rounds
constexpr int kFewestPoints = 120;   ///< of a sample, where ends of rounds are compared

/// How points count in a round.
struct RoundManner {
  double gate = kWidest;             ///< metres
  std::optional<double> huber = {};  ///< metres, of a loss in place of the configured one
  int rounds = 1;                    ///< at most
  double tolerance = 1e-6;           ///< relative fall of the cost at which rounds end
  bool only_front = false;  ///< a point on the far side of a link counts as if beyond the gate
  std::set<int> held = {};  ///< table indices of parameters that keep their values
};

/// A state of the rounds.
struct RoundState : MatchedSums {
  std::vector<SurfaceHits> hits = {};  ///< by block
};

/// The rounds of one step.
class SurfaceRounds {
 public:
  SurfaceRounds(const MatchedStep& step, std::span<const SurfaceBlock> blocks)
      : step_(step), blocks_(blocks) {}

  /// Goes downhill from values; returns the state in which it ended.
  /// @param samples  of the camera, without the surface
  /// @param hits     by block: those of the same samples for values that are near, or empty
  [[nodiscard]] RoundState run(const RoundManner& manner, std::span<const Sample> samples,
                               const Eigen::VectorXd& values,
                               std::vector<SurfaceHits> hits = {}) const {
    const std::unique_ptr<AnyProblem> problem = step_.problem(blocks_, manner.huber);
    const auto match = [&](Eigen::VectorXd at, const RoundState& before) {
      return evaluated(*problem, manner, samples, std::move(at), before.hits);
    };
    RoundState start = evaluated(*problem, manner, samples, values, std::move(hits));
    return go_downhill(problem->table(), std::move(start), manner.rounds, manner.tolerance, match);
  }

  [[nodiscard]] std::vector<Sample> matched(std::span<const Sample> samples,
                                            const std::vector<SurfaceHits>& hits,
                                            double gate) const {
    std::vector<Sample> all(samples.begin(), samples.end());
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      all = with_surface(blocks_[b].surface, blocks_[b].pair, std::move(all), hits[b], gate);
    }
    return all;
  }

  /// The nearest points of all samples.
  /// @param problem  of the step
  [[nodiscard]] std::vector<SurfaceHits> associated(const AnyProblem& problem,
                                                    std::span<const Sample> samples,
                                                    const Eigen::VectorXd& values, double bound,
                                                    std::vector<SurfaceHits> before = {}) const {
    before.resize(blocks_.size());
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      associate(blocks_[b].surface, blocks_[b].pair, problem, values, samples, bound,
                step_.input().threads, before[b]);
    }
    return before;
  }

 private:
  [[nodiscard]] RoundState evaluated(const AnyProblem& empty, const RoundManner& manner,
                                     std::span<const Sample> samples, Eigen::VectorXd values,
                                     std::vector<SurfaceHits> before) const {
    std::vector<SurfaceHits> hits =
        associated(empty, samples, values, manner.gate, std::move(before));
    for (SurfaceHits& of_block : hits) {
      for (auto& of_sample : of_block) {
        for (SurfaceHit& hit : of_sample) {
          if (manner.only_front && hit.facing < 0.0) hit = {};
        }
      }
    }
    std::vector<BeyondGate> beyond;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      BeyondGate& of_block = beyond.emplace_back(BeyondGate{blocks_[b].name, 0, manner.gate});
      for (const auto& of_sample : hits[b]) {
        of_block.count += static_cast<std::size_t>(
            std::count_if(of_sample.begin(), of_sample.end(),
                          [](const SurfaceHit& hit) { return hit.link < 0; }));
      }
    }
    const std::vector<Sample> with_points = matched(samples, hits, manner.gate);
    return {step_.sums(empty, with_points, std::move(values), beyond, manner.held),
            std::move(hits)};
  }

  const MatchedStep& step_;
  std::span<const SurfaceBlock> blocks_;
};

/// The cloud of a sample in a frame whose pose is searched for, and the links before it.
[[nodiscard]] PosedCloud posed_cloud(const SearchedFrame& frame, const AnyProblem& problem,
                                     const SurfaceBlock& block, const Sample& sample,
                                     const Eigen::VectorXd& values) {
  PosedCloud posed;
  const Observation* seen = sample.observation(block.pair.camera);
  if (seen == nullptr) return posed;
  const Eigen::VectorXd zero = frame.zeroed(values);
  const Pose<double> before_T_base = frame.before(sample, zero).inverse();
  const FeaturePlaces places(problem, zero);
  for (const PlacedFeature& point : places.placed(frame.camera_number(), *seen, sample)) {
    if (point.seen) posed.points.push_back(before_T_base * point.point);
  }
  posed.links = frame.links(block, sample, zero);
  return posed;
}

/// How well the points of a block lie on the robot.
struct SurfaceQuality {
  std::vector<double> distances;              ///< of all points, metres; infinite beyond the bound
  std::vector<std::vector<double>> of_links;  ///< of those nearest to each link

  [[nodiscard]] double share(double within) const { return share_of(distances, within); }

  /// At least 1 if the points lie on the robot.  Of points near a link that they are not of, a fit brings about half within a
  /// fifth of the distance; of those that are of it, three quarters and more, as far as the noise allows.  Links count alike:
  /// the base, which never moves, fits whatever the joints are.
  [[nodiscard]] double contrast() const {
    constexpr double kNear = 0.62, kFar = 0.78;
    return std::max(contrast(kOnRobot / 2.0) / kNear, contrast(kOnRobot) / kFar);
  }

 private:
  [[nodiscard]] static double share_of(const std::vector<double>& all, double within) {
    const auto count = std::count_if(all.begin(), all.end(), [&](double d) { return d <= within; });
    return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(1, all.size()));
  }
  /// The mean of links with points near them: their share that is nearer by a factor of five.
  [[nodiscard]] double contrast(double within) const {
    constexpr double kFewest = 30.0;  // points
    double sum = 0.0;
    int links = 0;
    for (const std::vector<double>& of_link : of_links) {
      const double around = share_of(of_link, 5.0 * within);
      if (around * static_cast<double>(of_link.size()) < kFewest) continue;
      sum += share_of(of_link, within) / around;
      ++links;
    }
    return links > 0 ? sum / links : 0.0;
  }
};

[[nodiscard]] SurfaceQuality quality_of(const SurfaceHits& hits) {
  SurfaceQuality quality;
  for (const auto& of_sample : hits) {
    for (const SurfaceHit& hit : of_sample) {
      quality.distances.push_back(hit.distance);
      if (hit.link < 0) continue;
      const auto link = static_cast<std::size_t>(hit.link);
      quality.of_links.resize(std::max(quality.of_links.size(), link + 1));
      quality.of_links[link].push_back(hit.distance);
    }
  }
  return quality;
}

/// The whole of the rounds of a step.
class SurfaceFit {
 public:
  SurfaceFit(const MatchedStep& step, std::span<const SurfaceBlock> blocks)
      : step_(step), blocks_(blocks), rounds_(step, blocks) {}

  /// Where the rounds end.
  /// @param unknown  frames whose pose may be searched for
  [[nodiscard]] RoundState run(std::span<const Sample> samples, const Eigen::VectorXd& start,
                               std::span<const UnknownFrame> unknown, Diagnostics& diagnostics) {
    const std::vector<Sample> few = thinned(samples, kFewPoints);
    const bool is_lost = std::any_of(unknown.begin(), unknown.end(),
                                     [](const UnknownFrame& frame) { return !frame.has_guess; });
    std::optional<RoundState> best;
    if (!is_lost) best = coarse(near(samples, start, kFewPoints), start, kSteady);
    if (!best || contrast(few, *best) < 1.0) {
      double least = best ? ranked(few, best->values) : std::numeric_limits<double>::infinity();
      std::optional<Eigen::VectorXd> found;
      std::vector<SearchEnd> ends;
      for (const Eigen::VectorXd& values : searched(samples, start, unknown)) {
        const RoundState end = coarse(near(samples, values, kFewestPoints), values, kQuick);
        const double rank = ranked(few, end.values);
        ends.push_back({end.values, rank});
        if (rank >= least) continue;
        least = rank;
        found = end.values;
      }
      if (unknown.size() == 1) alike_ = look_alike(unknown.front(), ends);
      if (found) {
        best =
            coarse(near(samples, *found, kFewPoints), *found, {.gates = {0.06, 0.03}, .rounds = 3});
      }
      if (is_lost && best) {
        diagnostics.notes.push_back("the pose of '" + unknown.front().name +
                                    "' was searched for: the surface of the robot in the clouds "
                                    "gives it");
      }
    }
    if (!best) best = coarse(few, start, kSteady);
    const RoundState end = fine(near(samples, best->values, kFewPoints), best->values);
    return fine(samples, end.values);
  }

  /// The gate where nothing moves the robot: that which rounds have found before, or the one that goes with the distances.
  void hold(std::span<const Sample> samples, const Eigen::VectorXd& values,
            const std::optional<double>& found) {
    RoundState state{{.values = values}, {}};
    if (found) {
      gate_ = *found;
    } else {
      set_gate(samples, 0, state);
    }
  }

  /// The median distances of clouds that had no say, with free joints and with held ones; nullopt if free ones bring them
  /// nearer.  Two halves of the samples are judged by each other.
  /// @param joints  table indices of free parameters of joints
  /// @param start   values with which joints are held
  /// @param end     where the rounds have ended
  [[nodiscard]] std::optional<std::pair<double, double>> bring_nothing(
      std::span<const Sample> samples, const std::set<int>& joints, const Eigen::VectorXd& start,
      const Eigen::VectorXd& end) const {
    constexpr std::size_t kFewest = 6;
    if (joints.empty() || samples.size() < kFewest) return std::nullopt;
    const std::vector<Sample> few = thinned(samples, kFewPoints);
    Eigen::VectorXd held = end;
    for (const int p : joints) held[p] = start[p];
    std::vector<double> gains, with, without;  // gains: of each sample
    for (std::size_t half = 0; half < 2; ++half) {
      std::vector<Sample> heard, judged;
      for (std::size_t s = 0; s < few.size(); ++s) {
        (s % 2 == half ? heard : judged).push_back(few[s]);
      }
      const auto distances = [&](const Eigen::VectorXd& from, const std::set<int>& fixed) {
        const RoundManner manner{.gate = gate_, .rounds = 15, .tolerance = 1e-5, .held = fixed};
        const RoundState fitted = rounds_.run(manner, heard, from);
        const std::vector<SurfaceHits> hits =
            rounds_.associated(*step_.problem(), judged, fitted.values, gate_);
        std::vector<std::vector<double>> all(judged.size());
        for (const SurfaceHits& of_block : hits) {
          for (std::size_t s = 0; s < judged.size(); ++s) {
            for (const SurfaceHit& hit : of_block[s]) {
              all[s].push_back(std::min(hit.distance, gate_));
            }
          }
        }
        return all;
      };
      const auto free = distances(end, {}), fixed = distances(held, joints);
      for (std::size_t s = 0; s < judged.size(); ++s) {
        std::vector<double> free_here, fixed_here;  // of points that are near the robot by either
        for (std::size_t i = 0; i < free[s].size(); ++i) {
          if (std::min(free[s][i], fixed[s][i]) >= gate_) continue;
          free_here.push_back(free[s][i]);
          fixed_here.push_back(fixed[s][i]);
        }
        if (free_here.empty()) continue;
        gains.push_back(median_of(fixed_here) - median_of(free_here));
        with.insert(with.end(), free_here.begin(), free_here.end());
        without.insert(without.end(), fixed_here.begin(), fixed_here.end());
      }
    }
    if (gains.size() < kFewest) return std::nullopt;
    const Eigen::Map<const Eigen::VectorXd> gain(gains.data(), std::ssize(gains));
    const double mean = gain.mean(), n = static_cast<double>(gains.size());
    const double error = std::sqrt((gain.array() - mean).square().sum() / (n * (n - 1.0)));
    constexpr double kSure = 2.0;  // standard errors
    if (mean > kSure * error) return std::nullopt;
    return std::pair(median_of(std::move(with)), median_of(std::move(without)));
  }

  /// The gate beyond which points of a block do not count in the end, metres.
  [[nodiscard]] double gate() const { return gate_; }
  /// What look_alike() says of a search.
  [[nodiscard]] const std::optional<std::string>& alike() const { return alike_; }

 private:
  /// How gates shrink.
  struct Shrinking {
    std::vector<double> gates;  ///< metres
    int rounds = 3;             ///< with each, at most
  };
  inline static const Shrinking kSteady{{kWidest, 0.18, 0.11, 0.065, 0.04, 0.03}, 3};
  inline static const Shrinking kQuick{{0.2, 0.1, 0.05, 0.03}, 2};

  [[nodiscard]] std::vector<Sample> thinned(std::span<const Sample> samples, int points) const {
    std::vector<Sample> few(samples.begin(), samples.end());
    for (const SurfaceBlock& block : blocks_) {
      few = with_fewer_points(few, block.pair.camera, points);
    }
    return few;
  }

  /// A few points of those that are near the robot: most of a cloud may be background.
  [[nodiscard]] std::vector<Sample> near(std::span<const Sample> samples,
                                         const Eigen::VectorXd& values, int points) const {
    const int looked = points > kFewestPoints ? 10 : 3;  // times as many points are looked at
    const std::vector<Sample> more = thinned(samples, looked * points);
    const std::vector<SurfaceHits> hits =
        rounds_.associated(*step_.problem(), more, values, kWidest);
    std::vector<Sample> all = rounds_.matched(more, hits, kWidest);
    for (const SurfaceBlock& block : blocks_) {
      for (Sample& sample : all) {
        std::erase_if(sample.observations,
                      [&](const Observation& one) { return one.sensor == block.pair.robot; });
      }
    }
    return thinned(all, points);
  }

  [[nodiscard]] RoundState coarse(std::span<const Sample> samples, const Eigen::VectorXd& values,
                                  const Shrinking& shrinking) const {
    constexpr double kHuber = 0.1;  // of the gate
    RoundState state{{.values = values}, {}};
    for (const double gate : shrinking.gates) {
      state = rounds_.run(
          {.gate = gate, .huber = kHuber * gate, .rounds = shrinking.rounds, .tolerance = 1e-3},
          samples, state.values, std::move(state.hits));
    }
    return state;
  }

  /// A cost by which ends of rounds are compared.
  [[nodiscard]] double ranked(std::span<const Sample> samples,
                              const Eigen::VectorXd& values) const {
    return rounds_
        .run({.gate = 0.1, .huber = 0.01, .rounds = 0, .only_front = true}, samples, values)
        .cost;
  }

  [[nodiscard]] double contrast(std::span<const Sample> samples, const RoundState& state) const {
    double least = std::numeric_limits<double>::infinity();
    for (const SurfaceHits& of_block :
         rounds_.associated(*step_.problem(), samples, state.values, 5.0 * kOnRobot)) {
      least = std::min(least, quality_of(of_block).contrast());
    }
    return least;
  }

  /// Values with poses that a search found.
  [[nodiscard]] std::vector<Eigen::VectorXd> searched(std::span<const Sample> samples,
                                                      const Eigen::VectorXd& start,
                                                      std::span<const UnknownFrame> unknown) const {
    const std::unique_ptr<AnyProblem> problem = step_.problem();
    std::vector<Eigen::VectorXd> all;
    for (const SurfaceBlock& block : blocks_) {
      for (const UnknownFrame& frame : unknown) {
        const SearchedFrame searched(frame, *problem, block.pair.camera);
        if (!searched.is_usable()) continue;
        std::vector<PosedCloud> clouds;
        for (const Sample& sample : samples) {
          clouds.push_back(posed_cloud(searched, *problem, block, sample, start));
        }
        for (const Pose<double>& pose : find_poses(block.surface, clouds)) {
          all.push_back(searched.with(pose, start));
        }
      }
    }
    return all;
  }

  /// Sets the gate: that of the losses; else it narrows with the distances.
  /// @param rounds  with each gate, at most
  /// @param state   in: values
  void set_gate(std::span<const Sample> samples, int rounds, RoundState& state) {
    const std::optional<double> of_losses = step_.gate_of_losses(blocks_);
    gate_ = of_losses.value_or(0.1);
    if (of_losses) return;
    narrow(
        gate_, kNarrowest, rounds, state,
        [&](double gate, const Eigen::VectorXd& from, int most) {
          return rounds_.run({.gate = gate, .rounds = most}, samples, from);
        },
        [](const RoundState& at) {
          std::vector<double> distances;
          for (const SurfaceHits& of_block : at.hits) {
            const std::vector<double> more = quality_of(of_block).distances;
            distances.insert(distances.end(), more.begin(), more.end());
          }
          return distances;
        });
  }

  [[nodiscard]] RoundState fine(std::span<const Sample> samples, const Eigen::VectorXd& values) {
    constexpr int kMost = 40;
    RoundState state{{.values = values}, {}};
    set_gate(samples, kGateRounds, state);
    return rounds_.run({.gate = gate_, .rounds = kMost}, samples, state.values);
  }

  const MatchedStep& step_;
  std::span<const SurfaceBlock> blocks_;
  SurfaceRounds rounds_;
  double gate_ = kWidest;
  std::optional<std::string> alike_;
};

/// Of the surface that the camera should see, the share with a measured point near it, in the mean of the links; 1 if it
/// should see hardly any.  The clouds say how far the camera sees to the sides.
[[nodiscard]] double coverage(const SurfaceBlock& block, const AnyProblem& problem,
                              std::span<const Sample> samples, const Eigen::VectorXd& values) {
  constexpr double kNear = 0.04, kFacing = 0.3, kHidden = 0.02;  // metres; cosine; metres
  constexpr int kFaces = 60, kFewest = 20;                       // of a link and sample; of a link
  const ParameterValues at = values;
  const FeaturePlaces places(problem, at);
  const auto camera = std::find_if(
      problem.sensors().begin(), problem.sensors().end(),
      [&](const MountedSensor& sensor) { return sensor.mount().name == block.pair.camera; });
  const SampledChain& chain = camera->chains().front();
  const auto cell = [&](const Vector3<double>& p, const Eigen::Vector3i& shift) {
    const Eigen::Vector3i c = (p / kNear).array().floor().cast<int>().matrix() + shift;
    return std::array<int, 3>{c.x(), c.y(), c.z()};
  };
  std::vector<int> visible(block.surface.links().size(), 0), covered = visible;
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(block.pair.camera);
    if (seen == nullptr || seen->features.empty()) continue;
    const Pose<double> camera_T_base =
        chain.tip(sample, corrections_for(chain.parameters(), at)).inverse();
    std::set<std::array<int, 3>> cells;
    Eigen::Array2d low = Eigen::Array2d::Constant(1e9), high = -low;
    const auto sight = [&](const Vector3<double>& p_base) {
      const Vector3<double> p = camera_T_base * p_base;
      return Eigen::Array2d(p.x() / p.z(), p.y() / p.z());
    };
    Vector3<double> eye = Vector3<double>::Zero();
    for (const PlacedFeature& point :
         places.placed(static_cast<int>(camera - problem.sensors().begin()), *seen, sample)) {
      if (!point.seen) continue;
      eye = point.origin;
      cells.insert(cell(point.point, Eigen::Vector3i::Zero()));
      low = low.min(sight(point.point));
      high = high.max(sight(point.point));
    }
    const std::vector<Pose<double>> links =
        link_poses(block.surface, block.pair, problem, at, sample);
    for (std::size_t l = 0; l < links.size(); ++l) {
      const TriangleTree& tree = block.surface.links()[l].tree;
      for (int f = 0; f < kFaces; ++f) {
        const auto& [a, b, c] =
            tree.corners(static_cast<int>(static_cast<std::ptrdiff_t>(f) * tree.count() / kFaces));
        const Vector3<double> p = links[l] * Vector3<double>((a + b + c) / 3.0);
        const Vector3<double> normal =
            links[l].rotation * Vector3<double>((b - a).cross(c - a).normalized());
        const Vector3<double> ray = p - eye;
        const bool is_front =
            (camera_T_base * p).z() > 0.0 && -normal.dot(ray) > kFacing * ray.norm();
        if (!is_front || (sight(p) < low).any() || (sight(p) > high).any()) continue;
        if (block.surface.cast(links, eye, ray).distance < 1.0 - kHidden / ray.norm()) continue;
        ++visible[l];
        bool is_near = false;
        for (int n = 0; n < 27 && !is_near; ++n) {
          is_near = cells.contains(cell(p, {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1}));
        }
        covered[l] += is_near ? 1 : 0;
      }
    }
  }
  double sum = 0.0;
  int links = 0;
  for (std::size_t l = 0; l < visible.size(); ++l) {
    if (visible[l] < kFewest) continue;
    sum += static_cast<double>(covered[l]) / visible[l];
    ++links;
  }
  return links == 0 ? 1.0 : sum / links;
}

/// Refuses a pose from which the camera should see much of the robot where it measured nothing.
void check_coverage(const SurfaceBlock& block, const BlockConfig& of, const AnyProblem& problem,
                    std::span<const Sample> samples, const Eigen::VectorXd& values,
                    Diagnostics& diagnostics) {
  constexpr double kRefused = 0.75;
  const double covered = coverage(block, problem, samples, values);
  if (covered >= kRefused) return;
  diagnostics.error(
      of.place,
      fmt::format(
          "error block '{}': from where the fit puts the camera of sensor '{}' it should see "
          "the robot, but measured points near {:.0f} % of that surface only.  Are the joints "
          "those of the clouds, and is the robot in view?",
          of.name, block.pair.camera, 100.0 * covered));
}

/// "; least well on 'link_7': 56 % of the points near it lie on it": something that no mesh has, or a joint that is off.
[[nodiscard]] std::string links_off(const RobotSurface& surface, const SurfaceHits& hits) {
  constexpr double kPoor = 0.6;
  constexpr int kFewest = 100;  // points
  std::vector<std::pair<int, int>> counts(surface.links().size());
  for (const auto& of_sample : hits) {
    for (const SurfaceHit& hit : of_sample) {
      if (hit.link < 0 || hit.distance > 2.5 * kOnRobot) continue;
      auto& [on, near] = counts[static_cast<std::size_t>(hit.link)];
      ++near;
      if (hit.distance <= 0.5 * kOnRobot) ++on;
    }
  }
  std::string text;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const auto [on, near] = counts[i];
    if (near < kFewest || on >= kPoor * near) continue;
    text += fmt::format("{} '{}' ({:.0f} %)",
                        text.empty() ? "; few of the points near them lie on" : ",",
                        surface.links()[i].name, 100.0 * on / near);
  }
  return text;
}

/// Says how the points of a camera lie on the robot; an error if they do not, or a doubt if nothing was fitted.
void report_fit(const SurfaceBlock& block, const BlockConfig& of, double gate,
                const SurfaceHits& hits, std::size_t samples, bool is_fitted,
                Diagnostics& diagnostics) {
  const SurfaceQuality quality = quality_of(hits);
  if (quality.distances.empty()) return;  // assemble() says so
  const double on = quality.share(kOnRobot);
  const std::string cloud =
      fmt::format("{} of sensor '{}' in {}", counted(quality.distances.size(), "point"),
                  block.pair.camera, counted(samples, "sample"));
  constexpr double kFewest = 0.01;
  if (on < kFewest || quality.contrast() < 1.0) {
    const std::string why = fmt::format(
        "error block '{}': the points do not lie on the robot.  Of {}, {:.1f} % are "
        "within {:.0f} mm of its surface {}, and of those within {:.0f} "
        "mm {:.0f} % within {:.0f} mm: hardly more than by chance.  Are these clouds of this "
        "robot, in metres, in the frame of the camera, with the joints of the same time?{}",
        of.name, cloud, 100.0 * on, 1e3 * kOnRobot,
        is_fitted ? "after the best fit" : "where the result puts it", 2.5e3 * kOnRobot,
        100.0 * quality.share(kOnRobot / 2.0) / std::max(1e-12, quality.share(2.5 * kOnRobot)),
        0.5e3 * kOnRobot,
        is_fitted ? "  If the camera's pose is far off, leave its initial values out: then it is "
                    "searched for"
                  : "");
    // Points of links that are not listed may be near the listed ones.
    if (block.is_whole && is_fitted) {
      diagnostics.error(of.place, why);
    } else {
      diagnostics.doubt(of.place, why);
    }
    return;
  }
  const LossType type = loss_type(of.loss.type);
  double cost = 0.0;
  const double weight =
      (of.numbers.contains("scale") ? of.numbers.at("scale") : 1.0) / of.sigma.value_or(1.0);
  for (const double d : quality.distances) {
    cost += 0.5 * Loss{type, of.loss.scale}(std::pow(weight * d, 2)).rho;
  }
  std::string text = fmt::format(
      "error block '{}': {}: {:.1f} % lie within {:.0f} mm of the robot, {:.1f} % within {:.4g} "
      "mm, "
      "and those count; the median distance of all is {:.3f} mm",
      of.name, cloud, 100.0 * on, 1e3 * kOnRobot, 100.0 * quality.share(gate), 1e3 * gate,
      1e3 * median_of(quality.distances));
  if (type != LossType::none) text += fmt::format(", their cost {:.6f}", cost);
  diagnostics.note(of.place, text + links_off(block.surface, hits));
}

/// Doubts zeros and geometry of joints that clouds which had no say do not confirm.
void check_joints(const SurfaceFit& fit, const SurfaceInput& input, const StepConfig& step,
                  const ParameterTable& table, std::span<const Sample> samples,
                  const Eigen::VectorXd& start, const Eigen::VectorXd& end,
                  Diagnostics& diagnostics) {
  std::set<int> joints;
  std::vector<std::string> names;
  for (const FreeParamConfig& parameter : free_parameters(step)) {
    const int index = table.find(parameter.name);
    const bool is_zero = input.robot.has_joint(parameter.name);
    const bool is_of_joint =
        is_zero || std::any_of(step.free_frames.begin(), step.free_frames.end(),
                               [&](const FreeFrameConfig& frame) {
                                 return parameter.name.starts_with(frame.name + "_") &&
                                        input.robot.has_joint(frame.name) &&
                                        moves(input.robot.joint(frame.name).type);
                               });
    if (index < 0 || !is_of_joint || !joints.insert(index).second) continue;
    names.push_back(parameter.name);
  }
  const auto medians = fit.bring_nothing(samples, joints, start, end);
  if (!medians) return;
  diagnostics.doubt(
      step.place,
      fmt::format(
          "freeing {} does not bring held-out clouds nearer to the robot by more than chance: "
          "{:.2f} mm, and {:.2f} mm where {} held (median, halves of the samples); errors of "
          "the depth may be in {}.  Use --hold {}",
          fmt::join(names, ", "), 1e3 * medians->first, 1e3 * medians->second,
          names.size() == 1 ? "it is" : "they are", names.size() == 1 ? "it" : "them",
          fmt::join(names, ",")));
}

/// Doubts a camera that stands inside of a link.
void check_camera(const SurfaceBlock& block, const BlockConfig& of, const AnyProblem& problem,
                  std::span<const Sample> samples, const Eigen::VectorXd& values,
                  Diagnostics& diagnostics) {
  for (const Sample& sample : samples) {
    const std::vector<MountedSensor>& sensors = problem.sensors();
    const auto camera = std::find_if(
        sensors.begin(), sensors.end(),
        [&](const MountedSensor& sensor) { return sensor.mount().name == block.pair.camera; });
    const SampledChain& chain = camera->chains().front();
    const ParameterValues at = values;
    const Vector3<double> eye =
        chain.tip(sample, corrections_for(chain.parameters(), at)).translation;
    const SurfaceHit hit =
        block.surface.closest(link_poses(block.surface, block.pair, problem, at, sample), eye);
    if (hit.link < 0 || hit.distance < 0.005) continue;  // on the shell: it looks out of it
    const SurfaceLink& link = block.surface.links()[static_cast<std::size_t>(hit.link)];
    const SurfaceFacts& facts = link.tree.facts();
    const bool is_outward = facts.volume > 0.0;
    // Inside, the vector from the surface points against the outward normal.
    const Pose<double> base_T_link = link_poses(block.surface, block.pair, problem, at,
                                                sample)[static_cast<std::size_t>(hit.link)];
    const Vector3<double> off = eye - base_T_link * hit.point;
    if (!facts.closed || (off.dot(hit.face) > 0.0) == is_outward) continue;
    diagnostics.doubt(
        of.place,
        fmt::format("error block '{}': after the fit the camera of sensor '{}' stands "
                    "{:.0f} mm inside of link '{}' in {}; leave that link out of "
                    "'links' if it is the camera's housing, else the pose is wrong",
                    of.name, block.pair.camera, 1e3 * hit.distance, link.name, sample.source));
    return;
  }
}

/// Refuses clouds that cannot be in metres.
void check_units(const SurfaceBlock& block, std::span<const Sample> samples,
                 Diagnostics& diagnostics) {
  constexpr double kFarthest = 50.0;  // metres, of half of the points of a cloud
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(block.pair.camera);
    std::vector<double> distances;
    if (seen != nullptr) {
      for (const Feature& feature : seen->features) {
        if (feature.point.allFinite()) distances.push_back(feature.point.norm());
      }
    }
    if (distances.empty()) continue;
    const double median = median_of(std::move(distances));
    if (median < kFarthest) continue;
    diagnostics.errors.push_back(
        fmt::format("{}: half of the points of sensor '{}' are more than {:.0f} m away: they are "
                    "not in metres (millimetres?); divide them by 1000",
                    sample.source, block.pair.camera, median));
    return;
  }
}

/// A few points on the first link, to assemble what depends on samples.
[[nodiscard]] std::vector<Sample> assumed_samples(std::span<const SurfaceBlock> blocks,
                                                  std::span<const Sample> samples,
                                                  const StepConfig& step) {
  constexpr int kPoints = 8;
  std::vector<Sample> all(samples.begin(), samples.end());
  for (const SurfaceBlock& block : blocks) {
    all = with_fewer_points(all, block.pair.camera, kPoints);
    const auto model = std::ranges::find(step.models, block.pair.robot, &ModelConfig::name);
    for (Sample& sample : all) {
      const Observation* seen = sample.observation(block.pair.camera);
      if (seen == nullptr) continue;
      Observation robot{.sensor = block.pair.robot, .features = {}};
      for (const Feature& feature : seen->features) {
        robot.features.push_back(
            {.frame = model->frame,
             .id = feature.id,
             .conditions = {{"nx", 0.0}, {"ny", 0.0}, {"nz", 1.0}, {"nu", 1.0}, {"nv", 0.0}}});
      }
      sample.observations.push_back(std::move(robot));
    }
  }
  return all;
}

/// Says how the points of blocks lie on the robot.
/// @param is_fitted  where rounds have ended: clouds and cameras that cannot be there are errors
void judge_clouds(std::span<const SurfaceBlock> blocks, const StepConfig& of_step,
                  const AnyProblem& problem, std::span<const Sample> samples,
                  const Eigen::VectorXd& values, double gate, const std::vector<SurfaceHits>& hits,
                  bool is_fitted, Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.errors.size();
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const BlockConfig& of = block_of(of_step, blocks[b].name);
    report_fit(blocks[b], of, gate, hits[b], samples.size(), is_fitted, diagnostics);
    if (!is_fitted) continue;
    check_camera(blocks[b], of, problem, samples, values, diagnostics);
    if (blocks[b].is_view && diagnostics.errors.size() == before) {
      check_coverage(blocks[b], of, problem, samples, values, diagnostics);
    }
  }
}

/// Associates the clouds of a step.
/// @param is_held  values stay; else rounds find them
/// @param values   in: where rounds begin; out: where they ended
void match_clouds(const SurfaceInput& input, Config& config, std::size_t number,
                  std::span<const SurfaceBlock> blocks, const Calibration& assumed, bool is_held,
                  std::vector<Sample>& samples, Eigen::VectorXd& values, Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.errors.size();
  const std::vector<Sample> heard = heard_samples(samples, input.exclude);
  StepConfig& of_step = config.steps[number];
  const MatchedStep step(input, config, number);
  SurfaceFit fit(step, blocks);
  const Eigen::VectorXd start = values;
  if (is_held) {
    fit.hold(heard, values, block_of(of_step, blocks.front().name).surface->gate);
  } else {
    values = fit.run(heard, start, assumed.steps[number].unknown_frames, diagnostics).values;
  }
  const SurfaceRounds rounds(step, blocks);
  const std::unique_ptr<AnyProblem> problem = step.problem();
  const std::vector<SurfaceHits> hits =
      rounds.associated(*problem, samples, values, std::numeric_limits<double>::infinity());
  judge_clouds(blocks, of_step, *problem, samples, values, fit.gate(), hits, !is_held, diagnostics);
  if (!is_held && diagnostics.errors.size() == before) {
    if (fit.alike()) diagnostics.doubt(of_step.place, *fit.alike());
    check_joints(fit, input, of_step, assumed.table, heard, start, values, diagnostics);
  }
  samples = rounds.matched(samples, hits, fit.gate());
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    constexpr double kLeast = 1e-6;  // metres
    BlockConfig& of = block_of(of_step, blocks[b].name);
    of.surface->gate = fit.gate();
    keep_loss(of, quality_of(hits[b]).distances, fit.gate(), kLeast);
  }
}

/// Associates the samples of all steps.
/// @param held  values by name that stay; nullptr: rounds find them
/// @returns  where the rounds ended, of all parameters of the assembled table; empty after an error
[[nodiscard]] Eigen::VectorXd match_steps(const SurfaceInput& input,
                                          std::vector<std::vector<SurfaceBlock>> steps,
                                          const std::map<std::string, double>* held, Config& config,
                                          std::vector<Sample>& samples, Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.errors.size();
  Eigen::VectorXd values;
  std::vector<Sample> matched = samples;
  for (std::size_t s = 0; s < steps.size(); ++s) {
    if (steps[s].empty()) continue;
    const auto first_mask =
        std::stable_partition(steps[s].begin(), steps[s].end(),
                              [](const SurfaceBlock& block) { return !block.is_outline; });
    const std::span<const SurfaceBlock> clouds(steps[s].begin(), first_mask),
        masks(first_mask, steps[s].end());
    for (const SurfaceBlock& block : clouds) {
      check_units(block, samples, diagnostics);
      const int most = block_of(config.steps[s], block.name).surface->points;
      matched = with_fewer_points(matched, block.pair.camera, most);
    }
    if (diagnostics.errors.size() > before) return {};
    Diagnostics quiet;
    const Calibration assumed = kinecal::assemble(
        config, input.robot, assumed_samples(steps[s], matched, config.steps[s]), quiet);
    if (!quiet.errors.empty()) {
      diagnostics.errors.insert(diagnostics.errors.end(), quiet.errors.begin(), quiet.errors.end());
      return {};
    }
    if (values.size() == 0) values = assumed.table.values();
    for (const auto& [index, value] : assumed.steps[s].assignments) values[index] = value;
    for (int p = 0; held != nullptr && p < assumed.table.size(); ++p) {
      const auto value = held->find(assumed.table[p].name);
      if (value != held->end()) values[p] = value->second;
    }
    const bool is_held = held != nullptr;
    std::span<const UnknownFrame> unknown = assumed.steps[s].unknown_frames;
    if (!clouds.empty()) {
      match_clouds(input, config, s, clouds, assumed, is_held, matched, values, diagnostics);
      unknown = {};
    }
    if (!masks.empty() && diagnostics.errors.size() == before) {
      match_outlines(input, config, s, masks, is_held, matched, values, unknown, diagnostics);
    }
  }
  if (diagnostics.errors.size() > before) return {};
  samples = std::move(matched);
  return values;
}

}  // namespace
}  // namespace detail

bool compares_surface(const Config& config) {
  return std::any_of(config.steps.begin(), config.steps.end(), [](const StepConfig& step) {
    return std::any_of(step.error_blocks.begin(), step.error_blocks.end(),
                       [](const BlockConfig& block) { return block.surface.has_value(); });
  });
}

std::vector<double> match_surface(const SurfaceInput& input, Config& config,
                                  std::vector<Sample>& samples, Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.errors.size();
  if (input.urdf_text.empty()) {
    diagnostics.errors.push_back(
        "the robot is compared with its own surface, but without its URDF there are no meshes; "
        "give the text of the URDF and its file");
    return {};
  }
  std::vector<std::vector<SurfaceBlock>> steps = read_surface_blocks(input, config, diagnostics);
  if (diagnostics.errors.size() > before || samples.empty()) return {};
  const Eigen::VectorXd values =
      detail::match_steps(input, std::move(steps), nullptr, config, samples, diagnostics);
  return {values.data(), values.data() + values.size()};
}

void match_surface_at(const SurfaceInput& input, std::vector<std::vector<SurfaceBlock>> blocks,
                      const std::map<std::string, double>& values, Config& config,
                      std::vector<Sample>& samples, Diagnostics& diagnostics) {
  if (samples.empty()) return;
  (void)detail::match_steps(input, std::move(blocks), &values, config, samples, diagnostics);
}

}  // namespace kinecal
