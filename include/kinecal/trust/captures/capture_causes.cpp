// Definitions of capture_causes.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/captures/capture_causes.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/text/reading.hpp"
#include "kinecal/trust/judge.hpp"

namespace kinecal {

namespace detail {
namespace {

// Variants of one sample, evaluated at the values of a fit.

/// A compared feature of a sample.
struct TrialFeature {
  int number = 0;     ///< from 0, in its observation; -1 if the error block does not pair features
  int size = 1;       ///< residuals
  double chi2 = 0.0;  ///< squared distance in standard deviations
};

/// A sample's residuals.
struct TrialRows {
  Eigen::VectorXd rows;                ///< in standard deviations of the noise
  std::vector<TrialFeature> features;  ///< of all error blocks
  bool defined = true;                 ///< all of them could be evaluated

  /// Beyond this a feature is bad: the limit of captures.hpp for the features of one sample.
  [[nodiscard]] double limit(const TrialFeature& feature) const {
    constexpr double kFalse = 1e-3;
    const double k = feature.size, t = std::log(static_cast<double>(features.size()) / kFalse);
    return k + 2.0 * std::sqrt(k * t) + 2.0 * t;
  }
  [[nodiscard]] int bad() const {
    return static_cast<int>(
        std::count_if(features.begin(), features.end(),
                      [&](const TrialFeature& feature) { return feature.chi2 > limit(feature); }));
  }
  /// True if all features are within the noise and the uncertainty of the values.
  [[nodiscard]] bool fits() const {
    constexpr double kSlack = 1.5 * 1.5, kSlackOfAll = 1.5;
    const double n = static_cast<double>(rows.size());
    return defined && rows.squaredNorm() <= kSlackOfAll * (n + 4.0 * std::sqrt(2.0 * n)) &&
           std::all_of(features.begin(), features.end(), [&](const TrialFeature& feature) {
             return feature.chi2 <= kSlack * limit(feature);
           });
  }
  [[nodiscard]] const TrialFeature& worst() const {
    return *std::max_element(
        features.begin(), features.end(),
        [](const TrialFeature& a, const TrialFeature& b) { return a.chi2 < b.chi2; });
  }
};

/// Evaluates variants of a sample.
class CaptureTrials {
 public:
  CaptureTrials(const AnyProblem& problem, ParameterValues values,
                const std::vector<BlockNoise>& noise)
      : problem_(problem), values_(values), noise_(noise) {}

  /// @returns  rows of each variant, in their order
  [[nodiscard]] std::vector<TrialRows> operator()(const std::vector<Sample>& variants) const {
    std::vector<TrialRows> all(variants.size());
    std::vector<std::size_t> numbers;  // of the samples that the problem takes
    const std::unique_ptr<AnyProblem> problem = problem_.without_samples();
    for (std::size_t i = 0; i < variants.size(); ++i) {
      try {
        problem->add_sample(variants[i]);
        numbers.push_back(i);
      } catch (const SampleError&) {
        all[i].defined = false;
      }
    }
    std::vector<std::vector<double>> rows(variants.size());
    (void)evaluate(
        *problem, values_, nullptr, [&](int term, int sample, const TermResiduals& residuals) {
          const std::size_t of = numbers[static_cast<std::size_t>(sample)];
          const auto label = [&](Eigen::Index i) { return problem->feature(term, sample, i); };
          add(problem->term(term), noise_[static_cast<std::size_t>(term)], residuals, label,
              all[of], rows[of]);
        });
    for (std::size_t i = 0; i < variants.size(); ++i) {
      all[i].rows = Eigen::Map<const Eigen::VectorXd>(rows[i].data(), std::ssize(rows[i]));
      const bool complete = !rows[i].empty() && rows[i].size() >= rows[0].size();
      all[i].defined = all[i].defined && complete && all[i].rows.allFinite();
    }
    return all;
  }

 private:
  template <class LabelOf>
  static void add(const Term& term, const BlockNoise& noise, const TermResiduals& residuals,
                  const LabelOf& label, TrialRows& to, std::vector<double>& rows) {
    constexpr double kRounding = 1e-9;  // of exact data, as in captures.cpp
    const double sigma = std::max(noise.robust > 0.0 ? noise.robust : noise.sigma,
                                  kRounding * std::max(noise.unit_sigma, 1e-3));
    const int size = term.feature_size;
    for (Eigen::Index row = 0; row + size <= residuals.residual.size(); row += size) {
      TrialFeature feature{term.pairs_features() ? label(row / size).place : -1, size, 0.0};
      for (Eigen::Index k = row; k < row + size; ++k) {
        rows.push_back(residuals.residual(k) * residuals.factor(k) / sigma);
        feature.chi2 += rows.back() * rows.back();
      }
      to.features.push_back(feature);
    }
  }

