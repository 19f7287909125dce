#include "kinecal/evaluation/rows/block_rows.hpp"

#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "support/blocks.hpp"
#include "support/check_sums.hpp"

namespace kinecal {
namespace {

TEST(BlockRows, SumToThoseMultipliedOutForPointToPixel) {
  test::check_sums_of({.residual_of = 500}, PointToPixel{}, {"arm", "eye"});
  test::check_sums_of({.arm_frame = "board", .residual_of = 500}, PointToPixel{}, {"arm", "eye"});
}

TEST(BlockRows, SumToThoseMultipliedOutForPointToPixelOfADepthCamerasPoint) {
  test::check_sums_of({.residual_of = 500}, PointToPixel{}, {"camera", "eye"});
}

/// Seen to be a difference or not: it is summed by moments or by jets.
TEST(BlockRows, SumToThoseMultipliedOutForADifferenceOfAUser) {
  test::check_sums_of({}, test::UnknownDifference{}, {"camera", "arm"});
  test::check_sums_of({}, test::HiddenDifference{}, {"camera", "arm"});
  test::check_sums_of({.base = "finger_left"}, test::HiddenDifference{}, {"arm", "camera"});
  test::check_sums_of({}, test::HiddenDifference{}, {"camera", "twin"});
}

TEST(BlockRows, SumToThoseMultipliedOutForOneResidual) {
  test::check_sums_of({}, test::Distance{}, {"arm", "camera"});
  test::check_sums_of({}, test::Distance{}, {"counterweight", "arm"});
}

TEST(BlockRows, SumToThoseMultipliedOutForFiveResiduals) {
  test::check_sums_of({}, test::FiveOfTwo{}, {"camera", "arm"});
  test::check_sums_of({}, test::FiveOfTwo{}, {"second", "camera"});
}

/// A difference known as one is summed by its moments, another by jets: the same numbers.
TEST(BlockRows, OfADifferenceDoNotDependOnWhetherItIsKnownAsOne) {
  for (const auto& sensors : std::vector<std::vector<std::string>>{
           {"camera", "arm"}, {"camera", "second"}, {"counterweight", "finger"}}) {
    Problem known = test::wide_problem<Packet>(), unknown = test::wide_problem<Packet>();
    known.add_block("b", PointToPoint{}, sensors, {.scale = 3.0, .loss = {LossType::cauchy, 0.2}});
    unknown.add_block("b", test::HiddenDifference{}, sensors,
                      {.scale = 3.0, .loss = {LossType::cauchy, 0.2}});
    const auto x = test::random_values(known.table(), 0.1, 9);
    for (const Sample& s : test::wide_samples(known, x, 7)) {
      known.add_sample(s);
      unknown.add_sample(s);
    }
    const FreeSet all = test::all_free(known.table());
    test::expect_same(normal_equations(known, x, &all), normal_equations(unknown, x, &all),
                      test::kSameArithmetic);
  }
}

}  // namespace
}  // namespace kinecal
