// Gravity and payload.
#include "kinecal/config/doubts/check_weight.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> doubts(const Config& config, const std::vector<Sample>& samples = {}) {
  Diagnostics diagnostics;
  detail::check_weight(config, samples, diagnostics);
  return diagnostics.doubts;
}

TEST(CheckWeight, GravityIsTheEarths) {
  Config config;
  EXPECT_THAT(doubts(config), IsEmpty());
  config.gravity = {0.0, -6.94, -6.94};
  EXPECT_THAT(doubts(config), IsEmpty());
  config.gravity = {0.0, 0.0, -981.0};
  EXPECT_THAT(doubts(config), ElementsAre(HasSubstr("has 981 m/s^2, the earth's is 9.81")));
  config.gravity = {0.0, 0.0, 0.0};
  EXPECT_THAT(doubts(config), ElementsAre(HasSubstr("without it nothing sags")));
}

TEST(CheckWeight, APayloadHasALink) {
  Config config;
  std::vector<Sample> samples(3);
  samples[1].conditions["payload"] = 0.0;
  EXPECT_THAT(doubts(config, samples), IsEmpty());
  samples[2].conditions["payload"] = 1.5;
  EXPECT_THAT(doubts(config, samples), ElementsAre(HasSubstr("give 'payload_link'")));
  config.payload_link = "gripper_link";
  EXPECT_THAT(doubts(config, samples), IsEmpty());
}

}  // namespace
}  // namespace kinecal
