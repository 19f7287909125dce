// Mistakes in measured poses are named: each is made, and undoing it explains the residuals.
#include "kinecal/explain/pose_suspects.ipp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "kinecal/config/read_config.hpp"
#include "kinecal/explain/explain_fit.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "support/hand_eye_poses.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const char* const kUrdf = R"(<robot name="hand_eye"><link name="base_link"/><link name="flange"/>
  <joint name="flange_joint" type="floating"><parent link="base_link"/><child link="flange"/></joint>
  <link name="camera"/>
  <joint name="camera_joint" type="fixed"><parent link="flange"/><child link="camera"/></joint></robot>)";

const char* const kConfig = R"(base_link: base_link
models:
 - {name: board, type: chain3d, frame: base_link}
 - {name: camera, type: chain3d, frame: camera}
free_frames:
 - {name: camera_joint, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}
 - {name: target, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}
error_blocks:
 - {name: corners, type: chain3d_to_chain3d, model_a: board, model_b: camera}
)";

/// A camera on the hand that measures the corners of a board in space.
std::vector<Sample> samples_of(const test::HandEyePoses& poses) {
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < poses.flange.size(); ++i) {
    Sample& sample = samples.emplace_back();
    sample.poses["flange_joint"] = poses.flange[i];
    sample.observations = {{"board", {}, {}}, {"camera", {}, {}}};
    for (const Vector3<double>& corner :
         {Vector3<double>(0, 0, 0), {0.3, 0, 0}, {0, 0.2, 0}, {0.3, 0.2, 0}}) {
      sample.observations[0].features.push_back({"target", corner});
      sample.observations[1].features.push_back({"camera", poses.object[i] * corner});
    }
  }
  return samples;
}

std::string cause_of(const std::vector<Sample>& samples) {
  Diagnostics diagnostics;
  const Config config = parse_config(kConfig, "c.yaml", diagnostics);
  diagnostics.throw_if_errors();
  return explain_fit(config, parse_urdf(kUrdf, "hand_eye.urdf"), samples).cause;
}

/// Makes the poses with which undoing a hypothesis gives the right ones.
TEST(PoseSuspects, NameTheirMistakes) {
  const std::vector<Sample> right = samples_of(test::HandEyePoses(true, 8, 5));
  EXPECT_THAT(cause_of(right), IsEmpty());
  using P = Pose<double>;
  using Q = Eigen::Quaterniond;
  const auto made = [&](const auto& mistake) {
    std::vector<Sample> samples = right;
    for (Sample& sample : samples) {
      P& pose = sample.poses.at("flange_joint");
      pose = mistake(pose);
    }
    return cause_of(samples);
  };
  EXPECT_THAT(made([](const P& p) { return p.inverse(); }), HasSubstr("inverted"));
  EXPECT_THAT(made([](const P& p) {
                return P{p.rotation.transpose(), p.translation};
              }),
              HasSubstr("with rotations transposed"));
  EXPECT_THAT(made([](const P& p) {
                const Q q(p.rotation);
                return P{Q(q.z(), q.w(), q.x(), q.y()).toRotationMatrix(), p.translation};
              }),
              HasSubstr("read as w x y z in place of x y z w"));
  EXPECT_THAT(made([](const P& p) {
                const Q q(p.rotation);
                return P{Q(q.x(), q.y(), q.z(), q.w()).toRotationMatrix(), p.translation};
              }),
              HasSubstr("read as x y z w in place of w x y z"));
  EXPECT_THAT(made([](const P& p) {
                const Vector3<double> rpy = rpy_from_rotation(p.rotation);
                return P{rotation_from_rpy({rpy.z(), rpy.y(), rpy.x()}), p.translation};
              }),
              HasSubstr("in the order yaw, pitch, roll"));
  EXPECT_THAT(made([](const P& p) {
                return P{p.rotation, 0.01 * p.translation};
              }),
              HasSubstr("positions multiplied by 100"));
}

TEST(PoseSuspects, NamePosesOfAnotherRow) {
  std::vector<Sample> samples = samples_of(test::HandEyePoses(true, 8, 5));
  const std::vector<Sample> right = samples;
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) samples[i].poses = right[i + 1].poses;
  EXPECT_THAT(cause_of(samples), HasSubstr("of the sample before"));
}

/// A target that somebody holds has no measured poses.
TEST(PoseSuspects, LeaveFittedPosesAlone) {
  Config config;
  Sample sample;
  sample.poses = {{"flange_joint", {}}, {"board", {}}};
  config.per_sample = {{"board", {}}};
  EXPECT_THAT(detail::measured_poses(config, {&sample, 1}), testing::ElementsAre("flange_joint"));
}

}  // namespace
}  // namespace kinecal
