#include "kinecal/report/scene_clouds.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "kinecal/files/messages/make.hpp"
#include "kinecal/files/recordings/bag_output.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

/// A cloud of one row: x grows by a millimetre from point to point, every tenth point is missing.
MessageFields cloud(const std::string& bytes, std::string_view frame) {
  using detail::fields;
  MessageValue::List xyz;
  std::int64_t offset = 0;
  for (const std::string_view name : {"x", "y", "z"}) {
    xyz.emplace_back(fields("name", name, "offset", offset, "datatype", std::int64_t{7}, "count",
                            std::int64_t{1}));
    offset += 4;
  }
  const auto points = static_cast<std::int64_t>(bytes.size() / 12);
  return fields("header", fields("frame_id", frame), "height", std::int64_t{1}, "width", points,
                "fields", std::move(xyz), "point_step", std::int64_t{12}, "row_step", 12 * points,
                "data", std::as_bytes(std::span(bytes)));
}

std::string points(int count) {
  std::string bytes(static_cast<std::size_t>(count) * 12, '\0');
  for (int i = 0; i < count; ++i) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float point[] = {i % 10 == 9 ? nan : 0.001F * static_cast<float>(i), 0.5F, 1.0F};
    std::memcpy(bytes.data() + 12 * static_cast<std::size_t>(i), point, sizeof point);
  }
  return bytes;
}

class SceneClouds : public test::FolderTest {
 protected:
  /// Three samples: with a cloud of the camera, of an unknown frame, and without one.
  [[nodiscard]] std::string record(Encoding encoding, int count) const {
    using detail::fields;
    const std::string path = (folder_ / "samples.bag").string(), bytes = points(count);
    BagOutput bag(path, encoding);
    const BagTopic topic{"calibration_data", "robot_calibration_msgs/CalibrationData", {}, {}, {}};
    for (const std::string_view frame : {"camera_link", "elsewhere", ""}) {
      MessageFields seen = fields("sensor_name", std::string_view("camera"));
      if (!frame.empty()) seen.fields.emplace_back("cloud", cloud(bytes, frame));
      MessageValue::List observations;
      observations.emplace_back(std::move(seen));
      bag.write(topic, 1, fields("observations", std::move(observations)));
    }
    bag.finish();
    return path;
  }
  /// A scene of these samples.
  [[nodiscard]] static RobotScene scene(const std::string& path) {
    RobotScene of;
    of.links = {{"base_link"}, {"camera_link"}};
    for (int number : {1, 2, 3}) {
      SceneSample& sample = of.samples.emplace_back();
      sample.number = number;
      sample.source = path + ":" + std::to_string(number);
    }
    return of;
  }
};

TEST_F(SceneClouds, AreThoseOfTheSamplesInTheirLinks) {
  for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
    const std::string path = record(encoding, 20);
    RobotScene of = scene(path);
    add_clouds({path}, of);
    ASSERT_EQ(of.samples[0].cloud.size(), 18u * 3u) << "two of twenty points are missing";
    EXPECT_EQ(of.samples[0].cloud_link, 1);
    EXPECT_FLOAT_EQ(of.samples[0].cloud[3 * 9], 0.010F) << "the tenth one is missing";
    EXPECT_FLOAT_EQ(of.samples[0].cloud[3 * 9 + 2], 1.0F);
    EXPECT_TRUE(of.samples[1].cloud.empty()) << "its frame is no link";
    EXPECT_TRUE(of.samples[2].cloud.empty());
  }
}

TEST_F(SceneClouds, AreThinnedEvenly) {
  const std::string path = record(Encoding::ros1, 20'000);
  RobotScene of = scene(path);
  add_clouds({path}, of);
  ASSERT_EQ(of.samples[0].cloud.size(), 5'000u * 3u);
  EXPECT_LT(of.samples[0].cloud.front(), 0.01F);
  EXPECT_GT(of.samples[0].cloud[3 * 4'999], 19.98F);
  RobotScene none;
  add_clouds({path, (folder_ / "missing.bag").string()}, none);
  EXPECT_TRUE(none.samples.empty());
}

}  // namespace
}  // namespace kinecal
