// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/uncertainty/weak_parameters.hpp"

#include <gmock/gmock.h>

#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

/// The scene, and a covariance that a test makes up.
struct MadeUp {
  test::NoisyScene scene{5};
  std::unique_ptr<AnyProblem> problem = scene.problem({});
  FreeSet free = scene.free();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(free.size(), free.size()) * 1e-8;
  Eigen::VectorXd deviation = Eigen::VectorXd::Zero(free.size());

  [[nodiscard]] int column(const char* name) const {
    return free.column(problem->table().index(name));
  }
  [[nodiscard]] int index(const char* name) const { return problem->table().index(name); }
  /// Moves along a direction by one standard deviation.
  void add(const std::vector<std::pair<const char*, double>>& direction) {
    Eigen::VectorXd d = Eigen::VectorXd::Zero(free.size());
    for (const auto& [name, size] : direction) d(column(name)) = size;
    covariance += d * d.transpose();
  }
  [[nodiscard]] WeakParameters weak() const {
    Eigen::VectorXd all = covariance.diagonal().cwiseSqrt();
    for (int c = 0; c < free.size(); ++c) {
      if (deviation(c) > 0.0) all(c) = deviation(c);
    }
    return weak_parameters(*problem, free, {free.size(), covariance, all});
  }
};

TEST(WeakParameters, AreThoseWhoseDeviationIsOfNoUse) {
  MadeUp made;
  made.add({{"elbow", 0.08}});        // 4.6 degrees
  made.add({{"head_pan_x", 0.018}});  // metres
  made.add({{"camera_fx", 0.045}});
  EXPECT_THAT(made.weak().parameters, IsEmpty());
  made.add({{"elbow", 0.04}});
  made.add({{"head_pan_x", 0.01}});
  made.add({{"camera_fx", 0.03}});
  const WeakParameters weak = made.weak();
  EXPECT_THAT(weak.parameters, UnorderedElementsAre(made.index("elbow"), made.index("head_pan_x"),
                                                    made.index("camera_fx")));
  EXPECT_THAT(weak.hold,
              ElementsAre(made.index("head_pan_x"), made.index("camera_fx"), made.index("elbow")));
}

/// Two parameters that only their sum determines: to hold the frame is enough.
TEST(WeakParameters, AreHeldFramesBeforeJointsUntilTheOthersAreDetermined) {
  MadeUp made;
  made.add({{"elbow", 0.4}, {"head_pan_y", -0.05}, {"camera_cy", 0.3}});
  const WeakParameters weak = made.weak();
  EXPECT_EQ(weak.parameters.size(), 3U);
  EXPECT_THAT(weak.hold, ElementsAre(made.index("head_pan_y")));
}

TEST(WeakParameters, AreNotThoseThatNothingDetermines) {
  MadeUp made;
  made.deviation(made.column("wrist")) = std::numeric_limits<double>::infinity();
  EXPECT_THAT(made.weak().parameters, IsEmpty());
}

TEST(WeakParameters, HaveNoLimitWithoutAUnit) {
  EXPECT_EQ(useful_deviation({.name = "x", .unit = "Nm"}), std::numeric_limits<double>::infinity());
  EXPECT_DOUBLE_EQ(useful_deviation({.name = "x", .unit = "m"}), 0.02);
}

}  // namespace
}  // namespace kinecal
