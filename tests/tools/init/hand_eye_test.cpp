#include "kinecal/tools/init/hand_eye.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/files/csv/read_csv_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class HandEyeColumns : public test::FolderTest {
 protected:
  /// The proposal for a table of poses.
  std::string columns(const std::string& table, const std::string& form = "") {
    write("poses.csv", table);
    HandEyeTables tables{path("poses.csv"), form};
    return hand_eye_columns(tables, folder_.string());
  }
  /// The samples that it gives.
  std::vector<Sample> samples(const std::string& text) {
    write("columns.yaml", text);
    Diagnostics diagnostics;
    const CsvMapping mapping = read_csv_mapping(path("columns.yaml"), diagnostics, CsvUse::joints);
    auto read = csv_samples(FolderTest::read("poses.csv"), mapping, "poses.csv", diagnostics);
    EXPECT_THAT(diagnostics.errors, IsEmpty()) << text;
    return read;
  }
  [[nodiscard]] std::string path(const char* name) const { return (folder_ / name).string(); }
};

TEST(HandEyeUrdf, HasTheCameraOnTheHandOrBesideTheRobot) {
  for (const bool on_hand : {true, false}) {
    const Robot robot = parse_urdf(hand_eye_urdf(on_hand), "hand_eye.urdf");
    EXPECT_EQ(robot.joint("flange_joint").type, JointType::floating);
    EXPECT_EQ(make_chain(robot, "base_link", "camera").joints.size(), on_hand ? 6u : 0u);
    EXPECT_EQ(make_chain(robot, "base_link", "flange").joints.size(), 6u);
  }
}

TEST_F(HandEyeColumns, FindsColumnsByTheirNamesWhateverTheirOrder) {
  const auto read =
      samples(columns("image,qw,qx,qy,qz,x,y,z\n0.png,0.8,0.6,0,0,1,2,3\n1.png,1,0,0,0,4,5,6\n"));
  ASSERT_EQ(read.size(), 2u);
  const Pose<double>& pose = read[0].poses.at("flange_joint");
  EXPECT_EQ(pose.translation, Vector3<double>(1, 2, 3));
  EXPECT_NEAR(pose.rotation(2, 1), 0.96, 1e-15);
}

TEST_F(HandEyeColumns, KnowsControllersByTheirLettersAndUnitsByNamesOrValues) {
  const std::string kuka = columns("X;Y;Z;A;B;C\n589.1;20;300;90;0;0\n1;2;3;4;5;6\n");
  EXPECT_THAT(kuka, HasSubstr("form: kuka"));
  EXPECT_THAT(kuka, HasSubstr("separator: semicolon"));
  EXPECT_NEAR(samples(kuka).at(0).poses.at("flange_joint").rotation(1, 0), 1.0, 1e-15);
  EXPECT_NEAR(samples(kuka).at(0).poses.at("flange_joint").translation.x(), 0.5891, 1e-15);
  const std::string fanuc = columns("X,Y,Z,W,P,R\n589,0,0,90,0,0\n1,2,3,4,5,6\n");
  EXPECT_THAT(fanuc, HasSubstr("form: fanuc"));
  EXPECT_NEAR(samples(fanuc).at(0).poses.at("flange_joint").rotation(2, 1), 1.0, 1e-15);
  const std::string ur = columns("x,y,z,rx,ry,rz\n0.5,0,0,0,3.1,0\n0.5,0.1,0,0,2,1\n");
  EXPECT_THAT(ur, HasSubstr("form: rotation_vector"));
  EXPECT_THAT(ur, HasSubstr("unit: metres"));
  EXPECT_THAT(ur, HasSubstr("angles: radians"));
  const std::string rpy = columns("x_mm,y_mm,z_mm,roll,pitch,yaw\n0.5,0,0,10,20,30\n1,2,3,4,5,6\n");
  EXPECT_THAT(rpy, HasSubstr("form: rpy"));
  EXPECT_THAT(rpy, HasSubstr("unit: millimetres"));
  EXPECT_THAT(rpy, HasSubstr("angles: degrees"));
}

TEST_F(HandEyeColumns, ATableWithoutNamesNeedsTheForm) {
  const std::string table = "0.5,0,0,0,3.1,0\n0.5,0.1,0,0,2,1\n";
  EXPECT_THROW((void)columns(table), InputError);
  EXPECT_EQ(samples(columns(table, "ur")).size(), 2u);
  EXPECT_THAT(test::thrown<InputError>([&] { (void)columns(table, "quaternion_xyzw"); }),
              HasSubstr("the form has 7 columns: x y z qx qy qz qw"));
  EXPECT_THAT(test::thrown<InputError>([&] { (void)columns(table, "url"); }),
              HasSubstr("did you mean 'ur'?"));
}

TEST_F(HandEyeColumns, AMatrixIsKnownByItsTwelveOrSixteenNumbers) {
  const std::string row = "1,0,0,0.5,0,0,-1,0.1,0,1,0,0.3";
  const auto twelve = samples(columns(row + "\n" + row + "\n"));
  ASSERT_EQ(twelve.size(), 2u);
  EXPECT_EQ(twelve[0].poses.at("flange_joint").translation, Vector3<double>(0.5, 0.1, 0.3));
  EXPECT_EQ(samples(columns("7," + row + ",0,0,0,1\n8," + row + ",0,0,0,1\n", "matrix")).size(), 2u)
      << "after the number of the row";
}

TEST_F(HandEyeColumns, CornersAndTheBoardComeFromTablesOfTheirOwn) {
  write("corners.csv", "image,id,u,v\n0,4,10,20\n");
  write("target.csv", "id,x,y,z\n4,36.2,72.4,0\n");
  write("poses.csv", "image,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1,0,0,1,0,0,0,1\n");
  HandEyeTables tables{path("poses.csv")};
  tables.corners = path("corners.csv");
  EXPECT_THROW((void)hand_eye_columns(tables, folder_.string()), InputError) << "no board";
  tables.target = path("target.csv");
  write("columns.yaml", hand_eye_columns(tables, folder_.string()));
  Diagnostics diagnostics;
  const auto read = read_csv_samples(path("poses.csv"), path("columns.yaml"), diagnostics);
  ASSERT_THAT(diagnostics.errors, IsEmpty());
  ASSERT_FALSE(read.empty());
  EXPECT_EQ(read[0].observation("camera")->features.at(0).point, Vector3<double>(10, 20, 0));
  EXPECT_LE((read[0].observation("arm")->features.at(0).point - Vector3<double>(0.0362, 0.0724, 0))
                .norm(),
            1e-15);
}

}  // namespace
}  // namespace kinecal
