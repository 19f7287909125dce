// The computations in wide jets.  They are compiled at -O2: with g++ 12 they are half as fast at
// -O3.
// SPDX-License-Identifier: Apache-2.0
#include "wide_jets.hpp"

namespace kinecal::bench {

WalkState<WideJet> wide_jet_state(const WalkModel& model, const double* x) {
  std::array<WideJet, kParameters> jets;
  for (int i = 0; i < kParameters; ++i) jets[static_cast<std::size_t>(i)] = WideJet(x[i], i);
  return model.state(std::span<const WideJet>(jets));
}

void wide_jet_rows(const WalkModel& model, const WalkState<WideJet>& state,
                   const WalkSample& sample, double* residuals, double* jacobian) {
  std::array<WideJet, kRows> jets;
  model.residuals(state, sample, jets.data());
  Eigen::Map<RowMajorBlock> rows(jacobian);
  for (int row = 0; row < kRows; ++row) {
    const WideJet& jet = jets[static_cast<std::size_t>(row)];
    residuals[row] = jet.a;
    rows.row(row) = jet.v.transpose();
  }
}

}  // namespace kinecal::bench
