// Following a session.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/online.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/solve/determined_spectrum.hpp"
#include "kinecal/trust/f_distribution.hpp"
#include "kinecal/trust/measured_numbers.hpp"
#include "kinecal/trust/uncertainty/pose_in_base.ipp"
#include "kinecal/trust/uncertainty/pose_variance.ipp"

namespace kinecal {

// State and updates of a calibration that follows a session.

struct OnlineCalibration::Impl {
  MakeProblem make;
  FreeSet free;
  std::vector<double> values;
  FrameOnRobot frame, in;
  std::unique_ptr<AnyProblem> problem = make();  ///< with the samples
  std::vector<Sample> samples = {};              ///< of the problem
  std::vector<int> numbers = {};                 ///< of each of them: of the call of add(), from 1
  int added = 0;                                 ///< calls of add()
  std::vector<Sample> ahead = {};                ///< poses where the pose is wanted as well
  Eigen::MatrixXd hessian = {};                  ///< (free x free) at the values
  double noise2 = 0.0;                           ///< s^2
  int freedom = 0;                               ///< residuals left for the noise
  int measured = 0;                              ///< numbers: see measured_numbers()

  void step_to_minimum(AnyEvaluator& evaluator);
  void estimate_noise(AnyEvaluator& evaluator, double cost);
  [[nodiscard]] double innovation(AnyEvaluator& evaluator, int& rows) const;
  void set_pose(OnlineState& state) const { set_pose(state, hessian); }
  void set_pose(OnlineState& state, const Eigen::MatrixXd& information) const;
  [[nodiscard]] bool add_if_it_fits(const Sample& sample, OnlineState& state);
  [[nodiscard]] std::optional<std::size_t> misfit(AnyEvaluator& evaluator) const;
  void leave_out(std::size_t sample);
  [[nodiscard]] std::vector<std::pair<NextMove, Sample>> candidates(double step) const;
};

namespace detail {

/// Rows and derivatives of one sample, weighted.
struct SampleRows {
  Eigen::VectorXd residual = {};
  Eigen::MatrixXd jacobian = {};
  double used = 0.0;  ///< of the rows, by the sample's own poses