  const AnyProblem& problem_;
  std::span<const double> values_;
  const std::vector<BlockNoise>& noise_;
};

// Bad captures explained by other joint positions: one joint's reading, or motion of the robot.

/// Step of numeric derivatives, radians or metres.
constexpr double kJointStep = 1e-6;

/// Joint positions that explain a sample.
struct JointCause {
  std::string text;   ///< empty: no explanation
  double chi2 = 0.0;  ///< that remains
};

/// A sample with other positions of its joints.
/// @param change  (joints) added, in the order of the sample
[[nodiscard]] Sample with_positions(const Sample& sample, const Eigen::VectorXd& change) {
  Sample changed = sample;
  for (std::size_t j = 0; j < changed.joint_positions.size(); ++j) {
    changed.joint_positions[j] += change(static_cast<Eigen::Index>(j));
  }
  return changed;
}

/// Joints of a sample that affect its observations, by index.
[[nodiscard]] std::vector<Eigen::Index> moving_joints(const CaptureTrials& trials,
                                                      const Sample& sample, const TrialRows& now) {
  const Eigen::Index count = std::ssize(sample.joint_positions);
  std::vector<Sample> variants;
  for (Eigen::Index j = 0; j < count; ++j) {
    variants.push_back(with_positions(sample, kJointStep * Eigen::VectorXd::Unit(count, j)));
  }
  std::vector<Eigen::Index> moving;
  if (variants.empty()) return moving;
  const std::vector<TrialRows> found = trials(variants);
  for (Eigen::Index j = 0; j < count; ++j) {
    const TrialRows& rows = found[static_cast<std::size_t>(j)];
    const bool same_size = rows.defined && rows.rows.size() == now.rows.size();
    if (same_size && (rows.rows - now.rows).norm() > 0.1 * kJointStep) moving.push_back(j);
  }
  return moving;
}

/// Unit of a joint's position.
[[nodiscard]] std::string_view unit_of(const Robot& robot, const std::string& joint) {
  const bool slides = robot.has_joint(joint) && robot.joint(joint).type == JointType::prismatic;
  return slides ? "m" : "rad";
}

/// "'elbow' reads 4.9 deg less": the joint, and the error of its reading.
[[nodiscard]] std::string reading_text(const Robot& robot, const std::string& joint, double lacks) {
  return "'" + joint + "' reads " + reading(std::abs(lacks), unit_of(robot, joint)) +
         (lacks > 0.0 ? " less" : " more");
}

/// Changes of single joints, each alone, that bring a sample nearest to the fit.
/// @returns  (joints) zero for one that is not among `moving`
[[nodiscard]] Eigen::VectorXd single_changes(const CaptureTrials& trials, const Sample& sample,
                                             const std::vector<Eigen::Index>& moving) {
  const Eigen::Index count = std::ssize(sample.joint_positions);
  Eigen::VectorXd change = Eigen::VectorXd::Zero(count);
  constexpr int kIterations = 8;
  constexpr double kMost = 0.5;  // of a step
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    std::vector<Sample> variants;
    for (const Eigen::Index j : moving) {
      const Eigen::VectorXd unit = Eigen::VectorXd::Unit(count, j);
      variants.push_back(with_positions(sample, change(j) * unit));
      variants.push_back(with_positions(sample, (change(j) + kJointStep) * unit));
    }
    const std::vector<TrialRows> found = trials(variants);
    for (std::size_t i = 0; i < moving.size(); ++i) {
      const TrialRows &here = found[2 * i], &there = found[2 * i + 1];
      if (!here.defined || !there.defined || here.rows.size() != there.rows.size()) continue;
      const Eigen::VectorXd slope = (there.rows - here.rows) / kJointStep;
      const double curvature = slope.squaredNorm();
      if (!(curvature > 0.0)) continue;
      change(moving[i]) += std::clamp(-slope.dot(here.rows) / curvature, -kMost, kMost);
    }
  }
  return change;
}

/// The joint whose reading explains a sample; up to three, if several do.
[[nodiscard]] JointCause wrong_reading(const CaptureTrials& trials, const Robot& robot,
                                       const Sample& sample, const TrialRows& now) {
  constexpr int kOriented = 6;
  const bool oriented = now.features.front().size >= kOriented;
  if (!oriented && (now.features.size() < 3 || now.rows.size() < 6 || now.bad() < 2)) return {};
  const std::vector<Eigen::Index> moving = moving_joints(trials, sample, now);
  if (moving.empty()) return {};
  const Eigen::VectorXd change = single_changes(trials, sample, moving);
  std::vector<Sample> variants;
  for (const Eigen::Index j : moving) {
    variants.push_back(with_positions(sample, change(j) * Eigen::VectorXd::Unit(change.size(), j)));
  }
  const std::vector<TrialRows> found = trials(variants);
  std::vector<std::pair<double, std::string>> explain;
  for (std::size_t i = 0; i < moving.size(); ++i) {
    if (!found[i].fits() || found[i].rows.size() != now.rows.size()) continue;
    const auto j = static_cast<std::size_t>(moving[i]);
    explain.emplace_back(found[i].rows.squaredNorm(),
                         reading_text(robot, sample.joint_names[j], change(moving[i])));
  }
  constexpr std::size_t kMost = 3;
  if (explain.empty() || explain.size() > kMost) return {};
  std::sort(explain.begin(), explain.end());
  std::string text;
  for (const auto& [chi2, joint] : explain) text += (text.empty() ? "" : ", or ") + joint;
  return {text + " than the others say", explain.front().first};
}

/// A small change of all joints that best fits a sample's features; nullopt if it could fit
/// anything.
[[nodiscard]] std::optional<Eigen::VectorXd> small_change(const CaptureTrials& trials,
                                                          const Sample& sample,
                                                          const TrialRows& now,
                                                          const std::vector<Eigen::Index>& moving) {
  constexpr double kTypical = 0.2, kTested = 5.0;
  constexpr int kIterations = 6;
  const Eigen::Index n = std::ssize(moving), count = std::ssize(sample.joint_positions);
  Eigen::VectorXd change = Eigen::VectorXd::Zero(count);
  const Eigen::MatrixXd prior = Eigen::MatrixXd::Identity(n, n) / (kTypical * kTypical);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    std::vector<Sample> variants = {with_positions(sample, change)};
    for (const Eigen::Index j : moving) {
      variants.push_back(
          with_positions(sample, change + kJointStep * Eigen::VectorXd::Unit(count, j)));
    }
    const std::vector<TrialRows> found = trials(variants);
    if (!found[0].defined || found[0].rows.size() != now.rows.size()) return std::nullopt;
    Eigen::MatrixXd slopes(now.rows.size(), n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const TrialRows& there = found[static_cast<std::size_t>(i) + 1];
      if (!there.defined || there.rows.size() != now.rows.size()) return std::nullopt;
      slopes.col(i) = (there.rows - found[0].rows) / kJointStep;
    }
    const Eigen::MatrixXd squares = slopes.transpose() * slopes;
    const Ldlt ldlt(squares + prior);
    if (iteration + 1 ==
        kIterations) {  // at first, the residual rotates with the joints, which fits more
      const double fitted = ldlt.solve(squares).trace();
      if (static_cast<double>(now.rows.size()) - fitted < kTested) return std::nullopt;
    }
    const Eigen::VectorXd so_far = change(moving);
    const Eigen::VectorXd slope = slopes.transpose() * found[0].rows + prior * so_far;
    change(moving) -= ldlt.solve(slope);
  }
  return change;
}

/// Tests whether a small change of all joints explains a sample: it was moving, or its target
/// slipped.
[[nodiscard]] JointCause motion(const CaptureTrials& trials, const Robot& robot,
                                const Sample& sample, const TrialRows& now) {
  constexpr double kLargest = 0.35;
  if (2 * now.bad() < static_cast<int>(now.features.size())) return {};
  const std::vector<Eigen::Index> moving = moving_joints(trials, sample, now);
  if (moving.size() < 2) return {};
  const std::optional<Eigen::VectorXd> change = small_change(trials, sample, now, moving);
  if (!change || !(change->lpNorm<Eigen::Infinity>() <= kLargest)) return {};
  const TrialRows after = trials({with_positions(sample, *change)}).front();
  if (!after.fits() || after.rows.size() != now.rows.size()) return {};
  Eigen::Index largest = 0;
  (void)change->cwiseAbs().maxCoeff(&largest);
  const std::string& joint = sample.joint_names[static_cast<std::size_t>(largest)];
  return {"all its features are off alike: the robot was still moving (joints by up to " +
              reading(std::abs((*change)(largest)), unit_of(robot, joint)) +
              "), or the target or a sensor had slipped",
          after.rows.squaredNorm()};
}

/// Names of what blocks without a sensor compare with the sample before.
[[nodiscard]] std::set<std::string> compared_before(const AnyProblem& problem) {
  std::set<std::string> names;
  for (int t = 0; t < problem.num_terms(); ++t) {
    const Term& term = problem.term(t);
    if (!term.quantities.empty()) continue;
    for (const std::string_view name : term.conditions) {
      if (name.starts_with(kBefore)) names.emplace(name.substr(kBefore.size()));
    }
  }
  names.erase("time");  // a clock does not slip
  return names;
}

/// Unit of a condition or of a joint's position; empty where it is not known: a wheel may count ticks.
[[nodiscard]] std::string unit_of_number(const Robot& robot, const std::string& name) {
  if (robot.has_joint(name)) return std::string(unit_of(robot, name));
  if (name.ends_with("_yaw") || name.ends_with("angle")) return "rad";
  const bool is_length = name.ends_with("_x") || name.ends_with("_y") || name.ends_with("distance");
  return is_length && !name.starts_with("mag_") ? "m" : "";
}

/// A sample in which one condition or joint position is another.
[[nodiscard]] Sample with_condition(const Sample& sample, const std::string& name, double change) {
  Sample changed = sample;
  const auto found = changed.conditions.find(name);
  if (found == changed.conditions.end()) {
    changed.add_to_position(name, change);
  } else {
    found->second += change;
  }
  return changed;
}

/// The change of one number by Gauss-Newton that brings a sample nearest to the fit.
[[nodiscard]] double nearest_change(const CaptureTrials& trials, const Sample& sample,
                                    const std::string& name) {
  constexpr int kIterations = 4;
  double change = 0.0;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const std::vector<TrialRows> found = trials(
        {with_condition(sample, name, change), with_condition(sample, name, change + kJointStep)});
    if (!found[0].defined || !found[1].defined) break;
    const Eigen::VectorXd slope = (found[1].rows - found[0].rows) / kJointStep;
    if (!(slope.squaredNorm() > 0.0)) break;
    change -= slope.dot(found[0].rows) / slope.squaredNorm();
  }
  return change;
}

