// Samples in bags, as users of the program meet them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "kinecal/files/bags/mcap/read_mcap.hpp"
#include "kinecal/files/bags/mcap/write_mcap.hpp"
#include "kinecal/files/recordings/convert.hpp"
#include "kinecal/files/samples/read_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "support/data.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class RecordingsProgram : public test::ProgramTest {
 protected:
  [[nodiscard]] fs::path synth() const { return test::data_folder() / "fetch/synth"; }

  /// A folder as `ros2 bag record` makes it, with what an MCAP file holds.
  void write_ros2_bag(const std::string& mcap, const std::string& folder) const;
};

void check(int code, sqlite3* database) {
  ASSERT_TRUE(code == SQLITE_OK || code == SQLITE_DONE) << sqlite3_errmsg(database);
}

void RecordingsProgram::write_ros2_bag(const std::string& mcap, const std::string& folder) const {
  fs::create_directory(folder_ / folder);
  write(folder + "/metadata.yaml",
        "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n"
        "  relative_file_paths:\n    - a_0.db3\n");
  sqlite3* database = nullptr;
  check(sqlite3_open((folder_ / folder / "a_0.db3").c_str(), &database), database);
  check(sqlite3_exec(database,
                     "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT,"
                     " serialization_format TEXT, offered_qos_profiles TEXT);"
                     "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER,"
                     " timestamp INTEGER, data BLOB);"
                     "INSERT INTO topics VALUES(1, '/calibration_data',"
                     " 'robot_calibration_msgs/msg/CalibrationData', 'cdr', '');"
                     "INSERT INTO topics VALUES(2, '/robot_description', 'std_msgs/msg/String',"
                     " 'cdr', ''); BEGIN",
                     nullptr, nullptr, nullptr),
        database);
  sqlite3_stmt* insert = nullptr;
  check(
      sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?,?,?)",
                         -1, &insert, nullptr),
      database);
  const auto handle = [&](const BagMessage& message) {
    sqlite3_bind_int(insert, 1, message.topic.name == "robot_description" ? 2 : 1);
    sqlite3_bind_int64(insert, 2, message.time);
    sqlite3_bind_blob64(insert, 3, message.data.data(), message.data.size(), SQLITE_TRANSIENT);
    check(sqlite3_step(insert), database);
    sqlite3_reset(insert);
  };
  Diagnostics diagnostics;
  read_mcap(folder_ / mcap, {[](const BagTopic&) { return true; }, handle}, diagnostics);
  EXPECT_TRUE(diagnostics.errors.empty());
  sqlite3_finalize(insert);
  check(sqlite3_exec(database, "COMMIT", nullptr, nullptr, nullptr), database);
  sqlite3_close(database);
}

TEST_F(RecordingsProgram, CalibrateToTheSameBytesFromAnyFormat) {
  KINECAL_NEEDS_DATA("fetch/synth");
  const std::string bag = synth() / "calibration_data.bag";
  ASSERT_EQ(kinecal("convert " + bag + " a.mcap").code, 0);
  ASSERT_EQ(kinecal("convert a.mcap b.bag").code, 0);
  ASSERT_EQ(kinecal("convert " + bag + " c.yaml").code, 0);
  write_ros2_bag("a.mcap", "ros2");
  const std::string urdf = synth() / "fetch_arm_head.urdf", config = synth() / "calibrate.yaml";
  const std::string yaml = synth() / "samples.yaml";
  int number = 0;
  std::string first, first_urdf;
  for (const std::string& samples :
       {yaml, bag, std::string("a.mcap"), std::string("b.bag"), std::string("c.yaml"),
        std::string("ros2"), std::string("ros2/a_0.db3")}) {
    SCOPED_TRACE(samples);
    const std::string out = "out" + std::to_string(number++);
    const bool is_yaml = samples.ends_with(".yaml");  // has no URDF
    const test::Outcome outcome = kinecal("calibrate --config " + config + " --samples " + samples +
                                          (is_yaml ? " --urdf " + urdf : "") + " --output " + out);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("100 samples"));
    const std::string found = read(out + "/calibration.yaml");
    const std::string found_urdf = read(out + "/calibrated.urdf");
    if (first.empty()) first = found, first_urdf = found_urdf;
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(found, first);
    EXPECT_EQ(found_urdf, first_urdf);
  }
}

