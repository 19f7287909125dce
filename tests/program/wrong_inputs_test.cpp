// Inputs that can be read but are wrong: none ends with exit code 0 and files.  And odd ones that are
// right: they are accepted without error or doubt.
//
// `kByVerdict` marks inputs that nothing can refuse before solving: their residuals show it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <sstream>

#include "kinecal/files/samples/read_samples.hpp"
#include "kinecal/files/samples/write_samples.hpp"
#include "support/arm_scene.hpp"
#include "support/calibrated.hpp"
#include "support/data.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// The files of a calibration.
struct Files {
  std::string urdf, config;
  std::vector<Sample> samples;
  std::string samples_text = {};  ///< in place of the samples, if not empty
};

Files files_of(const fs::path& urdf, const fs::path& config, const fs::path& samples) {
  Diagnostics diagnostics;
  return {test::text_of(urdf), test::text_of(config), read_samples(samples.string(), diagnostics)};
}

/// 23 poses of a UR5 and a tracker, 13 parameters.
Files ur5() {
  const fs::path folder = test::data_folder() / "ur5_tracker";
  Files files = files_of(folder / "ur5.urdf", folder / "offsets.yaml", folder / "grid.yaml");
  std::vector<Sample> some;
  for (std::size_t i = 0; i < 23; ++i) some.push_back(files.samples[(i * 389) % 1000]);
  files.samples = some;
  return files;
}

Files panda() {
  const fs::path folder = test::data_folder() / "mukca_panda";
  return files_of(folder / "panda.urdf", folder / "panda_6/minimal.yaml",
                  folder / "panda_6/front.yaml");
}

Files fetch() {
  const fs::path folder = test::data_folder() / "fetch/synth";
  return files_of(folder / "fetch_arm_head.urdf", folder / "calibrate.yaml",
                  folder / "samples.yaml");
}

/// The arm of support/arm_scene.hpp, in every installation of the tests.
Files arm() {
  return {test::kArmUrdf, test::kArmConfig,
          test::arm_samples(parse_urdf(test::kArmUrdf, "arm.urdf"), 30)};
}

/// The shipped Fetch; its samples are drawn by its program.
Files shipped_fetch() {
  static const Files drawn = [] {
    const test::TemporaryFolder folder;
    const test::Outcome run = test::run_in(
        folder.path(), test::program("calibrate_fetch") + " --write-samples s.yaml --output a");
    if (run.code != 0) throw std::runtime_error(run.err);
    const fs::path robot = fs::path(test::source_folder()) / "examples/robots/fetch";
    return files_of(robot / "fetch.urdf", robot / "calibrate.yaml", folder.path() / "s.yaml");
  }();
  return drawn;
}

struct Set {
  const char* name;
  const char* folder;  ///< of the data; empty: always there
  Files (*files)();
};

constexpr Set kUr5{"ur5", "ur5_tracker", ur5}, kPanda{"panda", "mukca_panda", panda},
    kFetch{"fetch", "fetch", fetch}, kArm{"arm", "", arm}, kShipped{"shipped", "", shipped_fetch};

// What goes wrong.

using Change = std::function<void(Files&)>;

double& position(Sample& sample, const std::string& joint) {
  const auto at = std::find(sample.joint_names.begin(), sample.joint_names.end(), joint);
  if (at == sample.joint_names.end()) throw std::logic_error("no joint " + joint);
  return sample.joint_positions[static_cast<std::size_t>(at - sample.joint_names.begin())];
}

Change each(const std::function<void(Sample&)>& change) {
  return [=](Files& files) { std::for_each(files.samples.begin(), files.samples.end(), change); };
}

Change positions_times(double factor) {
  return each([=](Sample& s) {
    for (double& q : s.joint_positions) q *= factor;
  });
}

Change position_times(const std::string& joint, double factor) {
  return each([=](Sample& s) { position(s, joint) *= factor; });
}

Change exchanged(const std::string& a, const std::string& b) {
  return each([=](Sample& s) { std::swap(position(s, a), position(s, b)); });
}

