// Following a session.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/online.hpp"

#include <limits>

#include "kinecal/trust/online_misfits.ipp"
#include "kinecal/trust/online_moves.ipp"

namespace kinecal {

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
  if (!known.problem->own_poses().empty()) return std::nullopt;  // a person moves, too
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