/// Tests whether a wheel slipped, or something else moved on alone: one number of a block that looks at the sample before.
[[nodiscard]] std::string slip(const CaptureTrials& trials, const AnyProblem& problem,
                               const Sample& sample, const TrialRows& now) {
  struct Explanation {
    double chi2 = 0.0;
    std::string text;
  };
  std::vector<Explanation> explain;
  bool drives = false;
  for (const std::string& name : compared_before(problem)) {
    const bool is_wheel = name.find("wheel") != std::string::npos;
    drives = drives || is_wheel || name.starts_with("odom");
    const double change = nearest_change(trials, sample, name);
    const TrialRows after = trials({with_condition(sample, name, change)}).front();
    if (!after.fits() || after.rows.size() != now.rows.size()) continue;
    const std::string text = "'" + name + "' advanced by " +
                             reading(std::abs(change), unit_of_number(problem.robot(), name)) +
                             " too " + (change < 0.0 ? "much" : "little") +
                             (is_wheel ? ": it slipped" : "");
    explain.push_back({after.rows.squaredNorm(), text});
  }
  if (!explain.empty()) {
    return std::min_element(explain.begin(), explain.end(),
                            [](const auto& a, const auto& b) { return a.chi2 < b.chi2; })
        ->text;
  }
  return drives ? "wheels slipped, or what was tracked jumped" : "";
}

