// What init writes is a valid configuration.  It frees nothing that its target does not determine,
// except for what a prior keeps: for each robot, target and kind of camera.
#include "kinecal/tools/init/initial_config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <fstream>
#include <map>
#include <numbers>
#include <optional>
#include <random>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/tools/init/initial_capture.hpp"
#include "kinecal/trust/uncertainty/observability.hpp"
#include "support/every_robot.hpp"
#include "support/paths.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

struct Case {
  std::string name;
  InitAnswers answers;
};

/// Robots that hold their camera in the hand see nothing in it.
bool makes_sense(const Robot& robot, const InitAnswers& answers) {
  if (needs_camera(answers.target) && answers.camera.empty()) return false;
  if (!needs_arm(answers.target) || !needs_camera(answers.target)) return true;
  const auto above = joints_to_root(robot, answers.camera);
  const auto arm = joints_to_root(robot, answers.arm);
  const auto turning = std::find_if(arm.begin(), arm.end(), [](auto* j) { return moves(j->type); });
  return std::find(above.begin(), above.end(), *turning) == above.end();
}

/// The answers that make sense for a robot.
std::vector<Case> every_case(const Robot& robot) {
  const auto arms = propose_arms(robot), cameras = propose_cameras(robot);
  std::vector<Case> all;
  if (arms.empty()) return all;  // the test of proposals reports it
  for (const InitTargetWord& word : kInitTargets) {
    if (word.board != InitBoard::checkerboard) continue;  // other names, the same parameters
    for (const char* type : {"camera3d", "camera2d"}) {
      for (const bool ground : {false, true}) {
        InitAnswers answers{word.target, ground, "", arms.front(), "", type, "camera"};
        if (!cameras.empty()) answers.camera = cameras.front();
        answers.base = propose_base(robot, answers.arm);
        const bool pixels = answers.camera_type == "camera2d";
        // They have tests of their own.
        if (word.target == InitTarget::robot || is_touched(word.target)) continue;
        if (word.target == InitTarget::tracker && (ground || pixels)) continue;
        if (word.target == InitTarget::ground && (ground || pixels)) continue;
        if (pixels && ground) continue;
        if (!makes_sense(robot, answers)) continue;
        all.push_back(
            {std::string(word.word) + (pixels ? "_pixels" : "") + (ground ? "_and_ground" : ""),
             answers});
      }
    }
  }
  return all;
}

/// Of one robot.  A test has all cases of it: reading every robot to list them takes a while, and
/// each test of this program would do it.
class InitialConfig : public testing::TestWithParam<test::NamedUrdf> {
 protected:
  template <class F>
  void for_each_case(F&& test) {
    const Robot robot = read_urdf(GetParam().file.string());
    for (const Case& c : every_case(robot)) {
      SCOPED_TRACE(c.name);
      test(robot, c.answers);
    }
  }

  /// The configuration that is written, read again from a file: messages have its lines.
  Config read_again(const std::string& text, Diagnostics& diagnostics) {
    const test::TemporaryFolder folder;  // tests of one robot run at the same time
    const auto path = folder.path() / "init.yaml";
    std::ofstream(path) << text;
    return read_config(path.string(), diagnostics);
  }
};

/// What the nominal robot is wrong about.
struct Truth {
  std::map<std::string, double> offsets;       ///< of joints, radians or metres
  std::map<std::string, Pose<double>> frames;  ///< virtual ones, in their links
};

/// A virtual frame that belongs to a model, or the model's link.
std::string frame_of(const StepConfig& step, const ModelConfig& model) {
  for (const FrameInitialValueConfig& frame : step.frame_initial_values) {
    const bool on_base = frame.name == "tracker_frame" || frame.name == "laser_frame";
    if (model.type == "chain3d" && on_base == (model.name == "tracker")) return frame.name;
  }
  return model.frame;
}

/// One pose of the robot; nothing if the camera does not see the target.
class Simulation {
 public:
  Simulation(const Robot& robot, const InitAnswers& answers, const StepConfig& step, Truth truth)
      : robot_(robot),
        target_(answers.target),
        first_(step.models.front()),
        second_(step.models.back()),
        first_frame_(frame_of(step, first_)),
        second_frame_(frame_of(step, second_)),
        to_first_(make_chain(robot, answers.base, first_.frame)),
        to_second_(make_chain(robot, answers.base, second_.frame)),
        truth_(std::move(truth)) {}

  std::vector<Sample> samples(std::size_t count) {
    std::vector<Sample> all;
    for (int tries = 0; all.size() < count && tries < 20000; ++tries) {
      if (auto seen = sample()) all.push_back(std::move(*seen));
    }
    return all;
  }

