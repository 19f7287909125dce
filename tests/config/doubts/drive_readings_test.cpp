// Readings of a base that cannot be right.
#include "kinecal/config/doubts/drive_readings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "kinecal/config/complete_samples.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/study/simulated_base.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Of a drive whose samples are changed.
std::vector<std::string> errors_of(const std::function<void(Sample&, int)>& change) {
  Diagnostics found;
  const Config config = parse_config(
      "base_link: base_link\nmodels: []\nfree_params: [imu_bias]\nerror_blocks:\n"
      "- {name: base, type: differential_to_pose}\n- {name: imu, type: gyro_to_pose}\n",
      "base.yaml", found);
  std::vector<Sample> samples = simulate_base(SimulatedBase{}, all_runs(), 1).samples;
  for (int i = 0; i < static_cast<int>(samples.size()); ++i) {
    change(samples[static_cast<std::size_t>(i)], i);
  }
  complete_samples(config, samples);
  detail::check_drive_readings(config, samples, found);
  return found.errors;
}
std::vector<std::string> with_times(const std::function<double(double, int)>& time) {
  return errors_of([&](Sample& sample, int i) {
    sample.conditions["time"] = time(sample.conditions["time"], i);
  });
}

TEST(DriveReadings, ThoseOfADriveAreRight) {
  EXPECT_THAT(errors_of([](Sample&, int) {}), IsEmpty());
}

TEST(DriveReadings, OnesThatNeverChangeAreNamed) {
  const auto stuck = [](const std::string& name) {
    return errors_of([&](Sample& sample, int) { sample.conditions[name] = 0.5; });
  };
  EXPECT_THAT(stuck("left_wheel"), ElementsAre(HasSubstr("'left_wheel' is the same in all")));
  EXPECT_THAT(stuck("gyro_yaw"), ElementsAre(HasSubstr("'gyro_yaw' is the same in all")));
  EXPECT_THAT(errors_of([](Sample& sample, int) {
                for (auto& [name, value] : sample.conditions) value = name == kRun ? 1.0 : 0.0;
                sample.conditions["time"] = 0.0;
              }),
              ElementsAre(HasSubstr("'time' does not change")))
      << "nothing moves: nothing is stuck";
}

TEST(DriveReadings, TimesAreSecondsAndGrow) {
  EXPECT_THAT(with_times([](double time, int) { return 1e3 * time; }),
              ElementsAre(HasSubstr("is it in milliseconds?")));
  EXPECT_THAT(with_times([](double time, int) { return 1e9 * time; }),
              ElementsAre(HasSubstr("is it in nanoseconds?")));
  EXPECT_THAT(with_times([](double time, int) { return -time; }),
              ElementsAre(HasSubstr("'time' goes back")));
  EXPECT_THAT(with_times([](double, int) { return 7.0; }),
              ElementsAre(HasSubstr("'time' does not change in")));
}

}  // namespace
}  // namespace kinecal
