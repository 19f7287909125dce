// Columns of tables by their names and values, and what is refused rather than guessed.
#include "kinecal/tools/init/proposed_columns.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "support/paths.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const Robot& ur5e() {
  static const Robot robot = read_urdf(test::source_folder() + "/examples/robots/ur5e/ur5e.urdf");
  return robot;
}

std::string columns_of(const std::string& table) {
  return proposed_columns(ur5e(), table, "log.csv");
}

std::string refusal_of(const std::string& table) {
  return test::thrown<InputError>([&] { (void)columns_of(table); }, "");
}

constexpr const char* kSix = "0.1,0.2,0.3,0.4,0.5,0.6";

TEST(ProposedColumns, AreJointsByTheirNamesInTheUrdf) {
  const std::string text = columns_of(
      "time,wrist_3_joint,shoulder_pan_joint,position.shoulder_lift_joint,Elbow [rad],wrist 1 "
      "pos,wrist_2_joint_position,"
      "wrist_2_joint_velocity,x,y,z\n1,6,1,2,3,4,5,9,1,2,3\n2,6,1,2,3,4,5,9,1,2,3\n");
  EXPECT_THAT(text, AllOf(HasSubstr("shoulder_pan_joint: shoulder_pan_joint\n"),
                          HasSubstr("shoulder_lift_joint: position.shoulder_lift_joint\n"),
                          HasSubstr("elbow_joint: \"Elbow [rad]\"\n"),
                          HasSubstr("wrist_1_joint: \"wrist 1 pos\"\n"),
                          HasSubstr("wrist_2_joint: wrist_2_joint_position\n"),
                          HasSubstr("wrist_3_joint: wrist_3_joint\n")));
  EXPECT_THAT(text, HasSubstr("# Not used: time, wrist_2_joint_velocity\n"));
}

TEST(ProposedColumns, AreJointsByNumbersOfAnArm) {
  for (const char* header :
       {"q1,q2,q3,q4,q5,q6", "actual_q_0,actual_q_1,actual_q_2,actual_q_3,actual_q_4,actual_q_5",
        "J1,J2,J3,J4,J5,J6"}) {
    const std::string text =
        columns_of(std::string(header) + ",x,y,z\n" + kSix + ",1,2,3\n" + kSix + ",1,2,3\n");
    const std::string first = std::string(header).substr(0, std::string(header).find(','));
    EXPECT_THAT(text, HasSubstr("shoulder_pan_joint: " + first + "\n"));
    EXPECT_THAT(text, AllOf(HasSubstr("unit: radians  # by its values, up to 0.6\n"),
                            HasSubstr("- [x, \"y\", z]")));
  }
  EXPECT_THAT(
      refusal_of("q1,q2,q3,x,y,z\n1,2,3,1,2,3\n1,2,3,1,2,3\n"),
      HasSubstr("log.csv: has 3 columns q1 ..., and no arm of the URDF has as many joints"));
}

TEST(ProposedColumns, HaveUnitsByNamesElseByValues) {
  const std::string table = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,x [mm],y [mm],z [mm]\n";
  const std::string text = columns_of(table + kSix + ",1,2,3\n" + kSix + ",1,2,3\n");
  EXPECT_THAT(text, AllOf(HasSubstr("unit: degrees\n"), HasSubstr("unit: millimetres\n")));
  const std::string by_values =
      columns_of("q1,q2,q3,q4,q5,q6,x,y,z\n90,2,3,4,5,6,1000,2,3\n90,2,3,4,5,6,1000,2,3\n");
  EXPECT_THAT(by_values, AllOf(HasSubstr("unit: degrees  # by its values, up to 90\n"),
                               HasSubstr("unit: millimetres  # by its values, up to 1000\n")));
}

