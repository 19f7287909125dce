#include "kinecal/trust/verify/solution_change.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

/// One robot, calibrated twice by other samples of it.
struct Twice {
  test::NoisyScene first, second;
  CalibratedState then, now;

  explicit Twice(unsigned seed) : first(20, seed), second(12, 5000 + seed) {
    const Assessment of_first = first.solve_and_assess({.folds = 0}),
                     of_second = second.solve_and_assess({.folds = 0});
    then = calibrated_state(of_first, first.values());
    now = calibrated_state(of_second, second.values());
  }
  [[nodiscard]] SolutionChange change() const {
    return solution_change(first.solved(), then, now, 30.0);
  }
};

TEST(SolutionChange, IsWithinChanceOfOneRobot) {
  constexpr int kRuns = 80;
  int alarms = 0;
  double sum = 0.0;
  for (unsigned run = 0; run < kRuns; ++run) {
    const SolutionChange change = Twice(run).change();
    ASSERT_EQ(change.freedom, std::ssize(test::kNoisyFree));
    alarms += change.probability < 0.05 ? 1 : 0;
    sum += change.statistic / change.freedom;
  }
  EXPECT_LE(alarms, 12) << "4 are expected; four standard deviations";
  EXPECT_NEAR(sum / kRuns, 1.0, 0.3);
}

TEST(SolutionChange, NamesTheJointThatHasMoved) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    Twice twice(seed);
    const int elbow = twice.first.solved().table().index("elbow");
    twice.now.values[static_cast<std::size_t>(elbow)] += 0.01;
    const SolutionChange change = twice.change();
    EXPECT_LT(change.probability, 1e-4);
    ASSERT_FALSE(change.owners.empty());
    EXPECT_EQ(change.owners.front().owner, "elbow");
    EXPECT_NEAR(change.owners.front().change.front(), 0.01,
                4.0 * change.owners.front().deviation.front());
  }
}

/// A direction that one of both does not know says nothing.
TEST(SolutionChange, LeavesOutWhatIsNotDetermined) {
  Twice twice(1);
  const int elbow = twice.first.solved().table().index("elbow");
  twice.now.undetermined.push_back({{elbow, 1.0}});
  twice.now.values[static_cast<std::size_t>(elbow)] += 1.0;
  const SolutionChange change = twice.change();
  EXPECT_EQ(change.freedom, std::ssize(test::kNoisyFree) - 1);
  EXPECT_GT(change.probability, 1e-3);
}

}  // namespace
}  // namespace kinecal