Change points(const std::string& sensor,
              const std::function<Vector3<double>(const Vector3<double>&)>& change) {
  return each([=](Sample& s) {
    for (Observation& seen : s.observations) {
      if (seen.sensor != sensor) continue;
      for (Feature& feature : seen.features) feature.point = change(feature.point);
    }
  });
}

Change points_times(const std::string& sensor, double factor) {
  return points(sensor, [=](const Vector3<double>& p) -> Vector3<double> { return factor * p; });
}

Change first_samples(std::size_t count) {
  return [=](Files& files) { files.samples.resize(count); };
}

/// Replaces all occurrences.
std::string replaced(std::string text, const std::string& from, const std::string& to) {
  std::size_t found = 0;
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
    ++found;
  }
  if (found == 0) throw std::logic_error("no text " + from);
  return text;
}

Change urdf_text(const std::string& from, const std::string& to) {
  return [=](Files& files) { files.urdf = replaced(files.urdf, from, to); };
}

Change config_text(const std::string& from, const std::string& to) {
  return [=](Files& files) { files.config = replaced(files.config, from, to); };
}

/// Multiplies the numbers of an attribute of all origins.
Change origins_times(const std::string& attribute, double factor) {
  return [=](Files& files) {
    std::string text;
    std::size_t done = 0;
    for (std::size_t origin = files.urdf.find("<origin"); origin != std::string::npos;
         origin = files.urdf.find("<origin", origin + 1)) {
      const std::size_t end = files.urdf.find('>', origin);
      const std::size_t at = files.urdf.find(attribute + "=\"", origin);
      if (at > end) continue;
      const std::size_t first = at + attribute.size() + 2, last = files.urdf.find('"', first);
      std::istringstream numbers(files.urdf.substr(first, last - first));
      text += files.urdf.substr(done, first - done);
      std::ostringstream scaled;
      scaled.precision(12);
      for (double value = 0.0; numbers >> value;) scaled << value * factor << " ";
      text += scaled.str();
      done = last;
    }
    files.urdf = text + files.urdf.substr(done);
  };
}

/// The observations of a sensor come from the sample before.
Change stale(const std::string& sensor) {
  return [=](Files& files) {
    const std::vector<Sample> before = files.samples;
    for (std::size_t i = 0; i < before.size(); ++i) {
      for (Observation& seen : files.samples[i].observations) {
        if (seen.sensor != sensor) continue;
        seen = *before[(i + before.size() - 1) % before.size()].observation(sensor);
      }
    }
  };
}

Change frozen(const std::string& sensor) {
  return [=](Files& files) {
    const Observation first = *files.samples[0].observation(sensor);
    for (Sample& sample : files.samples) {
      for (Observation& seen : sample.observations) {
        if (seen.sensor == sensor) seen = first;
      }
    }
  };
}

Change one_sample() {
  return [](Files& files) {
    std::fill(files.samples.begin(), files.samples.end(), Sample(files.samples[0]));
  };
}

Change names_sorted() {
  return each([](Sample& s) { std::sort(s.joint_names.begin(), s.joint_names.end()); });
}

Change reversed_features(const std::string& sensor) {
  return each([=](Sample& s) {
    for (Observation& seen : s.observations) {
      if (seen.sensor == sensor) std::reverse(seen.features.begin(), seen.features.end());
    }
  });
}

Change one_position(const std::string& joint, double value) {
  return [=](Files& files) { position(files.samples[3], joint) = value; };
}

Change one_point(std::size_t sensor, double value) {
  return [=](Files& files) { files.samples[3].observations[sensor].features[0].point.x() = value; };
}

enum When { kAtOnce, kByVerdict };

struct WrongInput {
  std::string name;
  Set set;
  Change change;
  When when;
  std::string message = {};  ///< part of it, if it is refused at once
};

void PrintTo(const WrongInput& wrong, std::ostream* out) {
  *out << wrong.set.name << ": " << wrong.name;
}

