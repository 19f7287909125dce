// Definitions of sample_design.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/study/sample_design.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/study/sample_rows.ipp"
#include "kinecal/trust/plain_equations.hpp"
#include "kinecal/trust/uncertainty/uncertainty.hpp"

namespace kinecal {

namespace detail {
namespace {

// Derivatives of samples' rows by each measurement error.

/// Collects the changes of each sample's rows by each error.
class DesignRows {
 public:
  DesignRows(const MakeProblem& make, const FreeSet& free, ParameterValues values,
             std::span<const Sample> samples, const MeasurementNoise& noise, Targets targets)
      : changing_(make, values, samples), noise_(noise) {
    const StudyRows rows = changing_.rows(changing_.samples(), &free);
    const Stack no_rows{
        {}, Eigen::MatrixXd(0, free.size()), {}, {}, {}};  // of a sample that no block uses
    stacks_.assign(changing_.samples().size(), no_rows);
    for (const auto& [key, jacobian] : rows.jacobian) {
      Stack& stack = stacks_[sample_of(key)];
      stack.first[key] = stack.jacobian.rows();
      stack.jacobian.conservativeResize(stack.jacobian.rows() + jacobian.rows(), free.size());
      stack.jacobian.bottomRows(jacobian.rows()) = jacobian;
    }
    if (targets == Targets::free) add_targets();
    const Eigen::MatrixXd nothing = Eigen::MatrixXd::Zero(free.size(), free.size());
    for (Stack& stack : stacks_) {
      stack.effective = stack.without_half(stack.jacobian);
      stack.scores = nothing;
    }
    add_features();
    add_joints();
  }

  [[nodiscard]] std::vector<SampleDesign> designs() const {
    std::vector<SampleDesign> all;
    for (const Stack& stack : stacks_) {
      all.push_back(
          {PlainMatrix(stack.jacobian.transpose() * stack.effective), PlainMatrix(stack.scores)});
    }
    return all;
  }

 private:
  /// The rows of a sample, and their changes by errors.
  struct Stack {
    std::map<FeatureKey, Eigen::Index> first;  ///< of each feature's rows
    Eigen::MatrixXd jacobian;                  ///< weighted
    std::vector<Eigen::VectorXd> motions;      ///< weighted change by a motion of a free target
    Eigen::MatrixXd effective;                 ///< (I - P / 2) jacobian
    Eigen::MatrixXd scores;                    ///< V of the errors so far

    [[nodiscard]] Eigen::MatrixXd matrix(const std::vector<Eigen::VectorXd>& columns) const {
      Eigen::MatrixXd all(jacobian.rows(), static_cast<Eigen::Index>(columns.size()));
      for (std::size_t i = 0; i < columns.size(); ++i) {
        all.col(static_cast<Eigen::Index>(i)) = columns[i];
      }
      return all;
    }
    /// (I - P / 2) times rows.
    [[nodiscard]] Eigen::MatrixXd without_half(const Eigen::MatrixXd& of) const {
      if (motions.empty()) return of;
      Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix(motions));
      qr.setThreshold(1e-8);  // points on a line do not determine the rotation about it
      const Eigen::MatrixXd q =
          qr.householderQ() * Eigen::MatrixXd::Identity(jacobian.rows(), qr.rank());
      return of - 0.5 * q * (q.transpose() * of);
    }
  };

  [[nodiscard]] static std::size_t sample_of(const FeatureKey& key) {
    return static_cast<std::size_t>(std::get<0>(key));
  }

  /// Calls a function with each feature's rows in a stack and their change between two evaluations, in standard deviations.
  /// @param half  of the change between them
  template <class Visit>
  void for_changes(const StudyRows& after, const StudyRows& before, double half,
                   const Visit& visit) {
    for (const auto& [key, residual] : after.residual) {
      const Eigen::VectorXd change = (residual - before.residual.at(key)) / (2.0 * half);
      if (change.isZero(0.0)) continue;
      Stack& stack = stacks_[sample_of(key)];
      visit(key, stack, stack.first.at(key), change);
    }
  }