  void append(const TermResiduals& rows, double weight) {
    const Eigen::Index before = residual.size(), added = rows.residual.size();
    residual.conservativeResize(before + added);
    jacobian.conservativeResize(before + added, rows.jacobian.cols());
    residual.tail(added) = weight * rows.residual;
    jacobian.bottomRows(added) = weight * rows.jacobian;
    if (rows.used.size() > 0) used += rows.used.sum();
  }
};

/// The number of residuals that the poses of samples use up.
[[nodiscard]] inline double used_by_poses(AnyEvaluator& evaluator, ParameterValues values) {
  double used = 0.0;
  (void)evaluator.evaluate(values, false, [&](int, int, const TermResiduals& rows) {
    if (rows.used.size() > 0) used += rows.used.sum();
  });
  return used;
}

}  // namespace detail

/// Gauss-Newton steps, halved until the cost falls.
inline void OnlineCalibration::Impl::step_to_minimum(AnyEvaluator& evaluator) {
  constexpr int kSteps = 8, kHalves = 6;
  constexpr double kSettled = 1e-6;    // of the cost
  constexpr double kUncertain = 1e-4;  // of the largest singular value: no steps along these
  NormalEquations at = evaluator.normal_equations(values);
  for (int i = 0; i < kSteps && std::isfinite(at.cost); ++i) {
    const detail::Spectrum spectrum(at.hessian);
    const Eigen::VectorXd units = spectrum.scale.cwiseInverse();
    const Eigen::VectorXd slope = spectrum.vectors.transpose() * units.cwiseProduct(at.gradient);
    const double least = kUncertain * spectrum.singular.maxCoeff();
    const Eigen::VectorXd along = slope.binaryExpr(
        spectrum.singular, [&](double g, double s) { return s > least ? -g / (s * s) : 0.0; });
    const Eigen::VectorXd step = units.cwiseProduct(spectrum.vectors * along);
    const double before = at.cost;
    double factor = 1.0;
    for (int h = 0; h < kHalves; ++h, factor *= 0.5) {
      std::vector<double> trial = values;
      for (int c = 0; c < free.size(); ++c) {
        const Parameter& parameter =
            problem->table()[free.parameters()[static_cast<std::size_t>(c)]];
        double& value =
            trial[static_cast<std::size_t>(free.parameters()[static_cast<std::size_t>(c)])];
        value = std::clamp(value + factor * step(c), parameter.lower, parameter.upper);
      }
      NormalEquations there = evaluator.normal_equations(trial);
      if (!(there.cost <= before)) continue;
      values = std::move(trial);
      at = std::move(there);
      break;
    }
    if (before - at.cost <= kSettled * before) break;
  }
  hessian = at.hessian;
  estimate_noise(evaluator, at.cost);
  problem->set_poses_of_samples(evaluator.sample_poses(values));
}

inline void OnlineCalibration::Impl::estimate_noise(AnyEvaluator& evaluator, double cost) {
  const detail::Spectrum spectrum(hessian);
  const auto rank = static_cast<int>(spectrum.singular.size() - spectrum.null);
  const int of_priors = static_cast<int>(problem->priors().size()) * Prior::kRows;
  const double used =
      problem->sample_poses().empty() ? 0.0 : detail::used_by_poses(evaluator, values);
  freedom = problem->num_residuals() - of_priors - rank - static_cast<int>(std::lround(used));
  const double of_features = cost - detail::prior_equations(*problem, free, values).cost;
  noise2 = freedom > 0 ? std::max(0.0, 2.0 * of_features / freedom) : 0.0;
  measured = measured_numbers(*problem, values);
}

/// X of the last sample; zero if it has no residuals.
inline double OnlineCalibration::Impl::innovation(AnyEvaluator& evaluator, int& rows) const {
  detail::SampleRows last;
  const int number = problem->num_samples() - 1;
  (void)evaluator.evaluate(values, true, [&](int term, int sample, const TermResiduals& of_term) {
    if (sample == number) last.append(of_term, problem->term(term).weight);
  });
  rows = static_cast<int>(last.residual.size()) - static_cast<int>(std::lround(last.used));
  if (rows <= 0) return 0.0;
  const Eigen::MatrixXd covariance = noise2 * detail::Spectrum(hessian).pseudo_inverse();
  Eigen::MatrixXd expected = last.jacobian * covariance * last.jacobian.transpose();
  expected.diagonal().array() += noise2;
  return last.residual.dot(detail::Ldlt(expected).solve(last.residual)) / rows;
}

namespace detail {

/// A few samples, evenly over a session.
inline std::vector<const Sample*> some_of(const std::vector<Sample>& samples) {
  constexpr std::size_t kPoses = 16;
  std::vector<const Sample*> some;
  const std::size_t count = std::min(kPoses, samples.size());
  for (std::size_t i = 0; i < count; ++i) {
    some.push_back(&samples[(2 * i + 1) * samples.size() / (2 * count)]);
  }
  return some;
}

}  // namespace detail

/// The worse of captured poses and poses ahead.
inline void OnlineCalibration::Impl::set_pose(OnlineState& state,
                                              const Eigen::MatrixXd& information) const {
  const detail::Spectrum spectrum(information);
  const Eigen::MatrixXd covariance = noise2 * spectrum.pseudo_inverse();
  const Eigen::MatrixXd null =
      spectrum.scale.cwiseInverse().asDiagonal() * spectrum.vectors.leftCols(spectrum.null);
  detail::PoseDerivative derivative(*problem, free, values, frame, in);
  // With less redundancy, neither the noise nor the poses mean much.
  constexpr double kToSpare = 2.0;  // residuals per determined direction
  const auto rank = static_cast<double>(spectrum.singular.size() - spectrum.null);
  state.known = freedom >= kToSpare * rank && measured >= free.size();
  state.position = state.rotation = 0.0;
  for (const std::vector<Sample>* poses : {&samples, &ahead}) {
    detail::PoseVariance variance(0.0);
    for (const Sample* sample : detail::some_of(*poses)) {
      if (const auto jacobian = derivative.at(*sample)) variance.add(*jacobian, covariance, null);
    }
    const PoseUncertainty there = variance.result(frame, in);
    state.known = state.known && there.determined;
    state.position = std::max(state.position, there.position);
    state.rotation = std::max(state.rotation, there.rotation);
  }
}

namespace detail {

// Samples that do not fit the others: the new one, or earlier ones.

inline constexpr std::size_t kFewestToTest = 8;  ///< samples; with fewer, none is tested

/// True if a sample is too far off for chance.  Its features share the errors of its joints, so
/// their number means little: it must also be off by several times the noise.
/// @param ratio  mean square of its residuals over that of the noise
/// @param tests  how many samples are tested
inline bool is_misfit(double ratio, double rows, double freedom, double tests) {
  constexpr double kTimes = 3.0, kOnceIn = 1e-6;
  return ratio > kTimes * kTimes && f_tail(ratio, rows, freedom) < kOnceIn / tests;
}

/// The mean square of weighted residuals that the stated sigmas allow, however small the noise is; 0 if one was
/// not stated.
inline double stated_square(const AnyProblem& problem) {
  double most = 0.0;
  for (int t = 0; t < problem.num_terms(); ++t) {
    const TermOptions& options = problem.term(t).options;
    if (!options.sigma) return 0.0;
    most = std::max(most, options.scale * options.scale);
  }
  return most;
}

}  // namespace detail

/// The worst sample, if it does not fit the others.
inline std::optional<std::size_t> OnlineCalibration::Impl::misfit(AnyEvaluator& evaluator) const {
  if (samples.size() < detail::kFewestToTest || freedom <= 0) return std::nullopt;
  std::vector<double> squares(samples.size(), 0.0), rows(samples.size(), 0.0);
  double all = problem->num_residuals();
  (void)evaluator.evaluate(values, false, [&](int term, int sample, const TermResiduals& of_term) {
    const double weight = problem->term(term).weight;
    squares[static_cast<std::size_t>(sample)] += weight * weight * of_term.residual.squaredNorm();
    const double used = of_term.used.size() > 0 ? of_term.used.sum() : 0.0;
    rows[static_cast<std::size_t>(sample)] += static_cast<double>(of_term.residual.size()) - used;
    all -= used;
  });
  std::vector<double> means;
  std::size_t worst = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!(rows[i] > 0.0)) continue;
    means.push_back(squares[i] / rows[i]);
    if (squares[i] * rows[worst] > squares[worst] * rows[i]) worst = i;
  }
  if (means.empty()) return std::nullopt;
  // The median of chi-square is about n (1 - 2 / (9 n))^3; residuals of a fit are smaller than
  // noise.
  const double n = rows[worst];
  const double usual =
      median_of(std::move(means)) / std::pow(1.0 - 2.0 / (9.0 * n), 3.0) * (all / freedom);
  if (!(usual > 0.0) || !(squares[worst] / n > detail::stated_square(*problem))) {
    return std::nullopt;
  }
  if (!detail::is_misfit(squares[worst] / n / usual, n, freedom,
                         static_cast<double>(samples.size()))) {
    return std::nullopt;
  }
  return worst;
}