std::vector<WrongInput> ur5_inputs() {
  return {
      {"degrees", kUr5, positions_times(kDegrees), kAtOnce, "look like degrees"},
      {"one_joint_in_degrees", kUr5, position_times("elbow_joint", kDegrees), kAtOnce,
       "'elbow_joint' reach"},
      {"lift_and_elbow_exchanged", kUr5, exchanged("shoulder_lift_joint", "elbow_joint"),
       kByVerdict},
      {"wrists_exchanged", kUr5, exchanged("wrist_1_joint", "wrist_2_joint"), kByVerdict},
      {"names_in_order_of_the_alphabet", kUr5, names_sorted(), kByVerdict},
      {"elbow_negated", kUr5, position_times("elbow_joint", -1.0), kByVerdict},
      {"pan_negated", kUr5, position_times("shoulder_pan_joint", -1.0), kByVerdict},
      {"elbow_axis_negated", kUr5,
       [](Files& files) {
         const std::size_t at = files.urdf.find("<axis", files.urdf.find("\"elbow_joint\""));
         files.urdf.replace(at, 21, "<axis xyz=\"0 0 -1\"/> ");
       },
       kByVerdict},
      {"a_joint_that_is_never_updated", kUr5, position_times("wrist_1_joint", 0.0), kByVerdict},
      {"tracker_in_millimetres", kUr5, points_times("tracker", 1e3), kAtOnce, "millimetres"},
      {"tracker_in_inches", kUr5, points_times("tracker", 1 / 0.0254), kAtOnce, "inches"},
      {"tracker_in_kilometres", kUr5, points_times("tracker", 1e-3), kAtOnce, "kilometres"},
      {"tracker_frozen", kUr5, frozen("tracker"), kAtOnce, "same features"},
      {"tracker_one_sample_late", kUr5, stale("tracker"), kByVerdict},
      {"tracker_left_handed", kUr5,
       points("tracker",
              [](const Vector3<double>& p) { return Vector3<double>(p.y(), p.x(), p.z()); }),
       kByVerdict},
      {"urdf_in_millimetres", kUr5, origins_times("xyz", 1e3), kAtOnce, "millimetres"},
      {"urdf_in_kilometres", kUr5, origins_times("xyz", 1e-3), kAtOnce, "kilometres"},
      {"urdf_in_degrees", kUr5, origins_times("rpy", kDegrees), kAtOnce, "in degrees?"},
      {"urdf_of_a_ur10", kUr5,
       [](Files& files) {
         for (const auto& [from, to] :
              std::vector<std::pair<std::string, std::string>>{{"0.089159", "0.1273"},
                                                               {"-0.425", "-0.612"},
                                                               {"-0.39225", "-0.5723"},
                                                               {"0.10915", "0.163941"},
                                                               {"0.09465", "0.1157"},
                                                               {"0.0823", "0.0922"}}) {
           files.urdf = replaced(files.urdf, from, to);
         }
       },
       kByVerdict},
      {"xacro_left", kUr5,
       urdf_text("<link name=\"tool0\"/>",
                 "<link name=\"tool0\"/><xacro:gripper parent=\"tool0\"/>"),
       kAtOnce, "run: xacro"},
      {"xacro_expression_left", kUr5, urdf_text("1.5707963267948966", "${pi/2}"), kAtOnce, "xacro"},
      {"one_sample_23_times", kUr5, one_sample(), kAtOnce, "all 23 samples are the same"},
      {"five_samples_for_13_parameters", kUr5, first_samples(5), kAtOnce,
       "13 free parameters, 5 different samples give only 15 residuals"},
      {"four_samples", kUr5, first_samples(4), kAtOnce, "12 residuals"},
      {"five_samples_many_times", kUr5,
       [](Files& files) {
         files.samples.resize(5);
         for (std::size_t i = 0; i < 50; ++i) files.samples.push_back(files.samples[i]);
       },
       kAtOnce, "5 different samples"},
      {"frames_exchanged", kUr5,
       [](Files& files) {
         files.config = replaced(files.config, "frame: tool0", "frame: other");
         files.config = replaced(files.config, "frame: base_link", "frame: tool0");
         files.config = replaced(files.config, "frame: other", "frame: base_link");
       },
       kAtOnce, "are exchanged in the configuration"},
      {"reflector_on_the_wrong_link", kUr5, config_text("frame: tool0", "frame: forearm_link"),
       kByVerdict},
      {"a_position_of_1e6", kUr5, one_position("elbow_joint", 1e6), kAtOnce, "is 1e+06 rad"},
      {"a_point_of_1e200", kUr5, one_point(1, 1e200), kAtOnce, "1e+200"},
  };
}

