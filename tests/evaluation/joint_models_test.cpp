// Joint models: rows against the oracle and normal equations against rows multiplied out, also
// through a mimic joint, a sliding joint and a base on the moving arm; recovery of injected errors.
#include <gtest/gtest.h>

#include <map>

#include "kinecal/errors.hpp"
#include "kinecal/kinematics/gravity_load.hpp"
#include "kinecal/kinematics/true_position.hpp"
#include "support/oracle_problem.hpp"
#include "support/sums.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

const std::vector<std::string> kModelled = {
    "elbow_gear_ratio",       "elbow_eccentric_sin",        "elbow_eccentric_cos",
    "torso_joint_gear_ratio", "shoulder_pan_eccentric_sin", "finger_gear_ratio",
    "wrist_gear_ratio",       "elbow_second_harmonic_sin"};

ParameterTable modelled_table() {
  ParameterTable table = test::scene_table();
  table.add({.name = "finger"});
  for (const std::string& name : kModelled) table.add({.name = name});
  return table;
}

template <class S>
BasicProblem<S> modelled_problem(const std::string& base = "base_link") {
  BasicProblem<S> problem(test::mobile_manipulator(), base, modelled_table(), test::kSceneFrames);
  problem.add_sensor(ChainPoint{}, {"arm", "hand"});
  problem.add_sensor(DepthCamera{}, {"camera", "camera_optical_frame"});
  problem.add_sensor(PinholeCamera{}, {"eye", "camera_optical_frame"});
  problem.add_sensor(ChainPoint{}, {"finger", "finger_right"});
  problem.add_sensor(ChainPoint{}, {"counterweight", "counterweight"});
  return problem;
}

std::vector<double> modelled_values(const ParameterTable& table) {
  std::vector<double> x = test::random_values(table, 0.05, 4);
  double value = 0.02;
  for (const std::string& name : kModelled) {
    x[static_cast<std::size_t>(table.index(name))] = value = -0.9 * value;
  }
  return x;
}

void check(const std::vector<std::string>& sensors, const std::string& base = "base_link") {
  SCOPED_TRACE(sensors[0] + " and " + sensors[1] + ", base " + base);
  Problem packets = modelled_problem<Packet>(base);
  BasicProblem<double> numbers = modelled_problem<double>(base);
  packets.add_block("b", PointToPoint{}, sensors);
  numbers.add_block("b", PointToPoint{}, sensors);
  test::OracleProblem oracle = test::oracle_of(packets);
  oracle.add_block("b", PointToPoint{}, sensors);
  const std::vector<double> x = modelled_values(packets.table());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> side(-0.3, 0.3);
  for (Sample& sample : test::exact_samples(packets, x, 7)) {
    for (const char* name : {"finger", "counterweight"}) {
      Observation& seen = sample.observations.emplace_back(Observation{name, {}, {}});
      for (int i = 0; i < 4; ++i) {
        seen.features.push_back({"", Vector3<double>{side(random), side(random), side(random)}});
      }
    }
    for (auto& feature : sample.observations[0].features) feature.point.x() += 0.01;
    packets.add_sample(sample);
    numbers.add_sample(sample);
    oracle.add_sample(sample);
  }
  const FreeSet all = test::all_free(packets.table());
  const test::OracleRows expected = oracle.rows(x);
  for (const auto& found : {test::rows_of(packets, x, &all), test::rows_of(numbers, x, &all)}) {
    ASSERT_EQ(found.size(), expected.size());
    for (const auto& [key, rows] : expected) {
      test::expect_rows_of_oracle(found.at(key), rows, 1e-12, 1e-12);
    }
  }
  const FreeSet some = test::free_of(
      packets.table(), {"elbow_eccentric_cos", "camera_fx", "torso_joint_gear_ratio", "wrist"});
  for (const FreeSet& free : {all, some}) {
    const NormalEquations reference = oracle.multiplied_out(expected, x, free);
    test::expect_same(normal_equations(packets, x, &free), reference, 1e-10);
    test::expect_same(normal_equations(numbers, x, &free), reference, 1e-10);
  }
}

