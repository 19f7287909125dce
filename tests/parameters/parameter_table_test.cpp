#include "kinecal/parameters/parameter_table.hpp"

#include <gtest/gtest.h>

#include "kinecal/parameters/chain_parameters.hpp"
#include "support/robots.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

TEST(ParameterTable, FindsByNameAndNamesTheNearestOne) {
  ParameterTable table;
  table.add({.name = "elbow"});
  table.add({.name = "wrist"});
  EXPECT_EQ(table.index("wrist"), 1);
  EXPECT_EQ(table.find("shoulder"), -1);
  EXPECT_EQ(test::thrown<std::invalid_argument>([&] { (void)table.index("wirst"); }),
            "no parameter 'wirst'; did you mean 'wrist'?");
  EXPECT_THROW(table.add({.name = "elbow"}), std::invalid_argument);
}

TEST(ParameterTable, RefusesNumbersThatCannotBeUsed) {
  ParameterTable table;
  const auto message = [&](const Parameter& parameter) -> std::string {
    return test::thrown<std::invalid_argument>([&] { table.add(parameter); });
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message({.name = "elbow", .lower = 0.2, .upper = -0.1}),
            "parameter 'elbow': its lower bound 0.2 is above its upper bound -0.1");
  EXPECT_EQ(message({.name = "elbow", .upper = nan}), "parameter 'elbow': a bound is not a number");
  EXPECT_EQ(message({.name = "elbow", .initial = nan}),
            "parameter 'elbow': its value is not a finite number");
  EXPECT_EQ(table.size(), 0);
  EXPECT_EQ(message({.name = "elbow", .lower = 0.1, .upper = 0.1}), "nothing was thrown");
}

TEST(FreeSet, GivesColumnsToFreeParametersOnly) {
  const FreeSet free({3, 1}, 5);
  EXPECT_EQ(free.size(), 2);
  EXPECT_EQ(free.column(3), 0);
  EXPECT_EQ(free.column(1), 1);
  EXPECT_EQ(free.column(0), -1);
  EXPECT_EQ(free.column(-1), -1);
  EXPECT_EQ(free.table_size(), 5);
}

TEST(FreeSet, RefusesWhatTheTableDoesNotHaveAndWhatOccursTwice) {
  EXPECT_THROW(FreeSet({5}, 3), std::invalid_argument);
  EXPECT_THROW(FreeSet({-1}, 3), std::invalid_argument);
  EXPECT_THROW(FreeSet({2, 2}, 3), std::invalid_argument);
  EXPECT_EQ(FreeSet({}, 0).size(), 0);
}

TEST(ParameterTable, StartsAtInitialValues) {
  ParameterTable table;
  table.add({.name = "elbow", .initial = 0.25});
  table.add({.name = "wrist", .initial = 0.25, .value = 0.5});
  EXPECT_EQ(table.values(), Eigen::Vector2d(0.25, 0.5));
}

TEST(ChainParameters, AMimicJointMovesWithTheOffsetOfItsDriver) {
  const Robot robot = test::mobile_manipulator();
  const RuntimeChain chain = make_chain(robot, "forearm", "counterweight");
  ParameterTable table;
  table.add({.name = "wrist"});
  const auto indices = chain_parameters(chain, table);
  ASSERT_EQ(indices.size(), 1u);
  EXPECT_EQ(indices[0].offset, 0);
  EXPECT_EQ(indices[0].gain, -0.5);
  const std::vector<double> values = {0.4};
  const auto corrections = corrections_for(indices, std::span<const double>(values));
  EXPECT_DOUBLE_EQ(corrections[0].offset.position, -0.2);
}

TEST(ChainParameters, HeldParametersHaveValuesButNoColumns) {
  const Robot robot = test::mobile_manipulator();
  const RuntimeChain chain = make_chain(robot, "upper_arm", "hand", {"elbow_mount"});
  ParameterTable table;
  for (const char* name : {"elbow", "wrist"}) table.add({.name = name});
  for (auto axis : kFrameAxes) table.add({.name = parameter_name("elbow_mount", axis)});
  const auto indices = chain_parameters(chain, table);
  const auto columns = columns_of(indices, FreeSet({1, 3}, table.size()));
  EXPECT_EQ(indices[0].frame[1], 3);
  EXPECT_EQ(columns[0].frame[1], 1);
  EXPECT_EQ(columns[0].frame[0], -1);
  EXPECT_EQ(columns[1].offset, -1);
  EXPECT_EQ(columns[2].offset, 0);
}

}  // namespace
}  // namespace kinecal