std::vector<WrongInput> panda_inputs() {
  return {
      {"degrees", kPanda, positions_times(kDegrees), kAtOnce, "look like degrees"},
      {"radians_converted_twice", kPanda, positions_times(1 / kDegrees), kByVerdict},
      {"joints_4_and_6_exchanged", kPanda, exchanged("panda_joint4", "panda_joint6"), kAtOnce,
       "'panda_joint4' and 'panda_joint6'"},
      {"joints_2_and_7_exchanged", kPanda, exchanged("panda_joint2", "panda_joint7"), kByVerdict},
      // By the limits, a half turn explains as much.
      {"joint_4_negated", kPanda, position_times("panda_joint4", -1.0), kByVerdict,
       "likely cause: with the positions of 'panda_joint4' negated"},
      {"joint_5_negated", kPanda, position_times("panda_joint5", -1.0), kByVerdict},
      {"urdf_in_millimetres", kPanda, origins_times("xyz", 1e3), kAtOnce, "millimetres"},
      {"urdf_in_degrees", kPanda, origins_times("rpy", kDegrees), kAtOnce, "in degrees?"},
      {"sockets_in_millimetres", kPanda, points_times("fixture", 1e3), kAtOnce, "fixture"},
      {"sockets_exchanged_in_half_of_them", kPanda,
       [](Files& files) {
         for (std::size_t i = 0; i < files.samples.size(); i += 2) {
           Vector3<double>& p = files.samples[i].observations[1].features[0].point;
           p.x() = 0.05 - p.x();
         }
       },
       kByVerdict},
      {"eight_samples_for_30_parameters", kPanda, first_samples(8), kAtOnce, "24 residuals"},
      {"one_sample_many_times", kPanda, one_sample(), kAtOnce, "are the same one"},
      {"a_position_of_1e6", kPanda, one_position("panda_joint3", 1e6), kAtOnce, "is 1e+06 rad"},
  };
}

std::vector<WrongInput> fetch_inputs(const Set& set) {
  return {
      {"degrees", set, positions_times(kDegrees), kAtOnce, "look like degrees"},
      {"camera_in_millimetres", set, points_times("camera", 1e3), kAtOnce, "millimetres"},
      {"camera_in_kilometres", set, points_times("camera", 1e-3), kAtOnce,
       "no camera sees so close"},
      {"leds_in_millimetres", set, points_times("arm", 1e3), kAtOnce, "points of sensor 'arm'"},
      {"leds_in_reverse_order", set, reversed_features("arm"), kByVerdict},
      {"elbow_and_lift_exchanged", set, exchanged("elbow_flex_joint", "shoulder_lift_joint"),
       kByVerdict},
      {"forearm_and_wrist_roll_exchanged", set, exchanged("forearm_roll_joint", "wrist_roll_joint"),
       kByVerdict},
      {"head_never_updated", set, position_times("head_tilt_joint", 0.0), kByVerdict},
      {"wrist_flex_negated", set, position_times("wrist_flex_joint", -1.0), kByVerdict},
      {"camera_frozen", set, frozen("camera"), kAtOnce, "same features"},
      {"camera_one_sample_late", set, stale("camera"), kByVerdict},
      {"camera_with_the_axes_of_a_body", set,
       points("camera",
              [](const Vector3<double>& p) { return Vector3<double>(p.z(), -p.x(), -p.y()); }),
       kAtOnce, "a point is behind the camera"},
      {"urdf_in_millimetres", set, origins_times("xyz", 1e3), kAtOnce, "millimetres"},
      {"urdf_in_degrees", set, origins_times("rpy", kDegrees), kAtOnce, "in degrees?"},
      {"one_sample_many_times", set, one_sample(), kAtOnce, "are the same one"},
      {"a_point_of_1e200", set, one_point(0, 1e200), kAtOnce, "1e+200"},
  };
}