TEST(JointModels, HaveTheRowsOfTheOracle) {
  check({"camera", "arm"});
  check({"finger", "camera"});          // through joints that mimic
  check({"counterweight", "camera"});   // the same, turning the other way
  check({"arm", "camera"}, "forearm");  // joints passed from child to parent
}

/// Values that Gauss-Newton steps from zero lead to.
Eigen::VectorXd solved(const Problem& problem, const std::vector<std::string>& names) {
  Eigen::VectorXd found = Eigen::VectorXd::Zero(problem.table().size());
  const FreeSet free = test::free_of(problem.table(), names);
  constexpr int kSteps = 8;
  for (int step = 0; step < kSteps; ++step) {
    const NormalEquations sums =
        normal_equations(problem, {found.data(), static_cast<std::size_t>(found.size())}, &free);
    found(free.parameters()) -= sums.hessian.ldlt().solve(sums.gradient);
  }
  return found;
}

/// Problems whose samples are of a robot without errors: a test then changes the positions that its
/// encoders read.
class MeasuredJoints : public ::testing::Test {
 protected:
  MeasuredJoints() {
    robot_ = test::mobile_manipulator();
    robot_.set_weight({{{"forearm", {2.0, {0.1, 0.0, 0.02}}}, {"hand", {1.0, {0.0, 0.05, 0.0}}}},
                       {0.0, 0.0, -9.81},
                       "hand"});
    const Problem exact = problem({});
    const std::vector<double> none(static_cast<std::size_t>(exact.table().size()), 0.0);
    for (const Sample& sample : test::exact_samples(exact, none, 60)) samples_.push_back(sample);
  }

  [[nodiscard]] Problem problem(const std::vector<std::string>& names) const {
    ParameterTable table = test::scene_table();
    for (const std::string& name : names) {
      if (table.find(name) < 0) table.add({.name = name});
    }
    Problem made(robot_, "base_link", table, test::kSceneFrames);
    made.add_sensor(ChainPoint{}, {"arm", "hand"});
    made.add_sensor(DepthCamera{}, {"camera", "camera_optical_frame"});
    made.add_block("b", PointToPoint{}, {"camera", "arm"});
    return made;
  }
  /// What the solution is from samples whose encoders read `change` more.
  template <class Change>
  [[nodiscard]] std::map<std::string, double> found(const std::vector<std::string>& names,
                                                    const Change& change) const {
    Problem of_models = problem(names);
    for (Sample sample : samples_) {
      change(sample);
      of_models.add_sample(sample);
    }
    const Eigen::VectorXd all = solved(of_models, names);
    std::map<std::string, double> by_name;
    for (const std::string& name : names) by_name[name] = all(of_models.table().index(name));
    return by_name;
  }
  static double& position(Sample& sample, const std::string& joint) {
    for (std::size_t i = 0; i < sample.joint_names.size(); ++i) {
      if (sample.joint_names[i] == joint) return sample.joint_positions[i];
    }
    throw std::invalid_argument(joint);
  }

  Robot robot_;
  std::vector<Sample> samples_;
};

TEST_F(MeasuredJoints, OfACoupledWristGiveTheShare) {
  const auto of = found({"wrist", "wrist_coupling_elbow"}, [](Sample& sample) {
    position(sample, "wrist") -= 0.03 * position(sample, "elbow") + 0.01;
  });
  EXPECT_NEAR(of.at("wrist_coupling_elbow"), 0.03, 1e-9);
  EXPECT_NEAR(of.at("wrist"), 0.01, 1e-9);
}

TEST_F(MeasuredJoints, OfAnArmThatSagsGiveItsCompliance) {
  constexpr double kCompliance = 2e-3;
  const auto of = found({"elbow", "elbow_sag"}, [&](Sample& sample) {
    sample.conditions["payload"] = 0.5;
    const double truth = position(sample, "elbow");
    for (int round = 0; round < 50; ++round) {  // the load is that at the measured positions
      GravityLoads loads(
          robot_, [&](const std::string& joint) { return sample.position(joint).value_or(0.0); });
      GravityLoads::ByJoint all = loads.of_links();
      loads.add("hand", Vector3<double>::Zero(), 0.5, all);
      position(sample, "elbow") = truth - kCompliance * all.at("elbow");
    }
  });
  EXPECT_NEAR(of.at("elbow_sag"), kCompliance, 1e-9);
}