 private:
  double random() { return std::uniform_real_distribution<double>(-1.0, 1.0)(engine_); }

  std::optional<Sample> sample() {
    Sample sample;
    for (const Joint& joint : robot_.joints()) {
      if (!moves(joint.type) || joint.mimic) continue;
      sample.joint_names.push_back(joint.name);
      sample.joint_positions.push_back((turns(joint.type) ? 1.5 : 0.2) * random());
    }
    const auto at = [&](const std::string& joint) {
      return *sample.position(joint) + truth_.offsets[joint];
    };
    const Pose<double> base_T_first =
        forward_kinematics(to_first_, at) * truth_.frames[first_frame_];
    const Pose<double> base_T_second =
        forward_kinematics(to_second_, at) * truth_.frames[second_frame_];
    const bool is_camera = second_.type != "chain3d";
    Observation modelled{first_.name, {}}, seen{second_.name, {}};
    for (int i = 0; i < 5; ++i) {
      Vector3<double> p(0.1 * random(), 0.1 * random(), 0.1 * random());
      if (target_ == InitTarget::tracker) p.setZero();
      modelled.features.push_back({first_frame_, p});
      p = base_T_second.inverse() * (base_T_first * p);
      if (target_ == InitTarget::ground) {  // where a ray of the camera meets z = 0
        const Vector3<double> ray(random(), random(), 1.0);
        p = -base_T_second.translation.z() / (base_T_second.rotation * ray).z() * ray;
      }
      if (is_camera && !(p.z() > 0.1 && p.head<2>().norm() < 2.0 * p.z())) return std::nullopt;
      if (second_.type == "camera2d") p = {500 * p.x() / p.z() + 320, 500 * p.y() / p.z() + 240, 0};
      seen.features.push_back({second_frame_, p});
    }
    if (is_camera) {
      seen.camera.emplace();
      seen.camera->p = {500, 0, 320, 0, 0, 500, 240, 0, 0, 0, 1, 0};
      seen.camera->k = {500, 0, 320, 0, 500, 240, 0, 0, 1};
    }
    if (target_ != InitTarget::ground) sample.observations.push_back(modelled);
    sample.observations.push_back(seen);
    return sample;
  }

  const Robot& robot_;
  InitTarget target_;
  const ModelConfig &first_, &second_;
  std::string first_frame_, second_frame_;
  RuntimeChain to_first_, to_second_;
  Truth truth_;
  std::mt19937 engine_{7};  // fixed, for the same test in each run
};

TEST_P(InitialConfig, IsReadAndFitsTheRobotWithoutAWarning) {
  for_each_case([&](const Robot& robot, const InitAnswers& answers) {
    const std::string text = initial_config(robot, answers);
    Diagnostics diagnostics;
    const Config config = read_again(text, diagnostics);
    (void)assemble(config, robot, {}, diagnostics);
    EXPECT_THAT(diagnostics.errors, testing::IsEmpty()) << text;
    EXPECT_THAT(diagnostics.warnings, testing::IsEmpty()) << text;
  });
}

TEST_P(InitialConfig, FreesOnlyWhatSamplesDetermineOrAPriorKeeps) {
  for_each_case([&](const Robot& robot, const InitAnswers& answers) {
    const std::string text = initial_config(robot, answers);
    Diagnostics diagnostics;
    const Config config = read_again(text, diagnostics);
    const auto samples = Simulation(robot, answers, config.steps.front(), {}).samples(60);
    ASSERT_GE(samples.size(), 10u) << "the camera never sees the target";
    const Calibration calibration = assemble(config, robot, samples, diagnostics);
    ASSERT_THAT(diagnostics.errors, testing::IsEmpty()) << text;
    const CalibrationStep& step = calibration.steps.front();
    const Eigen::VectorXd values = calibration.table.values();
    const Observability found = observability(
        *step.problem, step.free, std::span(values.data(), values.data() + values.size()));
    for (const Combination& open : found.unobservable) {
      std::string names;
      bool kept = false;
      for (const auto& [index, factor] : open) {
        const std::string& name = calibration.table[index].name;
        names += " " + name;
        for (const BlockConfig& block : config.steps.front().error_blocks) {
          kept = kept || (!block.param.empty() && name.starts_with(block.param));
        }
      }
      EXPECT_TRUE(kept) << "open:" << names << "\n" << text;
    }
  });
}

