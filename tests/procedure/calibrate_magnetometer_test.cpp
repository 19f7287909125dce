// Hard and soft iron of a magnetometer by a configuration, with the verdict that other calibrations have.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "kinecal/config/read_config.hpp"
#include "kinecal/files/results/magnetometer_file.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "kinecal/tools/init/magnetometer_config.hpp"
#include "support/magnetometer.hpp"
#include "support/repetitions.hpp"
#include "support/robots.hpp"

namespace kinecal {
namespace {

using test::SimulatedMagnetometer;
using testing::HasSubstr;
using testing::IsEmpty;

/// Bias and field as magnetometer_calibration of robot_calibration finds them: the least squares of
/// |m - b| - F from the mean of the readings and the same field, without what it says of them.
Eigen::Vector4d upstreams_hard_iron(const std::vector<Sample>& samples) {
  Eigen::Vector4d x = Eigen::Vector4d::Zero();
  const auto reading = [](const Sample& sample) {
    return Eigen::Vector3d(sample.conditions.at("mag_x"), sample.conditions.at("mag_y"),
                           sample.conditions.at("mag_z"));
  };
  for (const Sample& sample : samples)
    x.head<3>() += reading(sample) / static_cast<double>(samples.size());
  x(3) = 45.0;
  constexpr int kIterations = 200;
  for (int i = 0; i < kIterations; ++i) {
    Eigen::Matrix4d square = 1e-9 * Eigen::Matrix4d::Identity();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    for (const Sample& sample : samples) {
      const Eigen::Vector3d left = reading(sample) - x.head<3>();
      Eigen::Vector4d row;
      row << -left / left.norm(), -1.0;
      square += row * row.transpose();
      right += row * (left.norm() - x(3));
    }
    x -= square.ldlt().solve(right);
  }
  return x;
}

/// As init configures it.
CalibratedRobot calibrated_from(const std::vector<Sample>& samples) {
  Diagnostics found;
  CalibrationSetup setup{
      .robot = test::mobile_manipulator(),
      .config = parse_config(magnetometer_config("base_link", samples), "mag.yaml", found)};
  EXPECT_THAT(found.errors, IsEmpty());
  setup.samples = samples;
  return calibrate_robot(std::move(setup));
}

double value_of(const CalibratedRobot& of, const std::string& name) {
  return of.result.table["mag_" + name].value;
}
double deviation_of(const CalibratedRobot& of, const std::string& name) {
  return of.deviation(of.result.table.index("mag_" + name)).value_or(INFINITY);
}

TEST(CalibrateMagnetometer, FindsHardAndSoftIron) {
  const SimulatedMagnetometer of = test::with_soft_iron();
  const CalibratedRobot found = calibrated_from(of.samples(200, 3));
  ASSERT_TRUE(found.result.converged);
  EXPECT_EQ(found.judgement.verdict, Grade::good);
  const std::vector<std::pair<std::string, double>> truth = {{"bias_x", of.bias.x()},
                                                             {"bias_y", of.bias.y()},
                                                             {"bias_z", of.bias.z()},
                                                             {"xx", 0.08},
                                                             {"yy", -0.05},
                                                             {"xy", 0.03},
                                                             {"xz", -0.02},
                                                             {"yz", 0.01},
                                                             {"field", of.earth.norm()}};
  for (const auto& [name, value] : truth) {
    EXPECT_NEAR(value_of(found, name), value, 4.0 * deviation_of(found, name)) << name;
    // Better than by one reading: its noise, or of a gain, its noise over the field.
    EXPECT_LT(deviation_of(found, name), name.size() == 2 ? of.noise / of.earth.norm() : of.noise)
        << name;
  }
}

/// As many ± cover the truth as they say.
TEST(CalibrateMagnetometer, IntervalsCover) {
  const SimulatedMagnetometer of = test::with_soft_iron();
  int covered = 0, all = 0;
  for (unsigned seed = 10; seed < 22; ++seed) {
    const CalibratedRobot found = calibrated_from(of.samples(120, seed));
    for (const auto& [name, value] : {std::pair("bias_x", of.bias.x()),
                                      {"bias_y", of.bias.y()},
                                      {"bias_z", of.bias.z()},
                                      {"xx", 0.08},
                                      {"yz", 0.01}}) {
      ++all;
      if (std::abs(value_of(found, name) - value) < 1.96 * deviation_of(found, name)) ++covered;
    }
  }
  constexpr double kTail = 1e-3;  // of fewer by chance
  EXPECT_GE(covered, test::binomial_band(all, 0.95, kTail).least) << "of " << all;
}

/// Upstream's formula agrees on what a turn in place shows, and gives a number for what it does not show.
TEST(CalibrateMagnetometer, ATurnInPlaceShowsTwoComponents) {
  SimulatedMagnetometer of;
  const std::vector<Sample> samples = of.samples(200, 4);
  // A component, if nothing else were free: noise * sqrt(2 / 200), 0.03 uT.  With gains and the field, three times that is
  // allowed, and twice this for an error.
  const double exact = 3.0 * of.noise * std::sqrt(2.0 / 200.0);
  const CalibratedRobot found = calibrated_from(samples);
  ASSERT_TRUE(found.result.converged);
  const Eigen::Vector4d upstreams = upstreams_hard_iron(samples);
  for (const auto& [name, axis] : {std::pair("bias_x", 0), {"bias_y", 1}}) {
    EXPECT_NEAR(value_of(found, name), of.bias(axis), 4.0 * deviation_of(found, name));
    EXPECT_LT(deviation_of(found, name), exact);
    EXPECT_NEAR(upstreams(axis), of.bias(axis), 2.0 * exact);
  }
  EXPECT_FALSE(deviation_of(found, "bias_z") < 1e3) << "held";
  for (const char* shown : {"field", "xx", "xy"})
    EXPECT_LT(deviation_of(found, shown), exact) << shown;
  EXPECT_GT(std::abs(upstreams(2) - of.bias.z()), 10.0 * of.noise) << upstreams.transpose();
  EXPECT_NEAR(value_of(found, "field"), of.earth.head<2>().norm(), 2.0 * exact)
      << "within the plane";
}

/// One reading with a wrong bit is left out, by name.
TEST(CalibrateMagnetometer, ABadReadingIsLeftOut) {
  for (const double bad : {200.0, 3000.0}) {
    std::vector<Sample> samples = test::with_soft_iron().samples(200, 3);
    samples[50].conditions = {{"mag_x", bad}, {"mag_y", -bad}, {"mag_z", bad}};
    const CalibratedRobot found = calibrated_from(samples);
    EXPECT_EQ(found.judgement.verdict, Grade::good) << bad;
    EXPECT_THAT(found.setup.diagnostics.notes, IsEmpty());
    ASSERT_EQ(found.left_out.size(), 1u) << bad;
    EXPECT_EQ(found.left_out[0].source, samples[50].source);
  }
}

/// Under upstream's keys, tesla.
TEST(CalibrateMagnetometer, TheFileHasUpstreamsKeys) {
  CalibratedRobot found = calibrated_from(SimulatedMagnetometer{}.samples(100, 5));
  EXPECT_EQ(found.driver_file, "magnetometer_calibration.yaml");
  ParameterTable& table = found.result.table;
  for (const auto& [name, value] : {std::pair("bias_x", 12.5),
                                    {"bias_y", -8.0},
                                    {"bias_z", 0.25},
                                    {"field", 20.0},
                                    {"xx", 0.5},
                                    {"xy", 0.0}}) {
    table["mag_" + std::string(name)].value = value;
  }
  const int x = table.index("mag_bias_x"), z = table.index("mag_bias_z");
  const std::string text =
      magnetometer_yaml(found.setup.calibration, table, {{x, 0.25}, {z, INFINITY}});
  EXPECT_THAT(text, HasSubstr("mag_bias_x: 1.25e-05  # +- 2.5e-07\n"));
  EXPECT_THAT(text, HasSubstr("mag_bias_y: -8.0e-06  # held\n"));
  EXPECT_THAT(text, HasSubstr("mag_bias_z: 2.5e-07  # not determined\n"));
  EXPECT_THAT(text, HasSubstr("mag_soft_iron: [1.5, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]"));
}

}  // namespace
}  // namespace kinecal
