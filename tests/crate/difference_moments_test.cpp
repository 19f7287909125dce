#include "kinecal/crate/difference_moments.hpp"

#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "support/blocks.hpp"
#include "support/sums.hpp"

namespace kinecal {
namespace {

/// Moments against the products of rows that jets made, number by number and lane by lane.
/// @param first  the features from this one on
template <class S>
void expect_products_of_rows(const std::vector<std::string>& sensors, const FreeSet& free,
                             std::size_t first = 0) {
  BasicProblem<S> problem = test::wide_problem<S>();
  problem.add_block("b", PointToPoint{}, sensors, {});
  const auto x = test::random_values(problem.table(), 0.05, 3);
  for (const Sample& s : test::wide_samples(problem, x, 2 * kLanes<S> + 1)) problem.add_sample(s);
  using Rows = BlockRows<test::UnknownDifference, S>;
  int packs = 0;
  Evaluator<S>(problem, free).for_each_term(x, true, [&](int, auto&, auto views, auto&) {
    ++packs;
    FeatureGram<S> by_moments, by_rows;
    by_rows.resize(2, Rows::cameras(views, first));
    by_rows.set_zero();
    std::vector<S> weights;
    std::vector<Vector3<S>> residuals;
    for (std::size_t i = first; i < Rows::features(views); ++i) {
      weights.push_back(views[0]->points()[i].x() + S(2.0));  // another one in each lane
      const auto rows =
          Rows::template rows<true>(test::UnknownDifference{}, views, i, Linearization::measured);
      by_rows.add(rows, weights.back());
      residuals.push_back(rows.residual);
    }
    by_rows.complete();
    DifferenceMoments<S>(views, first, weights, residuals).fill(by_moments);
    ASSERT_EQ(by_moments.width(), by_rows.width());
    // Four features, their points a metre or two from the base: products of up to ten.
    constexpr double kRounding = 1e-13;
    const std::size_t width = by_rows.width();
    for (std::size_t i = 0; i + 1 < width; ++i) {
      const bool of_body = i < 12;
      for (std::size_t j = of_body ? 6 * (i / 6) : i; j < width; ++j) {
        for (int l = 0; l < kLanes<S>; ++l) {
          EXPECT_NEAR(lane(by_moments.row(i)[j], l), lane(by_rows.row(i)[j], l), kRounding)
              << "row " << i << ", column " << j << ", lane " << l;
        }
      }
    }
  });
  EXPECT_EQ(packs, 3);
}

template <class S>
void check_sensors() {
  const ParameterTable table = test::wide_table();
  for (const auto& sensors : std::vector<std::vector<std::string>>{
           {"camera", "arm"}, {"arm", "camera"}, {"arm", "finger"}, {"second", "camera"}}) {
    SCOPED_TRACE(sensors[0] + " and " + sensors[1]);
    expect_products_of_rows<S>(sensors, test::all_free(table));
    expect_products_of_rows<S>(sensors, test::all_free(table), 2);  // features two and three
    expect_products_of_rows<S>(sensors, test::free_of(table, {"wrist", "second_cy", "camera_fx"}));
    expect_products_of_rows<S>(sensors, test::free_of(table, {"elbow"}));
  }
}

TEST(DifferenceMoments, AreTheProductsOfRowsOfDoubles) {
  check_sensors<double>();
}

TEST(DifferenceMoments, AreTheProductsOfRowsOfPackets) {
  check_sensors<Packet>();
}

}  // namespace
}  // namespace kinecal
