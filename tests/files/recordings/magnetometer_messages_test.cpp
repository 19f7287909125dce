// Readings of a magnetometer from bags.
#include "kinecal/files/recordings/magnetometer_messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "kinecal/files/messages/make.hpp"
#include "kinecal/files/messages/message_fields.hpp"
#include "kinecal/files/recordings/bag_output.hpp"
#include "kinecal/files/recordings/read_recording.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using detail::fields;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class MagnetometerBag : public testing::Test {
 protected:
  /// A turn of so many readings on a topic, times a unit.
  void write(const std::string& topic, const std::string& type, int count, double unit,
             double rests = 0.0) {
    for (int i = 0; i < count; ++i) {
      const double angle = std::max(0.0, 6.283 * (i - rests * count) / count);
      const MessageFields reading = fields("x", unit * (10.0 + 20.0 * std::cos(angle)), "y",
                                           unit * 20.0 * std::sin(angle), "z", unit * -40.0);
      const std::int64_t time = 1'000'000'000 * (1000 + std::int64_t{i});
      const MessageFields header =
          fields("stamp", detail::time_fields(Stamp(time)), "frame_id", "imu_link");
      bag_.write({topic, type}, time,
                 type == "sensor_msgs/MagneticField"
                     ? fields("header", header, "magnetic_field", reading)
                     : fields("header", header, "vector", reading));
    }
  }
  std::vector<Sample> read() {
    bag_.finish();
    return read_recording(path_, found_).samples;
  }

  test::TemporaryFolder folder_;
  std::string path_ = (folder_.path() / "mag.bag").string();
  BagOutput bag_{path_, Encoding::ros1};
  Diagnostics found_;
};

TEST_F(MagnetometerBag, IsInMicrotesla) {
  write("imu/mag", "sensor_msgs/MagneticField", 40, 1e-6);
  const std::vector<Sample> samples = read();
  EXPECT_THAT(found_.errors, IsEmpty());
  EXPECT_THAT(found_.notes, IsEmpty());
  ASSERT_EQ(samples.size(), 40u);
  EXPECT_NEAR(samples[0].conditions.at("mag_x"), 30.0, 1e-9);
  EXPECT_NEAR(samples[10].conditions.at("mag_y"), 20.0, 1e-3);
  EXPECT_NEAR(samples[10].conditions.at("mag_z"), -40.0, 1e-9);
}

TEST_F(MagnetometerBag, CountsWhatStandsStillOnce) {
  write("imu/mag", "geometry_msgs/Vector3Stamped", 400, 1e-6, 0.5);
  EXPECT_LT(read().size(), 100u);
  EXPECT_THAT(found_.errors, IsEmpty());
}

/// However many there are: a sensor that is turned fast is not averaged over its turn.
TEST_F(MagnetometerBag, DoesNotAverageReadingsThatAreFarApart) {
  for (int turn = 0; turn < 80; ++turn) write("imu/mag", "sensor_msgs/MagneticField", 10, 1e-6);
  EXPECT_EQ(read().size(), 800u);
}

TEST_F(MagnetometerBag, SaysWhichTopicAndWhichUnit) {
  write("gimbal/mag", "geometry_msgs/Vector3Stamped", 40, 0.01);
  write("imu/mag", "geometry_msgs/Vector3Stamped", 40, 0.01);
  write("camera/image_offset", "geometry_msgs/Vector3Stamped", 40, 0.01);
  (void)read();
  EXPECT_THAT(found_.notes,
              ElementsAre(HasSubstr("'imu/mag' is used, not 'gimbal/mag'"),
                          HasSubstr("'imu/mag' is not in tesla: it reads about 0.4")));
}

TEST_F(MagnetometerBag, LeavesOutWhatIsNotANumber) {
  write("imu/mag", "sensor_msgs/MagneticField", 40, 1e-6);
  write("imu/mag", "sensor_msgs/MagneticField", 2, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(read().size(), 40u);
  EXPECT_THAT(found_.notes, ElementsAre(HasSubstr("2 of 42 messages of 'imu/mag'")));
}

}  // namespace
}  // namespace kinecal