TEST(ProposedColumns, AreVelocitiesOfAllJoints) {
  const auto table = [](const std::string& names, const std::string& values = kSix) {
    const std::string row = std::string(kSix) + "," + values + ",1,2,3\n";
    return "q1,q2,q3,q4,q5,q6," + names + ",x,y,z\n" + row + row;
  };
  const std::string text = columns_of(table("dq1,dq2,dq3,dq4,dq5,dq6"));
  EXPECT_THAT(text, HasSubstr("\nvelocities:\n  unit: rad/s  # like the positions; the header does "
                              "not say\n  columns:\n    shoulder_pan_joint: dq1\n"));
  EXPECT_THAT(text, AllOf(HasSubstr("wrist_3_joint: dq6\n"), Not(HasSubstr("Not used"))));
  EXPECT_THAT(
      columns_of(table("qd1 [deg/s],qd2 [deg/s],qd3 [deg/s],qd4 [deg/s],qd5 [deg/s],"
                       "qd6 [deg/s]")),
      AllOf(HasSubstr("unit: deg/s\n"), HasSubstr("shoulder_pan_joint: \"qd1 [deg/s]\"\n")));
  EXPECT_THAT(columns_of(table("dq1,dq2,dq3,dq4,dq5,dq6", "1,2,3,4,5,nan")),
              AllOf(Not(HasSubstr("velocities")), HasSubstr("# Not used: dq1, dq2")))
      << "a row without a velocity would be an error";
}

TEST(ProposedColumns, AreVelocitiesByNamesOfJoints) {
  std::string header, row;
  for (const char* joint : {"shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2"}) {
    header += fmt::format("{0}_joint,{0}_velocity,", joint);
    row += "90,1,";
  }
  const std::string rows = row + "90,1,1,2,3\n" + row + "90,1,1,2,3\n";
  const std::string text = columns_of(header + "wrist_3_joint,wrist_3_vel,x,y,z\n" + rows);
  EXPECT_THAT(text, AllOf(HasSubstr("unit: deg/s  # like the positions"),
                          HasSubstr("shoulder_pan_joint: shoulder_pan_velocity\n"),
                          HasSubstr("wrist_3_joint: wrist_3_vel\n")));
}

TEST(ProposedColumns, ArePointsOfTheTrackerNotOfTheController) {
  const std::string header = "q1,q2,q3,q4,q5,q6,";
  const auto table = [&](const std::string& names) {
    const std::string row = std::string(kSix) + ",1,2,3,4,5,6\n";
    return header + names + "\n" + row + row;
  };
  EXPECT_THAT(columns_of(table("tcp_x,tcp_y,tcp_z,leica_x,leica_y,leica_z")),
              HasSubstr("- [leica_x, leica_y, leica_z]"));
  EXPECT_THAT(columns_of(table("target_x,target_y,target_z,dif_x,dif_y,dif_z")),
              HasSubstr("- [[target_x, dif_x], [target_y, dif_y], [target_z, dif_z]]"));
  EXPECT_THAT(
      columns_of(table("x1,y1,z1,x2,y2,z2")),
      AllOf(HasSubstr("frame: smr_1\n"), HasSubstr("frame: smr_2\n"), HasSubstr("- [x2, y2, z2]")));
  EXPECT_THAT(refusal_of(table("a_x,a_y,a_z,b_x,b_y,b_z")),
              HasSubstr("both 'a_x' and 'b_x' may begin the point"));
  EXPECT_THAT(refusal_of(table("rx,ry,rz,qx,qy,qz")),
              HasSubstr("no three columns are called x, y, z"));
}

TEST(ProposedColumns, OfATableWhoseFirstRowIsData) {
  const std::string row = "0.1 0.2 0.3 0.4 0.5 0.6 1 2 3\n";
  const std::string text = columns_of(row + row);
  EXPECT_THAT(text, AllOf(HasSubstr("separator: space\n"), HasSubstr("header: false\n"),
                          HasSubstr("shoulder_pan_joint: 1\n"), HasSubstr("- [7, 8, 9]")));
  EXPECT_THAT(refusal_of("1,2,3,4\n1,2,3,4\n"),
              HasSubstr("log.csv: its first row has no names, and its 4 columns"));
}

TEST(ProposedColumns, RefuseWhatTheyWouldHaveToGuess) {
  const std::string header = "q1,q2,q3,q4,q5,q6,", row = std::string(kSix) + ",1,2,3\n";
  EXPECT_THAT(refusal_of(header + "x [cm],y [cm],z [cm]\n" + row + row),
              HasSubstr("log.csv: column 'x [cm]' looks like one in cm"));
  EXPECT_THAT(refusal_of("pan,shoulder_lift,elbow,wrist_1,wrist_2,wrist_3,x,y,z\n" + row + row),
              HasSubstr("5 of the 6 joints that move 'reflector' have a column, and "
                        "'shoulder_pan_joint' has none"));
}