/// A problem cannot drop a sample, so it is built again.
inline void OnlineCalibration::Impl::leave_out(std::size_t sample) {
  samples.erase(samples.begin() + static_cast<std::ptrdiff_t>(sample));
  numbers.erase(numbers.begin() + static_cast<std::ptrdiff_t>(sample));
  std::vector<std::vector<Pose<double>>> poses = problem->poses_of_samples();
  if (!poses.empty()) poses.erase(poses.begin() + static_cast<std::ptrdiff_t>(sample));
  problem = make();
  for (const Sample& kept : samples) problem->add_sample(kept);
  problem->set_poses_of_samples(std::move(poses));
}

inline bool OnlineCalibration::Impl::add_if_it_fits(const Sample& sample, OnlineState& state) {
  problem->add_sample(sample);
  samples.push_back(sample);
  numbers.push_back(++added);
  auto evaluator = problem->evaluator(free, 1);
  if (!std::isfinite(evaluator->normal_equations(values, false).cost)) {
    leave_out(samples.size() - 1);  // a residual is undefined: a point behind a camera
    return false;
  }
  if (samples.size() > detail::kFewestToTest && noise2 > 0.0) {
    int rows = 0;
    const double x = innovation(*evaluator, rows);
    state.times = std::sqrt(std::max(0.0, x));
    const bool is_off =
        detail::is_misfit(x, rows, freedom, 1.0) && x * noise2 > detail::stated_square(*problem);
    if (rows > 0 && (!std::isfinite(x) || is_off)) {
      leave_out(samples.size() - 1);
      return false;
    }
  }
  step_to_minimum(*evaluator);
  while (const auto worst = misfit(*evaluator)) {
    state.dropped.push_back(numbers[*worst]);
    leave_out(*worst);
    evaluator = problem->evaluator(free, 1);
    step_to_minimum(*evaluator);
  }
  std::erase(state.dropped, added);
  return !numbers.empty() && numbers.back() == added;
}

namespace detail {

// Possible next moves of one joint in a session.

/// True if a point is in the image of the camera that observed a sample, or if that is unknown.
[[nodiscard]] inline bool in_image(const Sample& sample, const Vector3<double>& p_camera) {
  if (!(p_camera.z() > 0.0)) return false;
  for (const Observation& seen : sample.observations) {
    if (!seen.camera || !(seen.camera->p[0] > 0.0)) continue;
    const CameraInfo& camera = *seen.camera;
    const double u = camera.p[0] * p_camera.x() / p_camera.z() + camera.p[2];
    const double v = camera.p[5] * p_camera.y() / p_camera.z() + camera.p[6];
    if (u < 0.0 || v < 0.0 || u > camera.width || v > camera.height) return false;
  }
  return true;
}

/// True if a sample has an observation of a camera.
[[nodiscard]] inline bool has_camera(const Sample& sample) {
  return std::any_of(sample.observations.begin(), sample.observations.end(),
                     [](const Observation& seen) { return seen.camera.has_value(); });
}

}  // namespace detail

