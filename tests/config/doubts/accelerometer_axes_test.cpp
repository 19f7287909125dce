// Accelerometers and gyroscopes with another sign or other axes.
#include "kinecal/config/doubts/accelerometer_axes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/config/read_config.hpp"
#include "kinecal/files/recordings/accelerometer_messages.hpp"
#include "support/imu_arm.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using test::SimulatedImu;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class AccelerometerAxes : public test::FolderTest {
 protected:
  std::vector<std::string> doubts(const SimulatedImu& imu) {
    const std::string path = (folder_ / "arm.bag").string();
    imu.write(path);
    Diagnostics found, read;
    const std::vector<Sample> samples = read_gravity(path, read);
    const Config config = parse_config(
        "base_link: base_link\nmodels:\n- {name: accelerometer, type: chain6d, frame: " +
            std::string(imu.frame == "imu_link" ? "imu_link" : "three") +
            "}\nfree_params: [lift]\nerror_blocks:\n"
            "- {name: contact, type: gravity_seen, model: accelerometer}\n",
        "gravity.yaml", found);
    EXPECT_THAT(found.errors, IsEmpty());
    detail::check_accelerometer_axes(config, test::imu_arm(), samples, found);
    return found.doubts;
  }
  static Matrix3<double> matrix(double a, double b, double c, double d, double e, double f,
                                double g, double h, double i) {
    Matrix3<double> m;
    m << a, b, c, d, e, f, g, h, i;
    return m;
  }
};

TEST_F(AccelerometerAxes, AreAsTheyShouldBe) {
  EXPECT_THAT(doubts({}), IsEmpty());
  EXPECT_THAT(doubts({.frame = "accelerometer"}), IsEmpty());
}

TEST_F(AccelerometerAxes, WithTheOtherSign) {
  const Matrix3<double> down = -Matrix3<double>::Identity();
  EXPECT_THAT(doubts({.acceleration = down}),
              ElementsAre(HasSubstr("reads gravity with the other sign, compared with link "
                                    "'imu_link'")));
  EXPECT_THAT(doubts({.acceleration = down, .frame = "accelerometer"}),
              ElementsAre(HasSubstr("reads gravity with the other sign (at rest")));
  EXPECT_THAT(doubts({.rate = down}),
              ElementsAre(HasSubstr("the gyroscope beside the accelerometer of model "
                                    "'accelerometer' turns with the other sign")));
}

TEST_F(AccelerometerAxes, ThatAreExchanged) {
  const Matrix3<double> exchanged = matrix(0, 1, 0, 1, 0, 0, 0, 0, 1);
  EXPECT_THAT(doubts({.acceleration = exchanged}),
              ElementsAre(HasSubstr("with other axes: its x reads y, its y reads x,")));
  EXPECT_THAT(doubts({.acceleration = exchanged, .frame = "accelerometer"}),
              ElementsAre(HasSubstr("left-handed")));
  // A rotation is found where the URDF does not have the frame, and named where it has.
  const Matrix3<double> turned = matrix(0, -1, 0, 1, 0, 0, 0, 0, 1);
  EXPECT_THAT(doubts({.acceleration = turned, .frame = "accelerometer"}), IsEmpty());
  EXPECT_THAT(doubts({.acceleration = turned}),
              ElementsAre(HasSubstr("its x reads -y, its y reads x,")));
}

}  // namespace
}  // namespace kinecal
