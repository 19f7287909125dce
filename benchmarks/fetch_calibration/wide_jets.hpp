// Automatic differentiation of everything: our walk in one wide ceres::Jet over all parameters.
//
// At its best: sines and cosines of measured joints are stored; corrections are computed once for
// all samples of an evaluation, in the scalar of that evaluation.  The computations in jets are in
// wide_jets.cpp, so that they can have their own compiler flags.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/evaluation_callback.h>
#include <ceres/jet.h>
#include <ceres/sized_cost_function.h>

#include <memory>

#include "kinecal/kinematics/pose_walker.hpp"
#include "kinecal/parameters/chain_parameters.hpp"
#include "method.hpp"

namespace kinecal::bench {

using WideJet = ceres::Jet<double, kParameters>;

/// What all samples of one evaluation share.
template <class S>
struct WalkState {
  Corrections<S> arm, camera;
  std::array<S, 6> depth;
};

/// One sample as the walk needs it.
struct WalkSample {
  std::vector<JointState<double>> arm, camera;
  std::array<double, 6> settings;
  std::array<Vector3<double>, kLeds> measured, on_arm;
};

struct WalkModel {
  FetchChains chains;
  std::vector<JointIndices> arm, camera;

  explicit WalkModel(const FetchWork& work)
      : chains(work),
        arm(chain_parameters(chains.arm, work.table)),
        camera(chain_parameters(chains.camera, work.table)) {}

  [[nodiscard]] WalkSample pack(const Sighting& seen) const {
    return {measured_joint_states(chains.arm, seen), measured_joint_states(chains.camera, seen),
            seen.camera, seen.measured, seen.on_arm};
  }

  /// @param x  (26) parameters in any scalar
  template <class S>
  [[nodiscard]] WalkState<S> state(std::span<const S> x) const {
    WalkState<S> state{corrections_for(arm, x), corrections_for(camera, x), {}};
    for (std::size_t i = 0; i < state.depth.size(); ++i) {
      state.depth[i] = x[static_cast<std::size_t>(chains.camera_parameters[i])];
    }
    return state;
  }

  /// @param residual  (12) metres
  template <class S>
  void residuals(const WalkState<S>& state, const WalkSample& sample, S* residual) const {
    const auto tip = [](const RuntimeChain& chain, const std::vector<JointState<double>>& motions,
                        const Corrections<S>& corrections) {
      PoseWalker<S> walker;
      walk(chain, std::span<const JointState<double>>(motions),
           std::span<const JointCorrection<S>>(corrections), walker);
      return walker.pose;
    };
    const Pose<S> base_T_arm = tip(chains.arm, sample.arm, state.arm);
    const Pose<S> base_T_camera = tip(chains.camera, sample.camera, state.camera);
    for (std::size_t i = 0; i < kLeds; ++i) {
      const Vector3<S> seen =
          base_T_camera *
          DepthCamera{}.place(Measurement<DepthCamera, double>{.point = sample.measured[i],
                                                               .settings = sample.settings},
                              state.depth);
      const Vector3<S> on_arm = base_T_arm * sample.on_arm[i];
      for (int axis = 0; axis < 3; ++axis) residual[3 * i + axis] = seen(axis) - on_arm(axis);
    }
  }
};

/// The state as jets with derivatives by the parameters.
/// @param x  (26) parameters
[[nodiscard]] WalkState<WideJet> wide_jet_state(const WalkModel& model, const double* x);

/// Residuals and Jacobian of one sample.
/// @param residuals  (12) metres
/// @param jacobian   (12 x 26) row-major
void wide_jet_rows(const WalkModel& model, const WalkState<WideJet>& state,
                   const WalkSample& sample, double* residuals, double* jacobian);

/// The states of one evaluation in both scalars; Ceres calls it before it evaluates.
class WideJetStates final : public ceres::EvaluationCallback {
 public:
  /// @param x  (26) the parameters, which Ceres changes in place
  WideJetStates(const WalkModel& model, const double* x) : model_(model), x_(x) {}

  void PrepareForEvaluation(bool jacobians, bool new_point) override {
    if (new_point) have_values_ = have_jets_ = false;
    if (jacobians && !have_jets_) {
      jets_ = wide_jet_state(model_, x_);
      have_jets_ = true;
    } else if (!jacobians && !have_values_) {
      values_ = model_.state(std::span<const double>(x_, kParameters));
      have_values_ = true;
    }
  }

  [[nodiscard]] const WalkModel& model() const { return model_; }
  [[nodiscard]] const WalkState<double>& values() const { return values_; }
  [[nodiscard]] const WalkState<WideJet>& jets() const { return jets_; }

 private:
  const WalkModel& model_;
  const double* x_;
  bool have_values_ = false, have_jets_ = false;
  WalkState<double> values_;
  WalkState<WideJet> jets_;
};

/// A ceres::AutoDiffCostFunction with a state that all samples share.
class WideJetCost final : public ceres::SizedCostFunction<kRows, kParameters> {
 public:
  WideJetCost(const WideJetStates& states, WalkSample sample)
      : states_(states), sample_(std::move(sample)) {}

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    if (jacobians == nullptr || jacobians[0] == nullptr) {
      states_.model().residuals(states_.values(), sample_, residuals);
      return true;
    }
    wide_jet_rows(states_.model(), states_.jets(), sample_, residuals, jacobians[0]);
    return true;
  }

 private:
  const WideJetStates& states_;
  WalkSample sample_;
};

class WideJets {
 public:
  WideJets(const FetchWork& work, int samples)
      : model_(work), start_(work.initial_values()), x_(start_), states_(model_, x_.data()) {
    for (const Sighting& seen : work.sightings(samples)) {
      costs_.push_back(std::make_unique<WideJetCost>(states_, model_.pack(seen)));
    }
    const auto rows = static_cast<Eigen::Index>(costs_.size()) * kRows;
    stacked_ = {Eigen::VectorXd(rows), RowMajor(rows, kParameters)};
  }
  WideJets(const WideJets&) = delete;  // the states point into this
  WideJets& operator=(const WideJets&) = delete;

  void evaluate(Values x, bool derivatives) {
    std::copy(x.begin(), x.end(), x_.data());
    states_.PrepareForEvaluation(derivatives, true);
    const double* parameters = x_.data();
    for (std::size_t n = 0; n < costs_.size(); ++n) {
      double* jacobian = stacked_.jacobian.data() + n * kRows * kParameters;
      (void)costs_[n]->Evaluate(&parameters, stacked_.residual.data() + n * kRows,
                                derivatives ? &jacobian : nullptr);
    }
  }

  [[nodiscard]] const Stacked& stacked() const { return stacked_; }

  [[nodiscard]] Solved solve() {
    x_ = start_;
    return solve_with_ceres(costs_, x_, &states_);
  }

 private:
  WalkModel model_;
  Eigen::VectorXd start_, x_;  ///< x_: evaluated at, in place
  WideJetStates states_;
  std::vector<std::unique_ptr<WideJetCost>> costs_;
  Stacked stacked_;
};

}  // namespace kinecal::bench