TEST_F(MeasuredJoints, OfAGearWithPlayGiveTheGap) {
  int n = 0;
  const auto of = found({"elbow_backlash"}, [&](Sample& sample) {
    const double direction = ++n % 3 == 0 ? -1.0 : 1.0;
    sample.joint_moves.assign(sample.joint_names.size(), 0.2 * direction);
    position(sample, "elbow") += 0.5 * 0.004 * direction;  // the motor leads
  });
  EXPECT_NEAR(of.at("elbow_backlash"), 0.004, 1e-9);
}

TEST_F(MeasuredJoints, OfACameraThatLagsGiveTheTime) {
  int n = 0;
  const auto of = found({"camera_lag", "arm_lag"}, [&](Sample& sample) {
    for (std::size_t i = 0; i < sample.joint_names.size(); ++i) {
      const double velocity = 0.5 * std::sin(1.7 * ++n);
      sample.joint_velocities.push_back(velocity);
      sample.joint_positions[i] -= 0.015 * velocity;
    }
  });
  EXPECT_NEAR(of.at("camera_lag"), 0.015, 1e-6);
  EXPECT_NEAR(of.at("arm_lag"), 0.015, 1e-6);
}

TEST_F(MeasuredJoints, SayWhatASampleLacks) {
  const auto message = [&](const std::string& name) {
    Problem of_models = problem({name});
    return test::thrown<SampleError>(
        [&] {
          Sample sample = samples_.front();
          sample.joint_moves.clear();
          of_models.add_sample(sample);
        },
        "");
  };
  EXPECT_NE(message("camera_lag").find("velocity"), std::string::npos);
  EXPECT_NE(message("elbow_backlash").find("backlash needs samples in the order"),
            std::string::npos);
  EXPECT_NE(message("elbow_sag").find("condition 'payload' is not in the sample"),
            std::string::npos);
  EXPECT_EQ(message("elbow_link_sag_hand"), "");
  robot_.set_weight({});
  EXPECT_THROW((void)problem({"elbow_sag"}), RobotError);
}

/// Ten times a turn.
struct Worm {
  static constexpr std::array<ParameterInfo, 2> kParameters = {
      {{"worm_sin", "rad"}, {"worm_cos", "rad"}}};
  std::array<double, 2> operator()(const JointReading& joint) const {
    return {std::sin(10.0 * joint.position()), std::cos(10.0 * joint.position()) - 1.0};
  }
};

/// Its name is taken.
struct OtherWorm {
  static constexpr std::array<ParameterInfo, 1> kParameters = {{{"worm_sin", "rad"}}};
  std::array<double, 1> operator()(const JointReading&) const { return {0.0}; }
};

TEST_F(MeasuredJoints, HaveModelsOfAUser) {
  register_joint_model(Worm{});
  register_joint_model(Worm{});
  const auto of = found({"elbow_worm_sin", "elbow_worm_cos"}, [&](Sample& sample) {
    const double truth = position(sample, "elbow");
    for (int round = 0; round < 50; ++round) {
      const double q = position(sample, "elbow");
      position(sample, "elbow") = truth - 0.001 * std::sin(10 * q) - 0.002 * (std::cos(10 * q) - 1);
    }
  });
  EXPECT_NEAR(of.at("elbow_worm_sin"), 0.001, 1e-9);
  EXPECT_NEAR(of.at("elbow_worm_cos"), 0.002, 1e-9);
  EXPECT_THROW(register_joint_model(OtherWorm{}), std::invalid_argument);
}