/// As far off as its comments allow: joints by 2 degrees, frames that were measured by hand by 30
/// degrees and 0.1 m (a board), 60 degrees and 0.5 m (a tracker).
TEST_P(InitialConfig, FindsWrongRobotsFromWhereItStarts) {
  for_each_case([&](const Robot& robot, const InitAnswers& answers) {
    if (answers.target == InitTarget::ground) return;  // frees no offset and no virtual frame
    Diagnostics diagnostics;
    const Config config = read_again(initial_config(robot, answers), diagnostics);
    const StepConfig& step = config.steps.front();
    Truth truth;
    constexpr double kDegree = std::numbers::pi / 180.0;
    for (const FreeParamConfig& param : step.free_params) {
      if (robot.has_joint(param.name)) truth.offsets[param.name] = 2.0 * kDegree;
    }
    for (const FrameInitialValueConfig& frame : step.frame_initial_values) {
      const bool is_tracker = frame_of(step, step.models.back()) == frame.name;
      const bool is_reflector = answers.target == InitTarget::tracker && !is_tracker;
      const double turn = (is_tracker ? 60.0 : 30.0) * kDegree;
      const Vector3<double> axis_angle = turn / 3.0 * Vector3<double>(1.0, -2.0, 2.0);
      Pose<double>& pose = truth.frames[frame.name];
      if (!is_reflector) pose.rotation = exp(axis_angle);
      pose.translation = (is_tracker ? 0.5 : 0.1) / 3.0 * Vector3<double>(2.0, 1.0, 2.0);
    }
    const auto samples = Simulation(robot, answers, step, truth).samples(60);
    ASSERT_GE(samples.size(), 10u);
    const CalibrationResult result = calibrate(assemble(config, robot, samples, diagnostics));
    EXPECT_TRUE(result.converged) << result.termination;
    constexpr double kMetres = 1.7e-4, kPixels = 0.07;  // what a prior may take, far below noise
    EXPECT_LE(result.blocks[0].after.rms, result.blocks[0].unit == "px" ? kPixels : kMetres);
  });
}

TEST_P(InitialConfig, FitsIntoLinesAndExplainsEachList) {
  for_each_case([&](const Robot& robot, const InitAnswers& answers) {
    std::istringstream text(initial_config(robot, answers));
    std::string before;
    for (std::string line; std::getline(text, line); before = line) {
      EXPECT_TRUE(line.size() <= 100 || !line.starts_with("#")) << line;
      const bool is_list = !line.empty() && line.ends_with(":") && line[0] != ' ' && line[0] != '#';
      EXPECT_TRUE(!is_list || before.starts_with("#")) << line;
    }
  });
}

INSTANTIATE_TEST_SUITE_P(EveryRobot, InitialConfig, testing::ValuesIn(test::every_robot()),
                         [](const auto& param) { return param.param.name; });

class InitialConfigMistakes : public testing::Test {
 protected:
  std::string message(InitAnswers answers) const {
    return test::thrown<InputError>([&] { (void)initial_config(robot_, answers); }, "");
  }
  Robot robot_ = read_urdf(test::source_folder() + "/examples/robots/panda/panda.urdf");
  InitAnswers good_{InitTarget::world_checkerboard, false,      "panda_link0", "panda_hand",
                    "camera_color_optical_frame",   "camera3d", "camera"};
};

TEST_F(InitialConfigMistakes, AreReportedAllAtOnceWithTheOptionAndTheNearestName) {
  EXPECT_EQ(message(good_), "");
  good_.base = "panda_lnk0";
  good_.camera = "camera_color_optcal_frame";
  good_.camera_type = "camera4d";
  EXPECT_THAT(message(good_),
              testing::AllOf(HasSubstr("--base: no link 'panda_lnk0'"),
                             HasSubstr("did you mean 'panda_link0'?"), HasSubstr("--camera: no"),
                             HasSubstr("--camera-type: 'camera4d' is neither")));
}

TEST_F(InitialConfigMistakes, ACameraInTheHandDoesNotSeeWhatTheHandHolds) {
  good_.target = InitTarget::checkerboard;
  EXPECT_THAT(message(good_), HasSubstr("--target world_checkerboard"));
}

TEST_F(InitialConfigMistakes, ABoardInTheWorldNeedsACameraThatMoves) {
  good_.base = "panda_link7";
  EXPECT_THAT(message(good_), HasSubstr("--camera: camera 'camera_color_optical_frame' does not"));
}

TEST_F(InitialConfigMistakes, PixelsDoNotShowTheFloor) {
  good_.with_ground = true;
  good_.camera_type = "camera2d";
  EXPECT_THAT(message(good_), HasSubstr("--camera-type: the floor"));
  good_.target = InitTarget::tracker;
  EXPECT_THAT(message(good_), HasSubstr("--target: tracker and ground"));
}

