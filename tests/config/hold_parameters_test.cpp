// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/hold_parameters.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Config config() {
  Config config;
  config.place = {"c.yaml", 0};
  for (const char* name : {"first", "second"}) {
    StepConfig step;
    step.name = name;
    step.free_params = {{"elbow", {"c.yaml", 3}}, {"wrist", {"c.yaml", 4}}};
    step.free_frames = {
        {.name = "tool", .axes = {true, true, false, false, false, true}, .place = {"c.yaml", 5}}};
    step.bounds = {{"elbow", -0.1, 0.1, {"c.yaml", 6}}};
    config.steps.push_back(step);
  }
  return config;
}

std::vector<std::string> free_names(const StepConfig& step) {
  std::vector<std::string> names;
  for (const FreeParamConfig& parameter : free_parameters(step)) names.push_back(parameter.name);
  return names;
}

TEST(HoldParameters, HoldsJointsAndAxesOfFramesInAllSteps) {
  Config held = config();
  Diagnostics diagnostics;
  hold_parameters(held, {"elbow", "tool_y"}, diagnostics);
  EXPECT_TRUE(diagnostics.errors.empty());
  for (const StepConfig& step : held.steps) {
    EXPECT_THAT(free_names(step), ElementsAre("wrist", "tool_x", "tool_c"));
    EXPECT_TRUE(step.bounds.empty()) << "a bound of a parameter that is not free";
  }
}

TEST(HoldParameters, HoldsAFrameByItsName) {
  Config held = config();
  held.steps[0].bounds.push_back({"tool_x", -0.1, 0.1, {"c.yaml", 7}});
  Diagnostics diagnostics;
  hold_parameters(held, {"tool"}, diagnostics);
  EXPECT_TRUE(diagnostics.errors.empty());
  for (const StepConfig& step : held.steps) {
    EXPECT_THAT(free_names(step), ElementsAre("elbow", "wrist"));
    EXPECT_EQ(step.bounds.size(), 1u);
  }
}

TEST(HoldParameters, RefusesNamesThatNoStepFrees) {
  Config held = config();
  Diagnostics diagnostics;
  hold_parameters(held, {"elbwo", "tool_z"}, diagnostics);
  ASSERT_EQ(diagnostics.errors.size(), 2U);
  EXPECT_THAT(diagnostics.errors[0],
              HasSubstr("c.yaml: --hold elbwo: no step frees it; did you mean 'elbow'?"));
  EXPECT_THAT(diagnostics.errors[1], HasSubstr("--hold tool_z: no step frees it"));
  EXPECT_THAT(free_names(held.steps[0]),
              ElementsAre("elbow", "wrist", "tool_x", "tool_y", "tool_c"));
}

}  // namespace
}  // namespace kinecal