TEST_F(MeasuredJoints, MoveAsTheHeaderForDriversSays) {
  const std::vector<std::pair<std::string, double JointErrors::*>> all = {
      {"elbow", &JointErrors::offset},
      {"elbow_gear_ratio", &JointErrors::gear_ratio},
      {"elbow_eccentric_sin", &JointErrors::eccentric_sin},
      {"elbow_eccentric_cos", &JointErrors::eccentric_cos},
      {"elbow_second_harmonic_sin", &JointErrors::second_harmonic_sin},
      {"elbow_second_harmonic_cos", &JointErrors::second_harmonic_cos},
      {"elbow_sag", &JointErrors::sag},
      {"elbow_backlash", &JointErrors::backlash},
      {"elbow_load_backlash", &JointErrors::load_backlash}};
  std::vector<std::string> names = {"elbow_coupling_wrist", "elbow_link_sag_hand"};
  for (const auto& [name, member] : all) names.push_back(name);
  const Problem of_models = problem(names);
  const SampledChain& chain = of_models.sensors()[0].chains()[0];
  Sample sample = samples_[3];
  sample.joint_moves.assign(sample.joint_names.size(), -0.3);
  GravityLoads loads(
      robot_, [&](const std::string& joint) { return sample.position(joint).value_or(0.0); });
  GravityLoads::ByJoint of_kilogram;
  loads.add("hand", Vector3<double>::Zero(), 1.0, of_kilogram);
  constexpr double kCoupling = 0.02, kLinkSag = 0.003;
  const MeasuredJoint measured{
      position(sample, "elbow"), loads.of_links().at("elbow"), -1.0,
      kCoupling * position(sample, "wrist") + kLinkSag * of_kilogram.at("elbow")};
  JointErrors errors;
  std::vector<double> values(static_cast<std::size_t>(of_models.table().size()), 0.0);
  values[static_cast<std::size_t>(of_models.table().index(names[0]))] = kCoupling;
  values[static_cast<std::size_t>(of_models.table().index(names[1]))] = kLinkSag;
  double value = 0.01;
  for (const auto& [name, member] : all) {
    errors.*member = value = -0.9 * value;
    values[static_cast<std::size_t>(of_models.table().index(name))] = value;
  }
  const Corrections<double> corrections = corrections_for<double>(chain.parameters(), values);
  Sample moved = sample;  // read by an encoder without errors
  position(moved, "elbow") = true_position(errors, measured);
  const Problem without = problem({});
  const SampledChain& plain = without.sensors()[0].chains()[0];
  const std::vector<double> none(static_cast<std::size_t>(without.table().size()), 0.0);
  const Pose<double> expected = plain.tip(moved, corrections_for<double>(plain.parameters(), none));
  EXPECT_LT((chain.tip(sample, corrections).translation - expected.translation).norm(), 1e-12);
}

TEST_F(MeasuredJoints, AMimicJointHasErrorsOfItsOwn) {
  const Robot& robot = robot_;
  const auto of = joint_model_parameter(robot, "elbow_mimic_offset");
  ASSERT_TRUE(of.has_value());
  EXPECT_EQ(of->fault, "does not mimic another");
  EXPECT_EQ(joint_model_parameter(robot, "torso_joint_eccentric_sin")->fault,
            "slides; only a joint that rotates has this parameter");
  EXPECT_EQ(joint_model_parameter(robot, "elbow_coupling_torso_joint")->unit, "rad/m");
  EXPECT_EQ(joint_model_parameter(robot, "torso_joint_sag")->unit, "m/N");
  EXPECT_FALSE(joint_model_parameter(robot, "elbow_coupling_nothing").has_value());
}

TEST(JointModels, AreRecoveredByGaussNewtonSteps) {
  Problem problem = modelled_problem<Packet>();
  problem.add_block("b", PointToPoint{}, {"camera", "arm"});
  const ParameterTable& table = problem.table();
  const std::vector<std::string> names = {"elbow", "elbow_gear_ratio", "elbow_eccentric_sin",
                                          "shoulder_pan_eccentric_sin"};
  std::vector<double> truth(static_cast<std::size_t>(table.size()), 0.0);
  double value = 0.03;
  for (const std::string& name : names) {
    truth[static_cast<std::size_t>(table.index(name))] = value = -0.8 * value;
  }
  for (const Sample& sample : test::exact_samples(problem, truth, 60)) problem.add_sample(sample);
  const Eigen::VectorXd found = solved(problem, names);
  for (const std::string& name : names) {
    const int i = table.index(name);
    EXPECT_NEAR(found(i), truth[static_cast<std::size_t>(i)], 1e-8) << name;
  }
}

}  // namespace
}  // namespace kinecal
