// Gravity as an accelerometer reads it while an arm stands still, from bags.
#include "kinecal/files/recordings/accelerometer_messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/files/recordings/read_recording.hpp"
#include "support/imu_arm.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using test::SimulatedImu;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class GravityBag : public test::FolderTest {
 protected:
  std::vector<Sample> read(const SimulatedImu& imu) {
    const std::string path = (folder_ / "arm.bag").string();
    imu.write(path);
    return read_recording(path, found_).samples;
  }
  Diagnostics found_;
};

TEST_F(GravityBag, EachRestIsASample) {
  const std::vector<Sample> samples = read({});
  ASSERT_THAT(found_.errors, IsEmpty());
  EXPECT_THAT(found_.doubts, IsEmpty());
  EXPECT_THAT(found_.notes,
              Contains(HasSubstr("'wrist/imu' is used, which turns most, not 'base/imu'")));
  ASSERT_EQ(samples.size(), static_cast<std::size_t>(SimulatedImu::kPoses));
  const RuntimeChain chain = make_chain(test::imu_arm(), "base_link", "imu_link");
  for (int n = 0; n < SimulatedImu::kPoses; ++n) {
    const Sample& sample = samples[static_cast<std::size_t>(n)];
    EXPECT_NEAR(sample.position("lift").value(), SimulatedImu::pose(n)[1], 2e-3);
    EXPECT_EQ(sample.observation(kAccelerometer)->features.at(0).frame, "imu_link");
    const Pose<double> base_T_imu = forward_kinematics(
        chain, [&](const std::string& joint) { return sample.position(joint).value(); });
    const Vector3<double> up = base_T_imu.rotation.transpose() * Vector3<double>(0, 0, 9.81);
    // 9.81 m/s^2 times a tilt of 3 mrad.
    EXPECT_NEAR(sample.conditions.at("ax"), up.x(), 0.03);
    EXPECT_NEAR(sample.conditions.at("az"), up.z(), 0.03);
  }
}

TEST_F(GravityBag, AnArmThatNeverRestsIsAnError) {
  (void)read({.rests = false});
  EXPECT_THAT(found_.errors, ElementsAre(HasSubstr("('pan', ...) never stand still")));
}

TEST_F(GravityBag, AMessageThatIsPublishedOnceHidesNoRest) {
  EXPECT_EQ(read({.has_latched_joint = true}).size(),
            static_cast<std::size_t>(SimulatedImu::kPoses));
  EXPECT_THAT(found_.errors, IsEmpty());
}

TEST_F(GravityBag, ReadingsWithoutGravityAreADoubt) {
  (void)read({.acceleration = 0.001 * Matrix3<double>::Identity()});
  EXPECT_THAT(found_.doubts, Contains(HasSubstr("its driver takes gravity off")));
  found_ = {};
  (void)read({.acceleration = Matrix3<double>::Identity() / 9.81});
  EXPECT_THAT(found_.doubts, Contains(HasSubstr("reads 1 m/s^2 at rest, not 9.81: in g?")));
}

}  // namespace
}  // namespace kinecal
