#include "kinecal/tools/init/hand_eye.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <fstream>
#include <functional>
#include <numbers>
#include <tuple>

#include "kinecal/files/csv/read_csv_samples.hpp"
#include "kinecal/files/poses/pose_table.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/tools/init/hand_eye_fit.hpp"
#include "support/hand_eye_poses.hpp"
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
    return columns_of(tables);
  }
  /// The proposal for tables; its doubts are in doubts_.
  std::string columns_of(const HandEyeTables& tables) {
    Diagnostics diagnostics;
    std::string text = hand_eye_columns(tables, folder_.string(), diagnostics);
    doubts_ = diagnostics.doubts;
    return text;
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

  std::vector<std::string> doubts_;
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

TEST_F(HandEyeColumns, DegreesOrLongVectorsAreAnglesAboutAxes) {
  const std::string head = "x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg\n";
  EXPECT_THAT(columns(head + "663,365,388,-161,-5,149\n413,425,431,-165,24,161\n"),
              HasSubstr("form: fixed_xyz  # no rotation vector: they would be up to 232 deg long"));
  EXPECT_THAT(columns(head + "663,365,388,61,-5,14\n413,425,431,65,24,16\n"),
              HasSubstr("form: fixed_xyz  # a guess"));
  const std::string radians =
      columns("x,y,z,rx,ry,rz\n.6,.3,.3,-2.8,-.1,2.6\n.4,.4,.4,-2.9,.4,2.8\n");
  EXPECT_THAT(radians, HasSubstr("form: fixed_xyz  # no rotation vector"));
  EXPECT_THAT(columns(head + "663,365,388,-161,-5,149\n413,425,431,-165,24,161\n", "ur"),
              HasSubstr("form: ur\n"))
      << "as it is given";
}

/// A table of poses of the flange and of a marker in the camera.
std::string table_of(const test::HandEyePoses& poses, const std::string& head,
                     const std::function<Vector3<double>(const Matrix3<double>&)>& angles) {
  std::string text = head + ",marker_x,marker_y,marker_z,marker_qx,marker_qy,marker_qz,marker_qw\n";
  for (std::size_t i = 0; i < poses.flange.size(); ++i) {
    const Vector3<double> p = 1e3 * poses.flange[i].translation,
                          a = angles(poses.flange[i].rotation) * (180.0 / std::numbers::pi),
                          t = poses.object[i].translation;
    const Eigen::Quaterniond q(Eigen::Matrix3d(poses.object[i].rotation));
    text += fmt::format(
        "{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.7f},{:.7f},{:.7f},{:.7f},{:.7f},{:.7f},{:.7f}"
        "\n",
        p.x(), p.y(), p.z(), a.x(), a.y(), a.z(), t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  return text;
}

TEST_F(HandEyeColumns, PosesOfAMarkerTellTheFormOfTheAngles) {
  const auto euler = [](int i, int j, int k) {
    return [=](const Matrix3<double>& r) -> Vector3<double> {
      return Eigen::Matrix3d(r).eulerAngles(i, j, k);
    };
  };
  const auto vector = [](const Matrix3<double>& r) -> Vector3<double> { return log(r); };
  const auto fixed = [](const Matrix3<double>& r) -> Vector3<double> {
    return rpy_from_rotation(r);
  };
  const std::vector<
      std::tuple<const char*, const char*, std::function<Vector3<double>(const Matrix3<double>&)>>>
      cases = {{"x,y,z,a,b,c", "euler_zyz", euler(2, 1, 2)},  // Doosan, with KUKA's letters
               {"x,y,z,a,b,c", "kuka", euler(2, 1, 0)},       // KUKA
               {"tcp_x,tcp_y,tcp_z,tcp_rx,tcp_ry,tcp_rz", "fixed_xyz", fixed},
               {"x,y,z,rx,ry,rz", "rotation_vector", vector},     // UR, in degrees
               {"x,y,z,rx,ry,rz", "euler_xyz", euler(0, 1, 2)}};  // Staubli
  for (const bool on_hand : {true, false}) {
    for (const auto& [head, form, angles] : cases) {
      const test::HandEyePoses poses(on_hand, 12, 5);
      write("poses.csv", table_of(poses, head, angles));
      HandEyeTables tables{path("poses.csv")};
      tables.has_marker = true;
      tables.camera_on_hand = on_hand;
      const std::string text = columns_of(tables);
      EXPECT_THAT(text, HasSubstr(fmt::format("form: {}  # poses fit to 0.", form)));
      EXPECT_THAT(doubts_, IsEmpty());
      write("columns.yaml", text);
      Diagnostics diagnostics;
      const auto read = read_csv_samples(path("poses.csv"), path("columns.yaml"), diagnostics);
      ASSERT_THAT(diagnostics.errors, IsEmpty());
      const HandEyeFit fit = fit_hand_eye(read, on_hand);
      EXPECT_LE((fit.mount.translation - poses.mount.translation).norm(), 2e-2)
          << "5 mrad of noise";
      tables.form = std::string(form) == "euler_zyz" ? "euler_xyz" : "euler_zyz";
      EXPECT_THAT(columns_of(tables), HasSubstr("form: " + tables.form));
      EXPECT_THAT(doubts_, testing::ElementsAre(HasSubstr("meant?")))
          << "a given form is kept, with a doubt";
    }
  }
}

TEST_F(HandEyeColumns, AskWhichPoseIsTheMarkers) {
  write("poses.csv",
        "a_x,a_y,a_z,a_qx,a_qy,a_qz,a_qw,b_x,b_y,b_z,b_qx,b_qy,b_qz,b_qw\n1,2,3,0,0,0,1,1,2,3,0,0,"
        "0,1\n");
  HandEyeTables tables{path("poses.csv")};
  tables.has_marker = true;
  try {
    (void)columns_of(tables);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::AllOf(HasSubstr("poses begin at a_x, b_x"),
                                         HasSubstr("marker_x"), HasSubstr("easy_handeye2")));
  }
}

TEST_F(HandEyeColumns, PosesOfUrAreCells) {
  const std::string text =
      "image;pose\n1.png;p[0.1, -0.2, 0.3, 0, 3.1, 0]\n2.png;p[0.1, 0.2, 0.3, 1, 2, 0]\n";
  write("poses.csv", text);
  HandEyeTables tables{path("poses.csv")};
  write("columns.yaml", columns_of(tables));
  EXPECT_THAT(FolderTest::read("columns.yaml"), HasSubstr("form: rotation_vector\n"));
  Diagnostics diagnostics;
  const CsvMapping mapping = read_csv_mapping(path("columns.yaml"), diagnostics, CsvUse::joints);
  for (const char* same :
       {text.c_str(), "p[0.1, -0.2, 0.3, 0, 3.1, 0]\np[0.1, 0.2, 0.3, 1, 2, 0]\n",
        "image,pose\n1.png,\"p[0.1, -0.2, 0.3, 0, 3.1, 0]\"\n2.png,\"p[0.1, 0.2, 0.3, 1, 2, "
        "0]\"\n"}) {
    write("poses.csv", same);
    CsvMapping of = mapping;
    of.separator = std::string_view(same).find(';') != std::string_view::npos ? ';' : ',';
    const auto read = csv_samples(read_pose_table(path("poses.csv")), of, "poses.csv", diagnostics);
    ASSERT_THAT(diagnostics.errors, IsEmpty()) << same;
    ASSERT_EQ(read.size(), 2u);
    EXPECT_EQ(read[0].poses.at("flange_joint").translation, Vector3<double>(0.1, -0.2, 0.3));
  }
}

TEST_F(HandEyeColumns, AFolderHasOnePosePerFileOfAnyEnding) {
  for (const char* ending : {".pose", ".csv", ".dat", ""}) {
    const test::TemporaryFolder folder;
    std::ofstream(folder.path() / (std::string("2") + ending)) << "# mm\np[1, 2, 3, 0, 0, 1]\n";
    std::ofstream(folder.path() / (std::string("10") + ending)) << "4 5 6\n0 0 2\n";
    std::ofstream(folder.path() / "2.png") << "image";
    EXPECT_EQ(read_pose_table(folder.path().string()),
              "image,1,2,3,4,5,6\n\"2\",1,2,3,0,0,1\n\"10\",4,5,6,0,0,2\n")
        << ending;
    HandEyeTables tables{folder.path().string(), "ur"};
    EXPECT_THAT(columns_of(tables), HasSubstr("header: true\n"));
    EXPECT_THAT(columns_of(tables), HasSubstr("[\"1\", \"2\", \"3\", \"4\", \"5\", \"6\"]"));
  }
}

TEST_F(HandEyeColumns, CornersOfCamerasAloneAreSamples) {
  write("target.csv", "id,x,y,z\n4,0,0,0\n5,30,0,0\n");
  write("corners.csv",
        "# found by another "
        "program\nimage;camera;id;u;v\na.png;left;4;10,5;20\na.png;right;5;12,5;20\nb.png;left;5;"
        "30,5;20\n");
  const auto samples = corner_samples(path("corners.csv"), path("target.csv"), {"left", "right"});
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(samples[0].observation("board")->features.at(1).point, Vector3<double>(0.03, 0.0, 0.0));
  EXPECT_EQ(samples[0].observation("left")->features.at(0).point, Vector3<double>(10.5, 20.0, 0.0));
  EXPECT_EQ(samples[0].observation("right")->features.at(0).id, 5);
  EXPECT_EQ(samples[1].observation("right"), nullptr);
  EXPECT_THROW((void)corner_samples(path("corners.csv"), path("target.csv"), {"left", "up"}),
               InputError);
  write("target.csv", "id,x,y,z\n4,0,0,0\n");
  EXPECT_THROW((void)corner_samples(path("corners.csv"), path("target.csv"), {"left", "right"}),
               InputError)
      << "a corner that is not on the board";
}

TEST_F(HandEyeColumns, CornersAndTheBoardComeFromTablesOfTheirOwn) {
  write("corners.csv", "image,id,u,v\n0,4,10,20\n");
  write("target.csv", "id,x,y,z\n4,36.2,72.4,0\n");
  write("poses.csv", "image,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1,0,0,1,0,0,0,1\n");
  HandEyeTables tables{path("poses.csv")};
  tables.corners = {{"camera", path("corners.csv")}};
  EXPECT_THROW((void)columns_of(tables), InputError) << "no board";
  tables.target = path("target.csv");
  write("columns.yaml", columns_of(tables));
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