/// The samples of the set with a torso that was at rest, and samples of the floor as a robot sees
/// it whose URDF is right; the URDF is Fetch's own.
void write_bag_with_ground(const fs::path& data, const std::string& path) {
  Diagnostics diagnostics;
  std::vector<Sample> samples = read_samples(data / "synth/samples.yaml", diagnostics);
  const Robot robot = read_urdf(data / "fetch.urdf");
  const RuntimeChain camera = make_chain(robot, "base_link", "head_camera_rgb_optical_frame");
  std::vector<Sample> floor;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    Sample& sample = samples[n];
    sample.joint_names.emplace_back("torso_lift_joint");
    sample.joint_positions.push_back(0.1);
    if (n % 4 != 0) continue;
    const auto position = [&](const std::string& joint) { return *sample.position(joint); };
    const Pose<double> camera_T_base = forward_kinematics(camera, position).inverse();
    Sample& ground = floor.emplace_back(sample);
    ground.observations = {*sample.observation("camera")};
    ground.observations[0].features.clear();
    for (int i = 0; i < 6; ++i) {
      const Vector3<double> on_floor(1.0 + 0.2 * i, 0.3 * (i % 3) - 0.3, 0.0);
      const Vector3<double> p = camera_T_base * on_floor;
      if (p.z() < 0.3) continue;
      ground.observations[0].features.push_back({"head_camera_rgb_optical_frame", p});
    }
    if (ground.observations[0].features.empty()) floor.pop_back();
  }
  samples.insert(samples.end(), floor.begin(), floor.end());
  BagOutput bag(path, Encoding::ros1);
  write_samples(bag, samples);
  write_urdf(bag, read_urdf_text(data / "fetch.urdf"));
  bag.finish();
}

TEST_F(RecordingsProgram, AreDropInForFetchsOwnFiles) {
  KINECAL_NEEDS_DATA("fetch/synth");
  const fs::path data = test::data_folder() / "fetch";
  write_bag_with_ground(data, folder_ / "ground.bag");
  const std::pair<std::string, std::string> calls[] = {
      {"calibrate.yaml", synth() / "calibration_data.bag"},
      {"calibrate_with_ground.yaml", "ground.bag"}};
  for (const auto& [config, bag] : calls) {
    SCOPED_TRACE(config);
    fs::remove_all(folder_ / "out");
    const test::Outcome outcome = kinecal("calibrate --config " + (data / config).string() +
                                          " --samples " + bag + " --output out --upstream-names");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    std::string calibration;
    for (const auto& file : fs::directory_iterator(folder_ / "out")) {
      const std::string name = file.path().filename();
      if (name.starts_with("calibration_")) calibration = read("out/" + name);
    }
    for (const char* key : {"camera_z_offset: ", "camera_z_scaling: ", "depth_info: depth_",
                            "rgb_info: rgb_", "urdf: calibrated_"}) {
      EXPECT_THAT(calibration, HasSubstr(key));
    }
  }
}

TEST_F(RecordingsProgram, AreInspectedTopicByTopic) {
  KINECAL_NEEDS_DATA("fetch/synth");
  const test::Outcome samples = kinecal("inspect " + (synth() / "calibration_data.bag").string());
  EXPECT_EQ(samples.code, 0) << samples.err;
  EXPECT_THAT(samples.out,
              AllOf(HasSubstr("ROS 1 bag"), HasSubstr("robot_calibration_msgs/CalibrationData"),
                    HasSubstr("robot_description"), HasSubstr("100 samples"), HasSubstr("camera")));
  const test::Outcome poses =
      kinecal("inspect " + (test::data_folder() / "fetch/calibration_poses.bag").string());
  EXPECT_EQ(poses.code, 0) << poses.err;
  EXPECT_THAT(poses.out, AllOf(HasSubstr("101 poses to capture"), HasSubstr("elbow_flex_joint")));
}