/// A sample with its features in another order, and a description of that order.
struct FeatureOrder {
  std::string cause;
  Sample sample;
};

/// Reorders the measurements: place i gets that of place order[i].  Ids stay.
[[nodiscard]] Sample with_order(const Sample& sample, std::size_t observation,
                                const std::vector<std::size_t>& order) {
  Sample changed = sample;
  std::vector<Feature>& features = changed.observations[observation].features;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::optional<int> id = features[i].id;
    features[i] = sample.observations[observation].features[order[i]];
    features[i].id = id;
  }
  return changed;
}

/// Feature number `worst` exchanged with another one, or measured at another one.
/// @param of  " of 'camera'", if needed
void add_exchanges(const Sample& sample, std::size_t observation, std::size_t worst, int bad,
                   const std::string& of, std::vector<FeatureOrder>& all) {
  const std::vector<Feature>& features = sample.observations[observation].features;
  const auto label = [&](std::size_t i) {
    return FeatureLabel{static_cast<int>(i), features[i].id};
  };
  const auto number = [&](std::size_t i) {
    return std::to_string(features[i].id.value_or(static_cast<int>(i) + 1));
  };
  const std::string both = features[worst].id ? "the features with ids " : "features ";
  std::vector<std::size_t> order(features.size());
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t other = 0; other < order.size(); ++other) {
    if (other == worst) continue;
    const auto [less, more] = std::minmax(worst, other);
    std::vector<std::size_t> changed = order;
    std::swap(changed[worst], changed[other]);
    all.push_back({both + number(less) + " and " + number(more) + of + " are exchanged",
                   with_order(sample, observation, changed)});
    if (bad > 1) continue;
    changed = order;
    changed[worst] = other;
    all.push_back({label(worst).text() + " shows " + label(other).text(),
                   with_order(sample, observation, changed)});
  }
}

