// kinecal rpy: what a user copies from a calibration into a URDF.
#include "kinecal/geometry/rpy.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

class Rpy : public test::ProgramTest {
 protected:
  [[nodiscard]] test::Outcome run(const std::string& arguments) const {
    return ProgramTest::run(test::kinecal_program() + " rpy " + arguments);
  }
  /// The three numbers behind a title.
  static Vector3<double> after(const std::string& title, const std::string& text) {
    std::istringstream rest(text.substr(text.find(title) + title.size()));
    Vector3<double> v;
    rest >> v.x() >> v.y() >> v.z();
    return v;
  }
};

TEST_F(Rpy, PrintsEveryDigitAndDegrees) {
  const test::Outcome result = run("0.1 -0.2 0.30000000000000004");
  EXPECT_EQ(result.code, 0) << result.err;
  const Vector3<double> v(0.1, -0.2, 0.30000000000000004);
  EXPECT_EQ(after("rotation vector, rad", result.out), v);
  constexpr double kFused = 1e-15;  // the program may have been compiled for another level
  EXPECT_LE((after("roll, pitch, yaw, rad", result.out) - rpy_from_rotation(exp(v))).norm(),
            kFused);
  EXPECT_THAT(result.out, HasSubstr("rotation vector, rad  0.1 -0.2 0.30000000000000004\n"));
  EXPECT_THAT(result.out, HasSubstr("rotation vector, deg  5.729578 -11.459156 17.188734"));
}

TEST_F(Rpy, PrintsTheResultAloneForPrograms) {
  EXPECT_EQ(run("-0.5 0 0 --comma").out, "-0.5, 0, 0\n");
  EXPECT_EQ(run("--to-vector 0 0 0 --comma").out, "0, 0, 0\n");
}

TEST_F(Rpy, ThereAndBackIsTheSameRotation) {
  const Vector3<double> there = after("roll, pitch, yaw, rad", run("-1.2 -.5 -3e-1").out);
  std::ostringstream numbers;
  numbers.precision(17);
  numbers << there.transpose();
  const Vector3<double> back =
      after("rotation vector, rad", run("--to-vector " + numbers.str()).out);
  constexpr double kRounding = 1e-14;
  EXPECT_LE((back - Vector3<double>(-1.2, -0.5, -0.3)).norm(), kRounding);
}

TEST_F(Rpy, RefusesWhatIsNotThreeNumbers) {
  EXPECT_THAT(run("1 2").err, HasSubstr("3"));
  EXPECT_EQ(run("1 2").code, 1);
  EXPECT_EQ(run("1 2 3 4").code, 1);
  EXPECT_EQ(run("").code, 1);
  EXPECT_EQ(run("1 2 nan").code, 1);
  EXPECT_EQ(run("1 2 -inf").code, 1);
  EXPECT_THAT(run("1e308 0 0").err, HasSubstr("error: '1e308' is too large for an angle"));
  EXPECT_THAT(run("1 2 3deg").err, HasSubstr("error: '3deg' is not a finite number"));
}

}  // namespace
}  // namespace kinecal