/// Moves of one joint from the pose of the last sample, with that sample moved.  Its measurements
/// do not matter: information is that of the error-free problem.
inline std::vector<std::pair<NextMove, Sample>> OnlineCalibration::Impl::candidates(
    double step) const {
  const RobotState robot{*problem, values};
  const detail::PoseInBase of_frame(robot, frame), of_in(robot, in);
  std::set<std::string> joints;
  for (const FrameOnRobot* of : {&frame, &in}) {
    const RuntimeChain chain =
        make_chain(problem->robot(), problem->base(), of->link, problem->frames());
    for (const ChainJoint& joint : chain.joints) {
      if (has_position(joint)) joints.insert(joint.drive.joint);
    }
  }
  std::vector<std::pair<NextMove, Sample>> found;
  const Sample& last = samples.back();
  for (const std::string& name : joints) {
    const Joint& joint = problem->robot().joint(name);
    const double by = joint.type == JointType::prismatic ? 0.2 * step : step;
    for (const double change : {-by, by}) {
      Sample there = last;
      const auto at = std::find(there.joint_names.begin(), there.joint_names.end(), name);
      if (at == there.joint_names.end()) continue;
      double& position =
          there.joint_positions[static_cast<std::size_t>(at - there.joint_names.begin())];
      position += change;
      if (joint.limits && (position < joint.limits->lower || position > joint.limits->upper)) {
        continue;
      }
      const Vector3<double> p_in = (of_in.at(there).inverse() * of_frame.at(there)).translation;
      if (detail::has_camera(last) && !detail::in_image(there, p_in)) continue;
      found.emplace_back(NextMove{name, change, 0.0}, std::move(there));
    }
  }
  return found;
}

OnlineCalibration::OnlineCalibration(MakeProblem make, const FreeSet& free, ParameterValues values,
                                     const FrameOnRobot& frame, const FrameOnRobot& in)
    : impl_(new Impl{std::move(make), free, {values.begin(), values.end()}, frame, in}) {
  impl_->problem->check(free);
  (void)detail::PoseDerivative(*impl_->problem, free, impl_->values, frame, in);
}

OnlineCalibration::~OnlineCalibration() = default;
OnlineCalibration::OnlineCalibration(OnlineCalibration&&) noexcept = default;
OnlineCalibration& OnlineCalibration::operator=(OnlineCalibration&&) noexcept = default;

void OnlineCalibration::expect(std::vector<Sample> poses) {
  impl_->ahead = std::move(poses);
}

OnlineState OnlineCalibration::add(const Sample& sample) {
  OnlineState state;
  state.fits = impl_->add_if_it_fits(sample, state);
  state.samples = static_cast<int>(impl_->samples.size());
  state.noise = std::sqrt(impl_->noise2);
  if (impl_->hessian.size() > 0) impl_->set_pose(state);
  return state;
}

const std::vector<double>& OnlineCalibration::values() const {
  return impl_->values;
}

std::optional<NextMove> OnlineCalibration::next_move(double step) const {
  const Impl& known = *impl_;
  if (known.samples.empty() || known.freedom <= 0) return std::nullopt;
  if (!known.problem->sample_poses().empty()) return std::nullopt;  // a person moves, too
  auto candidates = known.candidates(step);
  const auto trials = known.make();
  for (const auto& candidate : candidates) trials->add_sample(candidate.second);
  std::vector<detail::SampleRows> rows(candidates.size());
  (void)trials->evaluator(known.free, 1)
      ->evaluate(
          known.values, true,
          [&](int term, int sample, const TermResiduals& of_term) {
            rows[static_cast<std::size_t>(sample)].append(of_term, trials->term(term).weight);
          },
          Linearization::error_free);
  OnlineState now;
  known.set_pose(now);
  std::optional<NextMove> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (rows[i].jacobian.size() == 0) continue;
    OnlineState then;
    known.set_pose(then, known.hessian + rows[i].jacobian.transpose() * rows[i].jacobian);
    if (!(then.position < least)) continue;
    least = then.position;
    best = candidates[i].first;
    best->position = then.position;
  }
  if (best && now.known && best->position >= now.position) return std::nullopt;
  return best;
}

}  // namespace kinecal