  /// Adds the score of one error to each sample, or of one to each of its places.
  /// @param apart  features err independently; else all rows of a sample together
  void add_scores(const StudyRows& after, const StudyRows& before, double half, bool apart) {
    std::map<std::pair<std::size_t, int>, Eigen::VectorXd> scores;
    for_changes(after, before, half,
                [&](const FeatureKey& key, const Stack& stack, Eigen::Index first,
                    const Eigen::VectorXd& change) {
                  Eigen::VectorXd& score = scores[{sample_of(key), apart ? std::get<2>(key) : 0}];
                  if (score.size() == 0) score.setZero(stack.effective.cols());
                  score += stack.effective.middleRows(first, change.size()).transpose() * change;
                });
    for (const auto& [of, score] : scores) stacks_[of.first].scores += score * score.transpose();
  }

  /// Adds a motion of a target to each sample.
  void add_motion(const StudyRows& after, const StudyRows& before, double half) {
    std::map<std::size_t, Eigen::VectorXd> motions;
    for_changes(after, before, half,
                [&](const FeatureKey& key, const Stack& stack, Eigen::Index first,
                    const Eigen::VectorXd& change) {
                  Eigen::VectorXd& motion = motions[sample_of(key)];
                  if (motion.size() == 0) motion.setZero(stack.jacobian.rows());
                  motion.segment(first, change.size()) += change;
                });
    for (auto& [sample, motion] : motions) stacks_[sample].motions.push_back(std::move(motion));
  }

  void add_features() {
    constexpr double kHalf = 0.01;  // standard deviations
    for (const MountedSensor& sensor : changing_.problem().sensors()) {
      const std::string& name = sensor.mount().name;
      if (!changing_.measuring().contains(name)) continue;
      const bool together =
          !changing_.takes_planes(name);  // different features change different rows
      const std::size_t places = together ? 1 : most_features(name);
      for (std::size_t error = 0; error < most_errors(sensor); ++error) {
        for (std::size_t only = 0; only < places; ++only) {
          const auto change = [&](std::size_t, const Observation& seen, std::size_t place) {
            std::optional<FeatureChange> of;
            if (!together && place != only) return of;
            const auto errors = errors_of(sensor, seen, seen.features[place], noise_);
            if (error < errors.size()) of = errors[error];
            return of;
          };
          add_scores(changing_.rows(changing_.with(name, change, kHalf)),
                     changing_.rows(changing_.with(name, change, -kHalf)), kHalf, together);
        }
      }
    }
  }

  void add_joints() {
    constexpr double kHalf = 0.01;
    std::set<std::string> joints;
    for (const Sample& sample : changing_.samples()) {
      joints.insert(sample.joint_names.begin(), sample.joint_names.end());
    }
    const auto moved = [&](const std::string& joint, double change) {
      std::vector<Sample> samples = changing_.samples();
      for (Sample& sample : samples) {
        for (std::size_t i = 0; i < sample.joint_names.size(); ++i) {
          if (sample.joint_names[i] == joint) sample.joint_positions[i] += change;
        }
      }
      return changing_.rows(samples);
    };
    for (const std::string& joint : joints) {
      const double change = kHalf * noise_.joint;
      if (change > 0.0) add_scores(moved(joint, change), moved(joint, -change), kHalf, false);
    }
  }

  /// Rigid motions of the features whose position on their link is known.
  void add_targets() {
    constexpr double kHalf = 1e-4;  // metres, radians
    for (const MountedSensor& sensor : changing_.problem().sensors()) {
      const std::string& name = sensor.mount().name;
      if (changing_.measuring().contains(name)) continue;
      for (int k = 0; k < 6; ++k) {
        const Vector3<double> axis = Vector3<double>::Unit(k % 3);
        const auto change = [&](std::size_t, const Observation& seen, std::size_t place) {
          const Feature& feature = seen.features[place];
          FeatureChange of;
          of.point = k < 3 ? axis : axis.cross(feature.point - pivot_of(seen));
          if (k >= 3 && feature.rotation) of.rotation = feature.rotation->transpose() * axis;
          return std::optional(of);
        };
        add_motion(changing_.rows(changing_.with(name, change, kHalf)),
                   changing_.rows(changing_.with(name, change, -kHalf)), kHalf);
      }
    }
  }

