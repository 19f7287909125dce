// Where the calibration of a magnetometer begins.
#include "kinecal/config/magnetometer_start.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "kinecal/config/read_config.hpp"
#include "kinecal/errors/magnetic_field.hpp"
#include "support/magnetometer.hpp"

namespace kinecal {
namespace {

using test::SimulatedMagnetometer;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Config config_of(const std::string& more, Diagnostics& found) {
  return parse_config(
      "base_link: base_link\nmodels: []\nfree_params: [mag_bias_x]\nerror_blocks:\n"
      "- {name: mag, type: magnetic_field" +
          more + "}\n",
      "mag.yaml", found);
}

std::map<std::string, double> begun(std::vector<Sample> samples, Diagnostics& found,
                                    const std::string& more = "") {
  Config config = config_of(more, found);
  begin_magnetometer(config, samples, found);
  return config.steps.at(0).error_blocks.at(0).numbers;
}

TEST(MagnetometerStart, IsTheBiasAndTheFieldWithoutSoftIron) {
  Diagnostics found;
  const SimulatedMagnetometer of{.noise = 0.0, .all_ways = true};
  const auto numbers = begun(of.samples(100, 1), found);
  EXPECT_THAT(found.errors, IsEmpty());
  EXPECT_THAT(found.notes, IsEmpty());
  EXPECT_NEAR(numbers.at("bias_x"), of.bias.x(), 1e-9);
  EXPECT_NEAR(numbers.at("bias_y"), of.bias.y(), 1e-9);
  EXPECT_NEAR(numbers.at("bias_z"), of.bias.z(), 1e-9);
  EXPECT_NEAR(numbers.at("field"), of.earth.norm(), 1e-9);
}

TEST(MagnetometerStart, LeavesWhatIsGiven) {
  Diagnostics found;
  const auto numbers = begun(SimulatedMagnetometer{.all_ways = true}.samples(100, 1), found,
                             ", bias_x: 3.0, field: 48.0");
  EXPECT_EQ(numbers.at("bias_x"), 3.0);
  EXPECT_EQ(numbers.at("bias_y"), 0.0);
  EXPECT_EQ(numbers.at("field"), 48.0);
}

/// Also where it is what the field would be without.
TEST(MagnetometerStart, LeavesAFieldThatIsGivenAsTheDefault) {
  Diagnostics found;
  const double usual = MagneticField::kParameters.back().initial;
  const auto numbers = begun(SimulatedMagnetometer{.all_ways = true}.samples(100, 1), found,
                             ", field: " + std::to_string(usual));
  EXPECT_EQ(numbers.at("field"), usual);
}

/// A base turns about one axis, and the sensor may be tilted on it.
TEST(MagnetometerStart, PutsATurnIntoItsPlane) {
  const SimulatedMagnetometer of{.mount = {0.3, -0.2, 0.0}};
  constexpr int kCount = 200;
  std::vector<Sample> samples = of.samples(kCount, 1);
  const auto plane = plane_of_readings(samples);
  ASSERT_TRUE(plane);
  // Of the root of a mean of squares: four standard deviations.
  EXPECT_NEAR(plane->beside, of.noise, 4.0 * of.noise / std::sqrt(2.0 * kCount));
  const Vector3<double> axis = exp(of.mount).transpose() * Vector3<double>(0, 0, 1);
  // It is tilted about two axes, each known to the noise over the radius of the circle and the root of half the readings.
  const double tilt = 4.0 * of.noise / of.earth.head<2>().norm() / std::sqrt(0.5 * kCount);
  EXPECT_NEAR(std::abs(plane->normal.dot(axis)), 1.0, tilt * tilt);
  Diagnostics found;
  Config config = config_of("", found);
  begin_magnetometer(config, samples, found);
  ASSERT_EQ(found.notes.size(), 1u);
  EXPECT_THAT(found.notes[0], HasSubstr("it turned about one axis"));
  EXPECT_LT(plane_of_readings(samples)->beside, 1e-6);
}

TEST(MagnetometerStart, IsRefusedWhereNothingTurned) {
  Diagnostics found;
  (void)begun(SimulatedMagnetometer{.earth = {0, 0, 0}, .noise = 0.0}.samples(20, 1), found);
  EXPECT_THAT(found.errors, ElementsAre(HasSubstr("all the same; record while it turns")));
}

TEST(MagnetometerStart, ReadingsInAnotherUnitAreNamed) {
  const auto found_of = [](double factor, bool all_ways) {
    Diagnostics found;
    std::vector<Sample> samples = SimulatedMagnetometer{.all_ways = all_ways}.samples(100, 1);
    for (Sample& sample : samples) {
      for (const char* name : {"mag_x", "mag_y", "mag_z"}) sample.conditions[name] *= factor;
    }
    (void)begun(std::move(samples), found);
    return found;
  };
  for (const bool all_ways : {true, false}) {
    EXPECT_THAT(found_of(1.0, all_ways).errors, IsEmpty());
    EXPECT_THAT(found_of(1.0, all_ways).doubts, IsEmpty());
    for (const auto& [factor, text] :
         {std::pair(1e-2, "are the readings gauss?  Multiply them by 100"),
          {1e-6, "are the readings tesla?  Multiply them by 1e+06"},
          {1e3, "are the readings nanotesla?  Multiply them by 0.001"},
          {1e6, "a driver that publishes them as tesla"}}) {
      EXPECT_THAT(found_of(factor, all_ways).errors, ElementsAre(HasSubstr(text))) << factor;
    }
  }
  EXPECT_THAT(found_of(2e4, true).errors,
              ElementsAre(HasSubstr("are the readings counts of the sensor?")));
  EXPECT_THAT(found_of(2.0, true).doubts, ElementsAre(HasSubstr("the earth's is 22 to 67")));
}

TEST(MagnetometerStart, AFieldBesideAllGainsIsAnError) {
  const auto errors = [](const std::vector<Sample>& of, const std::string& free) {
    Diagnostics found;
    Config config = parse_config("base_link: base_link\nmodels: []\nfree_params: [" + free +
                                     "]\nerror_blocks:\n- {name: mag, type: magnetic_field}\n",
                                 "mag.yaml", found);
    std::vector<Sample> samples = of;
    begin_magnetometer(config, samples, found);
    return found.errors;
  };
  const std::vector<Sample> turn = SimulatedMagnetometer{}.samples(50, 1),
                            all = SimulatedMagnetometer{.all_ways = true}.samples(50, 1);
  EXPECT_THAT(errors(all, "mag_xx, mag_yy, mag_field"), IsEmpty());
  EXPECT_THAT(errors(all, "mag_xx, mag_yy, mag_zz"), IsEmpty());
  EXPECT_THAT(errors(all, "mag_xx, mag_yy, mag_zz, mag_field"),
              ElementsAre(HasSubstr("hold 'mag_zz'")));
  EXPECT_THAT(errors(turn, "mag_xx, mag_field"), IsEmpty());
  EXPECT_THAT(errors(turn, "mag_xx, mag_yy, mag_field"), ElementsAre(HasSubstr("hold 'mag_yy'")));
}

TEST(MagnetometerStart, LeavesOtherConfigurationsAlone) {
  Diagnostics found;
  Config config = parse_config(
      "base_link: base_link\nmodels: []\nfree_params: [imu_scale]\nerror_blocks:\n"
      "- {name: imu, type: gyro_to_wall}\n",
      "base.yaml", found);
  std::vector<Sample> samples = SimulatedMagnetometer{}.samples(50, 1);
  const double before = samples[3].conditions.at("mag_z");
  begin_magnetometer(config, samples, found);
  EXPECT_EQ(samples[3].conditions.at("mag_z"), before);
}

}  // namespace
}  // namespace kinecal
