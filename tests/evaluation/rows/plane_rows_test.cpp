#include "kinecal/evaluation/rows/plane_rows.hpp"

#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "support/check_sums.hpp"

namespace kinecal {
namespace {

/// The planes of random points turn much with their points.
TEST(PlaneRows, SumToThoseMultipliedOut) {
  const test::Scene planes{.residual_of = 10, .either_sign = true};
  test::check_sums_of(planes, PlaneToPlane{2.0, 3.0}, {"camera", "arm"});
  test::check_sums_of(planes, PlaneToPlane{2.0, 3.0}, {"camera", "second"});
}

}  // namespace
}  // namespace kinecal