/// A board read from another corner.  Not for a partial board, whose corner is unknown.
void add_turns(const Sample& sample, std::size_t observation, std::vector<FeatureOrder>& all) {
  const std::vector<Feature>& features = sample.observations[observation].features;
  const std::size_t size = features.size();
  for (std::size_t i = 0; i < size; ++i) {
    if (features[i].id && *features[i].id != static_cast<int>(i)) return;
  }
  const auto add = [&](const std::string& cause, auto&& place) {
    std::vector<std::size_t> order(size);
    for (std::size_t i = 0; i < size; ++i) order[i] = place(i);
    all.push_back({cause, with_order(sample, observation, order)});
  };
  add("the features are in reverse order: a board turned by 180 degrees?",
      [&](std::size_t i) { return size - 1 - i; });
  const auto side = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(size))));
  if (side * side != size) return;
  const std::string quarter = "the features are turned by a quarter: a board turned by 90 degrees?";
  add(quarter, [&](std::size_t i) { return (i % side) * side + side - 1 - i / side; });
  add(quarter, [&](std::size_t i) { return (side - 1 - i % side) * side + i / side; });
}

/// The order of features that explains a sample; empty if none does.
/// @param problem  with the sensors whose observations are used
[[nodiscard]] std::string wrong_order(const CaptureTrials& trials, const AnyProblem& problem,
                                      const Sample& sample, const TrialRows& now) {
  const int bad = now.bad(), worst = now.worst().number;
  if (worst < 0) return {};
  std::vector<std::size_t> used;
  for (std::size_t o = 0; o < sample.observations.size(); ++o) {
    const auto is_sensor = [&](const MountedSensor& sensor) {
      return sensor.mount().name == sample.observations[o].sensor;
    };
    const auto& sensors = problem.sensors();
    if (std::any_of(sensors.begin(), sensors.end(), is_sensor)) used.push_back(o);
  }
  std::vector<FeatureOrder> orders;
  for (const std::size_t o : used) {
    const Observation& seen = sample.observations[o];
    const std::size_t size = seen.features.size();
    if (size < 2 || static_cast<std::size_t>(worst) >= size) continue;
    const std::string of = used.size() > 2 ? " of '" + seen.sensor + "'" : "";
    if (bad <= 2) add_exchanges(sample, o, static_cast<std::size_t>(worst), bad, of, orders);
    if (bad > 2) add_turns(sample, o, orders);
  }
  std::vector<Sample> variants;
  for (const FeatureOrder& order : orders) variants.push_back(order.sample);
  if (variants.empty()) return {};
  const std::vector<TrialRows> found = trials(variants);
  std::size_t best = variants.size();
  for (std::size_t i = 0; i < found.size(); ++i) {
    const bool better =
        best == variants.size() || found[i].rows.squaredNorm() < found[best].rows.squaredNorm();
    if (found[i].rows.size() == now.rows.size() && found[i].fits() && better) best = i;
  }
  return best < variants.size() ? orders[best].cause : "";
}

}  // namespace
}  // namespace detail

std::string capture_cause(const AnyProblem& problem, ParameterValues values,
                          const std::vector<BlockNoise>& noise, const Sample& sample) {
  const detail::CaptureTrials trials(problem, values, noise);
  detail::TrialRows now = trials({sample}).front();
  if (!now.defined || now.fits()) return {};
  const std::optional<Sample> in_order = problem.paired(sample);
  if (in_order) now = trials({*in_order}).front();  // the same, numbered as in it
  std::string cause = detail::wrong_order(trials, problem, in_order.value_or(sample), now);
  if (!cause.empty()) return cause;
  constexpr double kBetter = 25.0;  // by five parameters more: once in 10000 by chance
  detail::JointCause one = detail::wrong_reading(trials, problem.robot(), sample, now);
  detail::JointCause all = detail::motion(trials, problem.robot(), sample, now);
  const bool is_one = all.text.empty() || one.chi2 < all.chi2 + kBetter;
  cause = !one.text.empty() && is_one ? one.text : all.text;
  return cause.empty() ? detail::slip(trials, problem, in_order.value_or(sample), now) : cause;
}

}  // namespace kinecal