std::vector<WrongInput> arm_inputs() {
  return {
      {"two_joints_exchanged", kArm, exchanged("elbow", "flex"), kAtOnce, "'elbow' and 'flex'"},
      {"names_in_order_of_the_alphabet", kArm, names_sorted(), kAtOnce,
       "in the order of the chain"},
      {"target_in_millimetres", kArm, points_times("arm", 1e3), kAtOnce, "millimetres"},
      {"start_of_1e200", kArm,
       [](Files& files) {
         files.config +=
             "free_frames_initial_values:\n - {name: tracker_frame, x: 1.0e+200, y: 0.0, "
             "z: 0.0, roll: 0.0, pitch: 0.0, yaw: 0.0}\n";
       },
       kAtOnce, "initial value"},
  };
}

std::vector<WrongInput> wrong_inputs() {
  std::vector<WrongInput> all;
  for (const auto& more :
       {ur5_inputs(), panda_inputs(), fetch_inputs(kFetch), fetch_inputs(kShipped), arm_inputs()}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

/// Writes the files of a case and runs the program on them.
class Inputs : public test::ProgramTest {
 protected:
  [[nodiscard]] test::Outcome calibrate(const Files& files) const {
    write("robot.urdf", files.urdf);
    write("c.yaml", files.config);
    std::ostringstream text;
    write_samples(text, files.samples);
    write("s.yaml", files.samples_text.empty() ? text.str() : files.samples_text);
    return run(test::kinecal_program() +
               " calibrate --urdf robot.urdf --config c.yaml --samples s.yaml --output out");
  }
};

std::string name_of(const std::string& set, const std::string& name) {
  return set + "_" + name;
}

class WrongInputs : public Inputs, public testing::WithParamInterface<WrongInput> {};

TEST_P(WrongInputs, AreNotCalibrated) {
  const WrongInput& wrong = GetParam();
  if (*wrong.set.folder != 0) KINECAL_NEEDS_DATA(wrong.set.folder);
  Files files = wrong.set.files();
  wrong.change(files);
  const test::Outcome result = calibrate(files);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  if (wrong.when == kByVerdict && result.code != 1) {
    EXPECT_EQ(result.code, 2) << result.out << result.err;
    EXPECT_THAT(result.out, testing::StartsWith("verdict: do not use\n"));
    EXPECT_THAT(result.out, HasSubstr(wrong.message));
    return;
  }
  EXPECT_EQ(result.code, 1) << result.out << result.err;
  EXPECT_THAT(result.err, HasSubstr(wrong.message));
  EXPECT_THAT(result.err, HasSubstr("error: "));
  EXPECT_EQ(result.out, "");
}

INSTANTIATE_TEST_SUITE_P(All, WrongInputs, testing::ValuesIn(wrong_inputs()), [](const auto& test) {
  return name_of(test.param.set.name, test.param.name);
});

TEST(WrongInputs, AreAsManyAsPromised) {
  const auto all = wrong_inputs();
  EXPECT_GE(all.size(), 40u);
  EXPECT_GE(std::count_if(all.begin(), all.end(), [](const auto& w) { return w.when == kAtOnce; }),
            40);
}

struct OddInput {
  std::string name;
  Set set;
  Change change;
};

void PrintTo(const OddInput& odd, std::ostream* out) {
  *out << odd.set.name << ": " << odd.name;
}

/// Line ends as on Windows.
std::string crlf(const std::string& text) {
  return replaced(text, "\n", "\r\n");
}

std::string text_of(const std::vector<Sample>& samples) {
  std::ostringstream text;
  write_samples(text, samples);
  return text.str();
}

Change far_link() {
  return urdf_text("<link name=\"base_link\"/>",
                   "<link name=\"base_link\"/><link name=\"map\"/><joint name=\"on_map\" "
                   "type=\"fixed\"><origin xyz=\"5e5 4e6 0\"/><parent link=\"map\"/><child "
                   "link=\"base_link\"/></joint>");
}

std::vector<OddInput> odd_inputs() {
  return {
      {"as_it_is", kArm, [](Files&) {}},
      {"as_it_is", kUr5, [](Files&) {}},
      {"as_it_is", kPanda, [](Files&) {}},
      {"as_it_is", kFetch, [](Files&) {}},
      {"as_it_is", kShipped, [](Files&) {}},
      {"line_ends_of_windows", kArm,
       [](Files& files) {
         files.urdf = crlf(files.urdf);
         files.config = crlf(files.config);
         files.samples_text = crlf(text_of(files.samples));
       }},
      {"comments", kArm,
       [](Files& files) {
         files.urdf = replaced(files.urdf, "<link", "<!-- ${a} <xacro:b/> 400 mm --><link");
         files.config = replaced(files.config, "\n", "  # degrees\n");
         files.samples_text = "# recorded on Monday\n" + text_of(files.samples);
       }},
      {"axes_of_length_5", kArm,
       [](Files& files) {
         files.urdf = replaced(files.urdf, "<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 5\"/>");
       }},
      {"joints_that_no_model_needs", kArm, each([](Sample& s) {
         s.joint_names.insert(s.joint_names.begin(), {"wheel", "finger"});
         s.joint_positions.insert(s.joint_positions.begin(), {81234.5, 0.0});
       })},
      {"samples_in_another_order", kArm,
       [](Files& files) { std::reverse(files.samples.begin(), files.samples.end()); }},
      {"joints_in_another_order_in_each_sample", kArm,
       [](Files& files) {
         for (std::size_t i = 0; i < files.samples.size(); ++i) {
           auto& names = files.samples[i].joint_names;
           auto& positions = files.samples[i].joint_positions;
           const auto by = static_cast<std::ptrdiff_t>(i % names.size());
           std::rotate(names.begin(), names.begin() + by, names.end());
           std::rotate(positions.begin(), positions.begin() + by, positions.end());
         }
       }},
      {"huge_stamps", kArm,
       [](Files& files) {
         files.samples_text =
             replaced(text_of(files.samples), "joint_states: {",
                      "joint_states: {header: {stamp: {secs: 4102444800, nsecs: 999999999}}, ");
       }},
      {"a_sensor_that_is_not_configured", kArm, each([](Sample& s) {
         s.observations.push_back({"lidar", {{"lidar_link", Vector3<double>(3e4, 0, 0)}}});
       })},
      {"limits_slightly_exceeded", kArm,
       urdf_text("lower=\"-2.9\" upper=\"2.9\"", "lower=\"-2.6\" upper=\"2.7\"")},
      {"limits_that_say_nothing", kArm,
       urdf_text("lower=\"-2.9\" upper=\"2.9\"", "lower=\"0\" upper=\"0\"")},
      {"limits_of_1e16", kArm,
       urdf_text("lower=\"-3\" upper=\"3\"", "lower=\"-1e16\" upper=\"1e16\"")},
      {"joints_without_limits", kArm, urdf_text("revolute", "continuous")},
      {"a_turn_more", kArm, each([](Sample& s) { position(s, "roll") += 2 * std::numbers::pi; })},
      {"materials_meshes_transmissions", kArm,
       urdf_text("<link name=\"l3\"/>",
                 "<material name=\"red\"><color rgba=\"1 0 0 1\"/></material><link "
                 "name=\"l3\"><visual><origin xyz=\"0 0 150\" rpy=\"0 0 90\"/><geometry><mesh "
                 "filename=\"package://arm/l3.stl\" scale=\"0.001 0.001 0.001\"/></geometry>"
                 "<material name=\"red\"/></visual></link><transmission "
                 "name=\"t\"><type>x</type><joint name=\"pan\"/></transmission><gazebo/>")},
      {"a_tracker_60_m_away", kArm,
       points("tracker",
              [](const Vector3<double>& p) { return Vector3<double>(p.x() + 60, p.y(), p.z()); })},
      {"a_map_5000_km_away", kArm, far_link()},
      {"a_calibration_of_zero", kArm,
       urdf_text("<parent link=\"l1\"/>", "<calibration rising=\"0.0\"/><parent link=\"l1\"/>")},
      {"several_captures_at_one_pose", kArm,
       [](Files& files) {
         for (std::size_t i = 0; i < 10; ++i) {
           files.samples.push_back(files.samples[i]);
           files.samples.back().observations[1].features[0].point.x() += 1e-4;
         }
       }},
      {"an_observation_without_features", kArm,
       [](Files& files) { files.samples[4].observations[1].features.clear(); }},
  };
}

class OddInputs : public Inputs, public testing::WithParamInterface<OddInput> {};

TEST_P(OddInputs, AreCalibratedWithoutErrorOrDoubt) {
  const OddInput& odd = GetParam();
  if (*odd.set.folder != 0) KINECAL_NEEDS_DATA(odd.set.folder);
  Files files = odd.set.files();
  odd.change(files);
  const test::Outcome result = calibrate(files);
  EXPECT_EQ(result.code, 0) << result.out << result.err;
  // Of the Fetch, the prior of its own configuration contradicts the samples.
  EXPECT_THAT(
      result.out,
      testing::AnyOf(testing::StartsWith("verdict: good\n"),
                     testing::StartsWith("verdict: use with care\n  - prior 'restrict_camera'")));
  EXPECT_THAT(result.err, Not(HasSubstr("error: ")));
  EXPECT_THAT(result.err, Not(HasSubstr("doubt: ")));
  EXPECT_TRUE(fs::exists(folder_ / "out/calibrated.urdf"));
}

INSTANTIATE_TEST_SUITE_P(All, OddInputs, testing::ValuesIn(odd_inputs()), [](const auto& test) {
  return name_of(test.param.set.name, test.param.name);
});

/// A result that is calibrated again with the samples that it was made from.
class Recalibration : public Inputs {
 protected:
  /// The sum of `rising` and offset of the lift, 0.02 in truth, after the second calibration.
  [[nodiscard]] double lift_after(const test::Outcome& again) const {
    EXPECT_EQ(again.code, 0) << again.err;
    return rising_of(read("twice/calibrated.urdf"), "calibrated.urdf").at("lift");
  }
  [[nodiscard]] test::Outcome again(const std::string& options) const {
    return run(test::kinecal_program() +
               " calibrate --urdf out/calibrated.urdf --config c.yaml --samples s.yaml --output "
               "twice --force " +
               options);
  }
};

TEST_F(Recalibration, DoublesOffsetsOnlyWithADoubtAndNeverWithTheOption) {
  ASSERT_EQ(calibrate(arm()).code, 0);
  const test::Outcome doubled = again("");
  EXPECT_THAT(doubled.err, HasSubstr("doubt: out/calibrated.urdf:"));
  EXPECT_THAT(doubled.err, HasSubstr("look recorded before <calibration rising> was written"));
  EXPECT_NEAR(lift_after(doubled), 0.04, 0.002);
  const test::Outcome right = again("--samples-recorded before");
  EXPECT_THAT(right.err, Not(HasSubstr("doubt: ")));
  EXPECT_NEAR(lift_after(right), 0.02, 0.001);
  EXPECT_EQ(again("--samples-recorded during").code, 1);
}

}  // namespace
}  // namespace kinecal