TEST_F(InitialConfigMistakes, TheCameraHasItsOwnName) {
  good_.camera_name = "board";
  EXPECT_THAT(message(good_), HasSubstr("--robot-camera-name: 'board'"));
}

TEST_F(InitialConfigMistakes, FramesHaveTheNamesThatAreGivenAndNoOthers) {
  EXPECT_THAT(initial_config(robot_, good_), HasSubstr("{name: checkerboard, x: true"));
  good_.target_frame = "charuco";
  const std::string text = initial_config(robot_, good_);
  EXPECT_THAT(text, testing::AllOf(HasSubstr("{name: charuco, x: true"),
                                   testing::Not(HasSubstr("{name: checkerboard"))));
  good_.target_frame = "panda_joint44";
  EXPECT_THAT(message(good_), HasSubstr("--target-frame: 'panda_joint44' is a link or a joint"));
  good_.target = InitTarget::tracker;
  good_.target_frame = good_.tracker_frame = "laser";
  EXPECT_THAT(message(good_),
              HasSubstr("--tracker-frame: 'laser' is the frame of the reflector too"));
}

TEST_F(InitialConfigMistakes, TheBaseNeedNotBeGiven) {
  good_.base = "";
  EXPECT_THAT(initial_config(robot_, good_), HasSubstr("base_link: panda_link0\n"));
}

TEST(InitialConfigNames, AreQuotedWhereYamlWouldMistakeThem) {
  Joint joint{"no", JointType::revolute, "base: link", "#tip", {}, {0.0, 0.0, 1.0}};
  Joint second{"a, b", JointType::revolute, "#tip", "hand\nmade", {}, {1.0, 0.0, 0.0}};
  Joint third{"{c}", JointType::revolute, "hand\nmade", "off", {}, {0.0, 0.0, 1.0}};
  const Robot robot("odd", {joint, second, third});
  InitAnswers answers{InitTarget::tracker, false, "base: link", "off", "", "camera3d", "camera"};
  const YAML::Node yaml = YAML::Load(initial_config(robot, answers));
  EXPECT_EQ(yaml["base_link"].as<std::string>(), "base: link");
  EXPECT_EQ(yaml["free_params"][0].as<std::string>(), "a, b");
  EXPECT_EQ(yaml["models"][0]["frame"].as<std::string>(), "off");
}

TEST(InitialConfigOfTheRobotItself, FreesTheJointsOfAGivenArm) {
  const Robot fetch = read_urdf(test::source_folder() + "/examples/robots/fetch/fetch.urdf");
  InitAnswers answers;
  answers.target = InitTarget::robot;
  answers.base = "base_link";
  answers.camera = "head_camera_rgb_optical_frame";
  EXPECT_THAT(initial_config(fetch, answers), testing::Not(HasSubstr("- elbow_flex_joint")));
  answers.arm = "gripper_link";
  const std::string text = initial_config(fetch, answers);
  for (const std::string free :
       {"- elbow_flex_joint", "- wrist_roll_joint", "name: head_pan_joint,",
        "name: head_camera_rgb_joint,", "type: chain3d_to_mesh"}) {
    EXPECT_THAT(text, HasSubstr(free));
  }
  EXPECT_THAT(
      text,
      testing::Not(HasSubstr("- shoulder_pan_joint")));  // the frame of the head has its rotation
}

TEST(InitialConfigOfTheRobotItself, FreesTheCameraOnly) {
  const Robot robot = read_urdf(test::source_folder() + "/examples/robots/fetch/fetch.urdf");
  for (const auto& [type, block] :
       {std::pair("camera3d", "chain3d_to_mesh"), std::pair("camera2d", "camera2d_to_mesh")}) {
    InitAnswers answers;
    answers.target = InitTarget::robot;
    answers.camera = propose_cameras(robot).front();
    answers.camera_type = type;
    Diagnostics diagnostics;
    const Config config =
        parse_config(initial_config(robot, answers), "calibrate.yaml", diagnostics);
    EXPECT_THAT(diagnostics.errors, testing::IsEmpty());
    EXPECT_THAT(diagnostics.warnings, testing::IsEmpty());
    const StepConfig& step = config.steps.front();
    EXPECT_TRUE(step.free_params.empty());
    ASSERT_EQ(step.free_frames.size(), 1U);
    ASSERT_EQ(step.error_blocks.size(), 1U);
    EXPECT_EQ(step.error_blocks[0].type, block);
    EXPECT_EQ(step.error_blocks[0].loss.type, "cauchy");
    EXPECT_TRUE(initial_capture(robot, answers).empty());
  }
}

}  // namespace
}  // namespace kinecal