TEST_F(RecordingsProgram, GivePosesBackAsTheyWere) {
  KINECAL_NEEDS_DATA("fetch");
  const std::string bag = test::data_folder() / "fetch/calibration_poses_ground.bag";
  ASSERT_EQ(kinecal("convert " + bag + " a.yaml").code, 0);
  ASSERT_EQ(kinecal("convert a.yaml b.bag").code, 0);
  ASSERT_EQ(kinecal("convert b.bag c.mcap").code, 0);
  ASSERT_EQ(kinecal("convert c.mcap d.yaml").code, 0);
  EXPECT_EQ(read("a.yaml"), read("d.yaml"));
  EXPECT_THAT(read("a.yaml"), HasSubstr("ground_plane_finder"));
  write("bom.yaml", "\xEF\xBB\xBF" + read("a.yaml"));
  const test::Outcome poses = kinecal("inspect bom.yaml");
  EXPECT_EQ(poses.code, 0) << poses.err;
  EXPECT_THAT(poses.out, AllOf(HasSubstr("130 poses to capture"), HasSubstr("wrist_roll_joint"),
                               testing::ContainsRegex("led_finder +101\n")));
}

TEST_F(RecordingsProgram, WarnOfWhatYamlCannotHold) {
  KINECAL_NEEDS_DATA("fetch/synth");
  const std::string bag = synth() / "calibration_data.bag";
  const test::Outcome converted = kinecal("convert " + bag + " a.yaml");
  EXPECT_EQ(converted.code, 0);
  EXPECT_THAT(converted.err, AllOf(HasSubstr("warning: "), HasSubstr("topic 'robot_description'"),
                                   HasSubstr("is left out: YAML holds only samples")));
  EXPECT_EQ(kinecal("convert " + bag + " a.mcap").err, "");
}

TEST_F(RecordingsProgram, ThatWereCutOffGiveWhatWasWrittenWholeAndAWarning) {
  KINECAL_NEEDS_DATA("fetch/synth");
  fs::copy_file(synth() / "calibration_data.bag", folder_ / "cut.bag");
  fs::permissions(folder_ / "cut.bag", fs::perms::owner_write, fs::perm_options::add);
  fs::resize_file(folder_ / "cut.bag", fs::file_size(folder_ / "cut.bag") / 2);
  const test::Outcome outcome = kinecal("inspect cut.bag");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("warning: cut.bag"));
  EXPECT_THAT(outcome.out, HasSubstr("samples"));
}

TEST_F(RecordingsProgram, WithoutMessagesAreInspected) {
  {
    std::ofstream out(folder_ / "empty.mcap", std::ios::binary);
    McapWriter writer(out);
    writer.close();
  }
  const test::Outcome outcome = kinecal("inspect empty.mcap");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(testing::StartsWith("empty.mcap: "), HasSubstr("no messages\n")));
}

TEST_F(RecordingsProgram, WithMistakesWriteNothing) {
  write("no.bag", "#ROSBAG V2.0\nthis is not one");
  for (const char* call :
       {"convert no.bag out.mcap", "convert no.bag out.yaml", "convert missing.bag out.mcap",
        "convert no.bag out.xyz", "calibrate --config none.yaml --samples no.bag --output out"}) {
    SCOPED_TRACE(call);
    const test::Outcome outcome = kinecal(call);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("error: "));
    for (const char* file : {"out", "out.mcap", "out.yaml", "out.xyz"}) {
      EXPECT_FALSE(fs::exists(folder_ / file)) << file;
    }
  }
}

}  // namespace
}  // namespace kinecal