TEST(ProposedColumns, ReadADecimalCommaBetweenSemicolons) {
  const std::string row = "0,1;0,2;0,3;0,4;0,5;0,6;1,5;2;3\n";
  EXPECT_THAT(columns_of("q1;q2;q3;q4;q5;q6;x;y;z\n" + row + row),
              AllOf(HasSubstr("separator: semicolon\n"),
                    HasSubstr("unit: radians  # by its values, up to 0.6\n")));
}

TEST(ProposedColumns, TakeUnitsOfARowBelowTheHeaderAndPassComments) {
  const std::string row = std::string(kSix) + ",1,2,3\n";
  EXPECT_THAT(
      columns_of("# session 7\nq1,q2,q3,q4,q5,q6,x,y,z\ndeg,deg,deg,deg,deg,deg,mm,mm,mm\n" + row +
                 row),
      AllOf(HasSubstr("joints:\n  unit: degrees\n"), HasSubstr("unit: millimetres\n"),
            HasSubstr("shoulder_pan_joint: q1\n")));
  EXPECT_THAT(refusal_of("# session 7\nk1,k2,k3,k4,k5,k6,x,y,z\n" + row + row),
              HasSubstr("line 2 was read as the header: 'k1, k2, k3"));
}

TEST(ProposedColumns, AskWhichOfTwoPointsWasMeasured) {
  const std::string head = "q1,q2,q3,q4,q5,q6,", row = std::string(kSix) + ",1,2,3";
  EXPECT_THAT(refusal_of(head + "X,Y,Z,TX,TY,TZ\n" + row + ",4,5,6\n" + row + ",4,5,6\n"),
              AllOf(HasSubstr("both 'X' and 'TX'"), HasSubstr("computed")));
  EXPECT_THAT(columns_of(head + "TX,TY,TZ\n" + row + "\n" + row + "\n"), HasSubstr("[TX, TY, TZ]"));
  EXPECT_THAT(columns_of(head + "x,y,z,fx,fy,fz,tx,ty,tz\n" + row + ",4,5,6,7,8,9\n" + row +
                         ",4,5,6,7,8,9\n"),
              HasSubstr("[x, \"y\", z]"))
      << "torques";
}

/// A number of the row is no socket, and a gyroscope no accelerometer.
TEST(ProposedColumns, AreOfWhatATipTouched) {
  const std::string joints = "q1,q2,q3,q4,q5,q6";
  const auto rows = [&](const std::vector<std::string>& more) {
    std::string text;
    for (const std::string& cells : more) text += std::string(kSix) + "," + cells + "\n";
    return text;
  };
  EXPECT_THAT(refusal_of(joints + ",point\n" + rows({"1", "2", "3", "4"})),
              HasSubstr("say what the tip touched in each row: --target with one of point"));
  EXPECT_THAT(columns_of(joints + ",socket\n" + rows({"A", "B", "A", "B"})),
              AllOf(HasSubstr("frame: socket  # and the cell: socket_A"),
                    HasSubstr("frame_column: socket"), HasSubstr("constant: [0, 0, 0]")));
  const std::string imu =
      joints + ",ax,ay,az,gx,gy,gz\n" + rows({"0,0,9.8,1,2,3", "0,9.8,0,1,2,3"});
  EXPECT_THAT(
      proposed_columns(ur5e(), imu, "log.csv", InitTarget::gravity),
      AllOf(HasSubstr("ax: ax\n"), HasSubstr("az: az\n"), HasSubstr("Not used: gx, gy, gz")));
  EXPECT_THAT(proposed_columns(ur5e(), joints + ",gauge_mm\n" + rows({"101", "250"}), "log.csv",
                               InitTarget::distance),
              AllOf(HasSubstr("unit: millimetres"), HasSubstr("points: [[0, 0, gauge_mm]]")));
}

TEST(ProposedColumns, RefuseWhatIsNoTable) {
  EXPECT_THAT(refusal_of(""), HasSubstr("log.csv: is not a table"));
  EXPECT_THAT(refusal_of("a,b\nc,d\ne,f\n"),
              HasSubstr("no column has the name of a joint (shoulder_pan_joint"));
}

}  // namespace
}  // namespace kinecal