  [[nodiscard]] std::size_t most_features(const std::string& name) {
    std::size_t most = 0;
    for (const Sample& sample : changing_.samples()) {
      const Observation* seen = sample.observation(name);
      if (seen != nullptr) most = std::max(most, seen->features.size());
    }
    return most;
  }
  [[nodiscard]] std::size_t most_errors(const MountedSensor& sensor) {
    std::size_t most = 0;
    for (const Sample& sample : changing_.samples()) {
      const Observation* seen = sample.observation(sensor.mount().name);
      if (seen == nullptr || seen->features.empty()) continue;
      most = std::max(most, errors_of(sensor, *seen, seen->features[0], noise_).size());
    }
    return most;
  }

  ChangingSamples changing_;
  MeasurementNoise noise_;
  std::vector<Stack> stacks_;
};

/// The contribution of a problem's priors for one sample.
[[nodiscard]] PlainMatrix prior_of_one(const MakeProblem& make, const FreeSet& free,
                                       ParameterValues values, const Sample& sample,
                                       const SampleDesign& design) {
  const std::unique_ptr<AnyProblem> problem = make();
  problem->add_sample(sample);
  const Eigen::MatrixXd all = plain_equations(*problem, free, values).hessian.matrix();
  if (problem->priors().empty()) return Eigen::MatrixXd::Zero(free.size(), free.size());
  return all - design.information.matrix();
}

}  // namespace
}  // namespace detail

StudyDesign study_design(const MakeProblem& make, const FreeSet& free, ParameterValues values,
                         std::span<const Sample> samples, const MeasurementNoise& noise,
                         Targets targets) {
  StudyDesign design{detail::DesignRows(make, free, values, samples, noise, targets).designs(),
                     Eigen::MatrixXd::Zero(free.size(), free.size())};
  if (!samples.empty()) {
    const SampleDesign held =
        targets == Targets::held
            ? design.samples[0]
            : detail::DesignRows(make, free, values, samples.first(1), noise, Targets::held)
                  .designs()[0];
    design.prior = detail::prior_of_one(make, free, values, samples[0], held);
  }
  return design;
}

ExpectedUncertainty expected_uncertainty(const StudyDesign& design, std::span<const int> chosen) {
  const Eigen::Index n = design.prior.rows();
  const Eigen::MatrixXd prior = static_cast<double>(chosen.size()) * design.prior.matrix();
  Eigen::MatrixXd information = prior, scores = Eigen::MatrixXd::Zero(n, n);
  for (const int i : chosen) {
    information += design.samples[static_cast<std::size_t>(i)].information.matrix();
    scores += design.samples[static_cast<std::size_t>(i)].scores.matrix();
  }
  const Eigen::VectorXd length = information.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd units = length.unaryExpr([](double l) { return l > 0.0 ? 1.0 / l : 1.0; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(units.asDiagonal() * information *
                                                              units.asDiagonal());
  constexpr double kNothing = 1e-11;  // of the largest eigenvalue: below it is rounding
  const auto& eigen = solver.eigenvalues();
  Eigen::VectorXd inverse = Eigen::VectorXd::Zero(n), lost = Eigen::VectorXd::Zero(n);
  ExpectedUncertainty expected;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (eigen(i) > kNothing * eigen(n - 1)) {
      inverse(i) = 1.0 / eigen(i);
      ++expected.determined;
    } else {
      lost += solver.eigenvectors().col(i).cwiseAbs2();
    }
  }
  const Eigen::MatrixXd by = units.asDiagonal() * solver.eigenvectors() * inverse.asDiagonal() *
                             solver.eigenvectors().transpose() * units.asDiagonal();
  const Eigen::MatrixXd covariance = by * scores * by;
  expected.covariance = covariance;
  expected.deviation = detail::deviations(covariance, lost.cwiseSqrt());
  return expected;
}

double expected_variance(const ExpectedUncertainty& expected, const PlainMatrix& goal) {
  return goal.matrix().cwiseProduct(expected.covariance.matrix()).sum();
}

}  // namespace kinecal
