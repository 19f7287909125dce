// kinecal calibrate-log of cameras alone: the result of kinecal calibrate, from several files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <sstream>

#include "kinecal/files/samples/write_samples.hpp"
#include "support/camera_rig.hpp"
#include "support/cameras_alone.hpp"
#include "support/processes.hpp"
#include "support/run_program.hpp"
#include "support/wide_camera.hpp"

namespace kinecal {
namespace {

using test::wide_camera_samples;
using testing::AllOf;
using testing::HasSubstr;

constexpr int kAll = 1000;

class CamerasLog : public test::ProgramTest {
 protected:
  CamerasLog() {
    write("all.yaml", wide_camera_samples());
    write("a.yaml", wide_camera_samples(kAll, 0, 12));
    write("b.yaml", wide_camera_samples(kAll, 12, 15));
    write("c.yaml", wide_camera_samples(kAll, 15, 30));
    const std::string models =
        "base_link: camera\nper_sample: [board]\nmodels:\n - {name: board, type: board, frame: "
        "board}\n - {name: camera, type: camera2d, frame: camera, lens: ";
    const std::string blocks =
        "]\nerror_blocks:\n - {name: corners, type: chain3d_to_camera2d, model_3d: board, "
        "model_2d: camera}\n";
    write("given.yaml", models +
                            "fisheye}\nfree_params: [camera_fx, camera_fy, camera_cx, camera_cy, "
                            "camera_k1, camera_k2, camera_k3, camera_k4" +
                            blocks);
    write("auto.yaml", models + "auto}\nfree_params: [board_bend_x, board_bend_y" + blocks);
  }
  [[nodiscard]] test::Outcome log(const std::string& config, const std::string& files,
                                  const std::string& output) const {
    return kinecal("calibrate-log --config " + config + " --samples " + files + " --threads 1" +
                   " --output " + output);
  }
  /// The camera of three files is that of all samples at once, within a part of its +-.
  void expect_same(const std::string& one, const std::string& other) const {
    const YAML::Node report = YAML::Load(read(one + "/report.json")),
                     expected = YAML::Load(read(other + "/report.json"));
    EXPECT_EQ(report["verdict"].as<std::string>(), expected["verdict"].as<std::string>());
    EXPECT_EQ(report["lenses"]["camera"].as<std::string>(),
              expected["lenses"]["camera"].as<std::string>());
    ASSERT_EQ(report["parameters"].size(), expected["parameters"].size());
    for (std::size_t i = 0; i < report["parameters"].size(); ++i) {
      const YAML::Node &of = report["parameters"][i], &all = expected["parameters"][i];
      EXPECT_EQ(of["name"].as<std::string>(), all["name"].as<std::string>());
      // 30 samples show their variance to 1 / sqrt(2 * 30) = 13 %.
      EXPECT_NEAR(of["sigma"].as<double>() / all["sigma"].as<double>(), 1.0, 0.5) << of["name"];
    }
    const YAML::Node &noise = report["noise"][0], &of_all = expected["noise"][0];
    EXPECT_NEAR(noise["sigma"].as<double>(), of_all["sigma"].as<double>(), 1e-6);
    EXPECT_EQ(std::lround(noise["freedom"].as<double>()),
              std::lround(of_all["freedom"].as<double>()));
    // Parameters are relative to where the camera begins; the camera is what counts.
    const YAML::Node camera = YAML::Load(read(one + "/rgb_camera.yaml")),
                     of = YAML::Load(read(other + "/rgb_camera.yaml"));
    EXPECT_EQ(camera["distortion_model"].as<std::string>(),
              of["distortion_model"].as<std::string>());
    for (const char* key : {"camera_matrix", "distortion_coefficients"}) {
      const auto found = camera[key]["data"].as<std::vector<double>>(),
                 truth = of[key]["data"].as<std::vector<double>>();
      ASSERT_EQ(found.size(), truth.size());
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_NEAR(found[i], truth[i], 1e-3 * std::max(1.0, 1e-2 * std::abs(truth[i]))) << key;
      }
    }
  }
};

TEST_F(CamerasLog, FindWhatCalibrateFindsWithAGivenLensAndWithAny) {
  for (const std::string config : {"given", "auto"}) {
    const test::Outcome done = log(config + ".yaml", "a.yaml b.yaml c.yaml", config);
    ASSERT_EQ(done.code, 0) << done.out << done.err;
    EXPECT_THAT(done.out, HasSubstr("30 samples of 3 files"));
    const std::string once = config + "_once";
    ASSERT_EQ(
        kinecal("calibrate --config " + config + ".yaml --samples all.yaml --output " + once).code,
        0);
    expect_same(config, once);
    if (config != "auto") continue;
    const std::size_t note = done.err.find("lens by the error on views held out");
    EXPECT_NE(note, std::string::npos) << done.err;
    EXPECT_EQ(done.err.find("lens by the error", note + 1), std::string::npos) << "once";
  }
}

/// Two cameras on a body; the second one is missing in the second file.
TEST_F(CamerasLog, FindARig) {
  test::Rig rig = test::two_fisheyes(0.1);
  for (std::size_t s = 18; s < 22; ++s) {
    std::erase_if(rig.samples[s].observations,
                  [](const Observation& seen) { return seen.sensor == "right"; });
  }
  const auto write_some = [&](const std::string& file, std::size_t first, std::size_t last) {
    std::ostringstream text;
    write_samples(text, {rig.samples.data() + first, rig.samples.data() + last});
    write(file, text.str());
  };
  write_some("all.yaml", 0, 30);
  write_some("a.yaml", 0, 18);
  write_some("b.yaml", 18, 22);
  write_some("c.yaml", 22, 30);
  write("rig.yaml", test::cameras_config({"left", "right"}, "equidistant", "k1 k2 k3 k4"));
  const test::Outcome done = log("rig.yaml", "a.yaml b.yaml c.yaml", "out");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  const test::Outcome once =
      kinecal("calibrate --config rig.yaml --samples all.yaml --output once");
  ASSERT_EQ(once.code, 0) << once.out << once.err;
  const YAML::Node report = YAML::Load(read("out/report.json")),
                   expected = YAML::Load(read("once/report.json"));
  EXPECT_EQ(report["verdict"].as<std::string>(), expected["verdict"].as<std::string>());
  int frames = 0;
  for (std::size_t i = 0; i < expected["parameters"].size(); ++i) {
    const YAML::Node &of = report["parameters"][i], &all = expected["parameters"][i];
    const std::string name = all["name"].as<std::string>();
    ASSERT_EQ(of["name"].as<std::string>(), name);
    if (name.rfind("right_joint", 0) != 0) continue;
    EXPECT_NEAR(of["value"].as<double>(), all["value"].as<double>(),
                0.05 * all["sigma"].as<double>())
        << name;
    ++frames;
  }
  EXPECT_EQ(frames, 6);
}

TEST_F(CamerasLog, AreTheSameInSeveralProcesses) {
  KINECAL_REQUIRE_MPIRUN();
  ASSERT_EQ(log("given.yaml", "a.yaml b.yaml c.yaml", "one").code, 0);
  const test::Outcome two = run(test::in_processes(
      2, test::kinecal_program() +
             " calibrate-log --config given.yaml --samples a.yaml b.yaml c.yaml --threads 1 "
             "--output two"));
  ASSERT_EQ(two.code, 0) << two.out << two.err;
  EXPECT_EQ(read("one/rgb_camera.yaml"), read("two/rgb_camera.yaml"));
  EXPECT_EQ(read("one/calibration.yaml"), read("two/calibration.yaml"));
}

TEST_F(CamerasLog, AnotherImageSizeInALaterFileIsAnError) {
  write("c.yaml", wide_camera_samples(0, 15, 30));
  const test::Outcome wrong = log("given.yaml", "a.yaml b.yaml c.yaml", "out");
  EXPECT_EQ(wrong.code, 1);
  EXPECT_THAT(wrong.err, HasSubstr("camera 'camera': images of two sizes: 1280x960 at a.yaml:1, "
                                   "640x960 at c.yaml:1"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

/// Three corners in each view of a file say nothing of where the board was: as `calibrate`, the log leaves them out.
TEST_F(CamerasLog, ALaterFileWithoutFourCornersIsNamed) {
  std::string text = wide_camera_samples(kAll, 12, 15);
  for (std::size_t at = 0; (at = text.find("features:\n", at)) != std::string::npos; ++at) {
    std::size_t from = text.find('\n', at) + 1, to = from;
    for (int line = 0; line < 3; ++line) from = text.find('\n', from) + 1;
    for (to = from; text.compare(to, 4, "  - ") == 0;) to = text.find('\n', to) + 1;
    text.erase(from, to - from);
  }
  write("b.yaml", text);
  const test::Outcome none = log("given.yaml", "a.yaml b.yaml c.yaml", "without");
  EXPECT_EQ(none.code, 0) << none.out << none.err;
  EXPECT_THAT(none.err, HasSubstr("note: b.yaml:1: no camera shows where the target was"));
  write("b.yaml", text + wide_camera_samples(kAll, 14, 15));
  const test::Outcome some = log("given.yaml", "a.yaml b.yaml c.yaml", "out");
  EXPECT_EQ(some.code, 0) << some.out << some.err;
  EXPECT_THAT(some.err, AllOf(HasSubstr("note: b.yaml:1: no camera shows where the target was"),
                              HasSubstr("left out (and in 2 more samples)")));
}

}  // namespace
}  // namespace kinecal
