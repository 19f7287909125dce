#include "kinecal/evaluation/sums/point_wrenches.hpp"

#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "support/blocks.hpp"
#include "support/sums.hpp"

namespace kinecal {
namespace {

/// Moments against the products of rows that jets made: the same normal equations.
/// @param first  the features from this one on
/// @param all_count  false: the features of the first lane have weight zero
template <class S>
void expect_products_of_rows(const std::vector<std::string>& sensors, const FreeSet& free,
                             std::size_t first = 0, bool all_count = true) {
  BasicProblem<S> problem = test::wide_problem<S>();
  problem.add_block("b", PointToPoint{}, sensors, {});
  const auto x = test::random_values(problem.table(), 0.05, 3);
  for (const Sample& s : test::wide_samples(problem, x, 2 * kLanes<S> + 1)) problem.add_sample(s);
  using Rows = detail::BlockRows<test::HiddenDifference, S>;
  int packs = 0;
  Evaluator<S>(problem, free).for_each_term(x, true, [&](int, auto&, const auto& views, auto) {
    ++packs;
    const auto run = std::find_if(
        views.runs.begin(), views.runs.end(),
        [&](const detail::FeatureRun& r) { return r.first <= first && first < r.end; });
    ASSERT_NE(run, views.runs.end());
    const detail::BodyChains& chains = run->chains;
    const std::array twists = {&views[0].twists(chains[0]), &views[1].twists(chains[1])};
    detail::FeatureWrenches<S> general;
    general.start(twists, views.num_own());
    std::vector<S> weights;
    std::vector<Vector3<S>> residuals;
    for (std::size_t i = first; i < run->end; ++i) {
      weights.push_back(views[0].points()[i].x() + S(2.0));  // another one in each lane
      if (!all_count) set_lane(weights.back(), 0, 0.0);
      typename Rows::Rows rows;
      Rows::template rows<true>(test::HiddenDifference{}, views, i, Linearization::measured, rows);
      general.add(rows, weights.back());
      residuals.push_back(rows.residual);
    }
    general.finish();
    detail::LocalSums<S> of_rows(run->columns), of_moments(run->columns);
    of_rows.add(general);
    typename detail::PointWrenches<S>::Sides sides;
    for (std::size_t s = 0; s < 2; ++s) {
      sides[s] = {views[s].values(first), views[s].changes(first), views[s].own().free.size(),
                  twists[s]};
    }
    detail::PointWrenches<S> of_points;
    of_points.set(sides, weights, residuals);
    of_moments.add(of_points);
    NormalEquations expected(free.size()), found(free.size());
    of_rows.add_to(expected);
    of_moments.add_to(found);
    // Some features, their points a metre or two from the base, their weights up to four.
    constexpr double kRounding = 1e-12;
    EXPECT_TRUE(found.hessian.allFinite() && found.gradient.allFinite());
    EXPECT_TRUE(expected.hessian.norm() > 0.0 || !all_count);
    EXPECT_LE((found.hessian - expected.hessian).cwiseAbs().maxCoeff(), kRounding);
    EXPECT_LE((found.gradient - expected.gradient).cwiseAbs().maxCoeff(), kRounding);
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
    expect_products_of_rows<S>(sensors, test::all_free(table), 3);  // one feature, its own center
    expect_products_of_rows<S>(sensors, test::all_free(table), 0, false);
    expect_products_of_rows<S>(
        sensors, test::free_of(table, {"wrist", "elbow", "second_cy", "camera_fx", "second_fx"}));
    expect_products_of_rows<S>(sensors, test::free_of(table, {"elbow", "wrist"}));
  }
}

TEST(PointWrenches, IsThatOfRowsOfDoubles) {
  check_sensors<double>();
}

TEST(PointWrenches, IsThatOfRowsOfPackets) {
  check_sensors<Packet>();
}

}  // namespace
}  // namespace kinecal
