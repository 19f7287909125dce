// Samples from tables: every column where it belongs, every error with its place and name.
#include "kinecal/files/csv/read_csv_samples.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <clocale>
#include <locale>
#include <numbers>

#include "support/paths.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

const char* const kMapping = R"(joints:
  unit: degrees
  columns: {pan: q1, tilt: q2}
sliding:
  unit: millimetres
  columns: {lift: [l, dl]}
observations:
 - sensor: arm
   frame: smr
   constant: [0, 0.5, 0]
 - sensor: tracker
   frame: tracker_frame
   unit: millimetres
   points: [[x, y, z], [[x, dx], [y, dy], [z, dz]]]
 - sensor: camera
   frame: optical
   pixels: [[u, v]]
)";

const char* const kTable =
    "q1,q2,l,dl,x,y,z,dx,dy,dz,u,v\n"
    "90,-45,100,0.5,1000.1,2,3,0.1,0.2,0.3,320.5,240\n";

class ReadCsvSamples : public test::FolderTest {
 protected:
  std::vector<Sample> read(const std::string& table = kTable,
                           const std::string& mapping = kMapping) {
    write("t.csv", table);
    write("m.yaml", mapping);
    diagnostics_ = {};
    return read_csv_samples((folder_ / "t.csv").string(), (folder_ / "m.yaml").string(),
                            diagnostics_);
  }
  /// The table or mapping with one piece of text replaced.
  static std::string with(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }

  Diagnostics diagnostics_;
};

TEST_F(ReadCsvSamples, PutsEveryColumnWhereItBelongs) {
  const auto samples = read();
  ASSERT_THAT(diagnostics_.errors, IsEmpty());
  ASSERT_EQ(samples.size(), 1u);
  const Sample& sample = samples.front();
  EXPECT_THAT(sample.joint_names, ElementsAre("pan", "tilt", "lift"));
  EXPECT_DOUBLE_EQ(sample.joint_positions[0], std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(sample.joint_positions[1], -std::numbers::pi / 4);
  EXPECT_EQ(sample.joint_positions[2], 0.1005);
  EXPECT_EQ(sample.source, (folder_ / "t.csv").string() + ":2");
  ASSERT_EQ(sample.observations.size(), 3u);
  EXPECT_EQ(sample.observations[0].sensor, "arm");
  EXPECT_EQ(sample.observations[0].features[0].frame, "smr");
  EXPECT_EQ(sample.observations[0].features[0].point, Vector3<double>(0.0, 0.5, 0.0));
  const auto& tracked = sample.observations[1].features;
  ASSERT_EQ(tracked.size(), 2u);
  EXPECT_EQ(tracked[0].point, Vector3<double>(1.0001, 0.002, 0.003)) << "as the text stands";
  EXPECT_LE((tracked[1].point - Vector3<double>(1.0002, 0.0022, 0.0033)).norm(), 1e-15);
  EXPECT_EQ(sample.observations[2].features[0].point, Vector3<double>(320.5, 240.0, 0.0));
}

const char* const kPoses = R"(poses:
  flange_joint: {form: kuka, columns: [X, Y, Z, A, B, C]}
observations:
 - {sensor: camera, frame: optical, table: corners.csv, match: image, pixels: [[u, v]], id_columns: [id]}
 - {sensor: arm, frame: board, table: target.csv, unit: millimetres, points: [[x, y, z]], id_columns: [id]}
)";
const char* const kPoseTable =
    "image,X,Y,Z,A,B,C\n"
    "0.png,400,-200,1100,90,0,0\n"
    "1.png,,0,0,0,0,0\n"
    "2.png,0,0,0,0,0,180\n"
    "3.png,0,0,0,0,0,180\n";

class ReadCsvPoses : public ReadCsvSamples {
 protected:
  void SetUp() override {
    write("corners.csv", "image,id,u,v\n0.png,4,10,20\n0.png,7,11,21\n3.png,7,12,22\n");
    write("target.csv", "id,x,y,z\n4,0,100,0\n7,50,100,0\n");
  }
};

TEST_F(ReadCsvPoses, APoseAndTheFeaturesOfOtherTablesBecomeASample) {
  const auto samples = read(kPoseTable, kPoses);
  ASSERT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_THAT(diagnostics_.warnings,
              ElementsAre(HasSubstr("t.csv:3: joint 'flange_joint' has no pose; the row is left")));
  ASSERT_EQ(samples.size(), 3u);
  const Pose<double>& pose = samples[0].poses.at("flange_joint");
  EXPECT_LE((pose.translation - Vector3<double>(0.4, -0.2, 1.1)).norm(), 1e-15);
  EXPECT_NEAR(pose.rotation(1, 0), 1.0, 1e-15);
  ASSERT_EQ(samples[0].observations.size(), 2u);
  EXPECT_EQ(samples[0].observation("camera")->features[1].id, 7);
  EXPECT_EQ(samples[0].observation("camera")->features[1].point, Vector3<double>(11, 21, 0));
  EXPECT_EQ(samples[0].observation("arm")->features[1].point, Vector3<double>(0.05, 0.1, 0));
  EXPECT_EQ(samples[1].observation("camera"), nullptr) << "no corner was seen";
  EXPECT_EQ(samples[2].observation("camera")->features.size(), 1u);
}

TEST_F(ReadCsvPoses, AFeatureOfNoSampleIsLeftOutWithAWarning) {
  write("corners.csv", "image,id,u,v\n0.png,4,10,20\n9.png,7,11,21\n9.png,4,11,21\n");
  (void)read(kPoseTable, kPoses);
  ASSERT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_THAT(diagnostics_.warnings.back(),
              HasSubstr("corners.csv:3: no sample has image '9.png'"));
  EXPECT_EQ(diagnostics_.warnings.size(), 2u);
}

TEST_F(ReadCsvPoses, WrongPosesAndColumnsAreErrorsThatSayWhatToWrite) {
  const auto errors = [&](const std::string& from, const std::string& to) {
    (void)read(kPoseTable, with(kPoses, from, to));
    return diagnostics_.errors;
  };
  EXPECT_THAT(
      errors("form: kuka", "form: kuka, unit: metres").front(),
      HasSubstr("t.csv:2: pose of 'flange_joint': the position is 1100 m away; it looks like "
                "millimetres: write 'unit: millimetres'"));
  EXPECT_THAT(errors("form: kuka", "form: kuka, angles: radians").front(),
              HasSubstr("write 'angles: degrees'"));
  EXPECT_THAT(
      errors("form: kuka", "form: quaternion_xyzw").front(),
      HasSubstr("m.yaml:2: pose of 'flange_joint': has 6 columns; the form has 7 columns: x y "
                "z qx qy qz qw"));
  EXPECT_THAT(errors("form: kuka", "form: kuca").front(), HasSubstr("did you mean 'kuka'?"));
  EXPECT_THAT(errors("A, B, C]", "A, B, D]").front(), HasSubstr("column 'D' is not in the table"));
  EXPECT_THAT(errors("match: image", "match: picture").front(), HasSubstr("column 'picture'"));
  EXPECT_THAT(errors("table: corners.csv, ", "").front(), HasSubstr("has match, but no table"));
}

/// As many images as a log has, and as many columns as a machine has signals: each is looked up, not searched for.
TEST_F(ReadCsvPoses, LargeTablesAreMatchedByTheirKeys) {
  constexpr int kImages = 50'000;
  std::string poses = "image,X,Y,Z,A,B,C\n", corners = "image,id,u,v\n";
  for (int i = 0; i < kImages; ++i) {
    poses += std::to_string(i) + ".png,1,2,3,0,0,0\n";
    const std::string image = std::to_string(kImages - 1 - i) + ".png,";  // in another order
    corners += image + "4," + std::to_string(i) + ",20\n" + image + "7,11,21\n";
  }
  write("corners.csv", corners);
  const auto samples = read(poses, kPoses);
  ASSERT_THAT(diagnostics_.errors, IsEmpty());
  ASSERT_EQ(samples.size(), static_cast<std::size_t>(kImages));
  for (const int i : {0, 1, kImages / 2, kImages - 1}) {
    const auto& seen = samples[static_cast<std::size_t>(i)].observation("camera")->features;
    ASSERT_EQ(seen.size(), 2u);
    EXPECT_EQ(seen[0].point.x(), kImages - 1 - i);
    EXPECT_EQ(seen[1].id, 7);
  }
}

TEST_F(ReadCsvSamples, ManyColumnsAreFoundByTheirNames) {
  constexpr int kColumns = 20'000;
  std::string header, row, joints, speeds;
  for (int i = 0; i < kColumns; ++i) {
    const std::string n = std::to_string(i);
    header += (i > 0 ? ",q" : "q") + n + ",v" + n;
    row += (i > 0 ? "," : "") + n + "," + n;
    joints += "j" + n + ": q" + n + ", ";
    speeds +=
        "j" + std::to_string(kColumns - 1 - i) + ": v" + std::to_string(kColumns - 1 - i) + ", ";
  }
  const auto samples =
      read(header + "\n" + row + "\n",
           "joints: {unit: radians, columns: {" + joints +
               "}}\nvelocities: {unit: "
               "rad/s, columns: {" +
               speeds + "}}\nobservations:\n - {sensor: arm, frame: smr, constant: [0, 0, 0]}\n");
  ASSERT_THAT(diagnostics_.errors, IsEmpty());
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_EQ(samples[0].joint_positions.back(), kColumns - 1);
  EXPECT_EQ(samples[0].joint_velocities[7], 7.0);
}

const char* const kMoving = R"(joints: {unit: degrees, columns: {pan: q1, tilt: q2}}
sliding: {unit: metres, columns: {lift: l}}
velocities: {unit: deg/s, columns: {tilt: dq2, pan: dq1}}
sliding_velocities: {unit: mm/s, columns: {lift: dl}}
observations:
 - {sensor: arm, frame: smr, constant: [0, 0, 0]}
)";
const char* const kMovingTable = "q1,q2,l,dq1,dq2,dl\n90,-45,0.1,180,-90,20\n";

TEST_F(ReadCsvSamples, VelocitiesAreInTheOrderOfTheJoints) {
  const auto samples = read(kMovingTable, kMoving);
  ASSERT_THAT(diagnostics_.errors, IsEmpty());
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_DOUBLE_EQ(*samples[0].velocity("pan"), std::numbers::pi);
  EXPECT_DOUBLE_EQ(*samples[0].velocity("tilt"), -std::numbers::pi / 2);
  EXPECT_EQ(*samples[0].velocity("lift"), 0.02);
  EXPECT_THAT(read().front().joint_velocities, IsEmpty()) << "none are given";
}

TEST_F(ReadCsvSamples, VelocitiesAreOfAllJointsAndInEveryRow) {
  (void)read(kMovingTable, with(kMoving, "sliding_velocities:", "#"));
  EXPECT_THAT(diagnostics_.errors,
              ElementsAre(HasSubstr("m.yaml:3: velocities: no column for joint 'lift'; give all")));
  (void)read(kMovingTable, with(kMoving, "{tilt: dq2, pan: dq1}", "{}"));
  EXPECT_THAT(diagnostics_.errors,
              ElementsAre(HasSubstr("velocities: no column for joints 'pan', 'tilt'; give all")));
  (void)read(kMovingTable, with(kMoving, "pan: dq1}", "pan: dq1, wrist: dq1}"));
  EXPECT_THAT(diagnostics_.errors,
              ElementsAre(HasSubstr("m.yaml:3: velocities: joint 'wrist' has no position")));
  (void)read(kMovingTable, with(kMoving, "unit: deg/s", "unit: degrees"));
  EXPECT_THAT(diagnostics_.errors,
              ElementsAre(HasSubstr("velocities: unit 'degrees' is not one of rad/s, deg/s")));
  for (const char* nothing : {"nan", ""}) {
    (void)read(with(kMovingTable, "-90", nothing), kMoving);
    EXPECT_THAT(diagnostics_.errors,
                ElementsAre(HasSubstr("t.csv:2: column 'dq2' has no velocity of joint 'tilt'")));
  }
}

TEST_F(ReadCsvSamples, VelocitiesThatLookLikeDegreesGiveAWarning) {
  (void)read(kMovingTable, with(kMoving, "{unit: deg/s, columns: {tilt", "{columns: {tilt"));
  EXPECT_THAT(diagnostics_.warnings,
              testing::Contains(HasSubstr("the velocity of joint 'pan' is at 180 rad/s or m/s")));
}

TEST_F(ReadCsvSamples, TakesIdsFromTheMappingOrFromColumns) {
  const std::string mapping =
      "joints: {columns: {pan: q}}\nobservations:\n"
      "- {sensor: arm, frame: board, constant: [[0, 0, 0], [0.1, 0, 0], [0.2, 0, 0]], ids: [4, 5, "
      "7]}\n"
      "- {sensor: camera, frame: optical, pixels: [[u, v], [w, x]], id_columns: [tag, other]}\n";
  const std::string table = "q,tag,u,v,other,w,x\n0.1,7,1,2,4,3,4\n0.2,,,,5,3,4\n";
  const auto samples = read(table, mapping);
  ASSERT_THAT(diagnostics_.errors, IsEmpty());
  ASSERT_EQ(samples.size(), 2u);
  const auto ids = [&](std::size_t sample, std::size_t sensor) {
    std::vector<std::optional<int>> all;
    for (const Feature& f : samples[sample].observations[sensor].features) all.push_back(f.id);
    return all;
  };
  EXPECT_THAT(ids(0, 0), ElementsAre(4, 5, 7));
  EXPECT_THAT(ids(0, 1), ElementsAre(7, 4));
  EXPECT_THAT(ids(1, 1), ElementsAre(5)) << "the other one was not seen";
  EXPECT_EQ(samples[1].observations[1].features[0].point, Vector3<double>(3.0, 4.0, 0.0));

  (void)read(with(table, "7,1,2", ",1,2"), mapping);
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("t.csv:2: column 'tag' has no id")));
  (void)read(with(table, "7,1,2", "7.5,1,2"), mapping);
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("t.csv:2: column 'tag' has no id")));
  (void)read(table, with(mapping, "[4, 5, 7]", "[4, 5]"));
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("m.yaml:3: sensor 'arm': has 2 ids")));
  (void)read(table, with(mapping, "[4, 5, 7]", "[4, 5, -7]"));
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("'-7' is not a whole number from 0")));
  (void)read(table, with(mapping, "[tag, other]", "[tag, othr]"));
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("m.yaml:4: column 'othr'")));
  (void)read(table, with(mapping, "[tag, other]", "[tag, other], ids: [1, 2]"));
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("has ids and id_columns")));
}

/// The numbers of points that a sensor observes in each sample.
std::vector<std::size_t> points_of(const std::vector<Sample>& samples, const std::string& sensor) {
  std::vector<std::size_t> numbers;
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(sensor);
    numbers.push_back(seen == nullptr ? 0 : seen->features.size());
  }
  return numbers;
}

TEST_F(ReadCsvSamples, TakesAFileOfPointsForEachRow) {
  write("line_1.txt", "10 20\n30 inf\n");
  write("line_2.txt", "1 2\n3 4\n5 6\n");
  write("line_10.txt", "");
  const std::string mapping =
      "joints: {columns: {pan: q}}\nobservations:\n"
      "- {sensor: scanner, frame: scanner, unit: millimetres, table: 'line_{n}.txt', "
      "separator: space, header: false, points: [[1, 0, 2]]}\n"
      "- {sensor: arm, frame: hand, constant: [0, 0, 0]}\n";
  const std::string table = "n,q\n1,0.1\n2,0.2\n10,0.3\n";
  for (const char* files : {"line_{n}.txt", "line_*.txt"}) {
    const auto samples = read(table, with(mapping, "line_{n}.txt", files));
    ASSERT_THAT(diagnostics_.errors, IsEmpty());
    EXPECT_THAT(diagnostics_.warnings,
                ElementsAre(HasSubstr("line_10.txt: has no points; " +
                                      (folder_ / "t.csv").string() + ":4 is without them")));
    EXPECT_THAT(points_of(samples, "scanner"), ElementsAre(2u, 3u, 0u));
    EXPECT_EQ(samples[0].observation("scanner")->features[0].point,
              Vector3<double>(0.010, 0.0, 0.020));
    EXPECT_TRUE(std::isnan(samples[0].observation("scanner")->features[1].point.z()));
  }
  (void)read(table, with(mapping, "line_{n}", "lin_{n}"));
  EXPECT_THAT(diagnostics_.errors, ElementsAre(AllOf(HasSubstr("t.csv:2: its table"),
                                                     HasSubstr("lin_1.txt' does not exist"))));
  (void)read(table, with(mapping, "line_{n}", "line_{m}"));
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("m.yaml:3: column 'm'")));
  (void)read(table, with(mapping, "line_{n}", "line_1*"));
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("2 files for 3 rows")));
  (void)read(table, with(mapping, "[[1, 0, 2]]", "[[1, 0, 3]]"));
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("the table has columns 1 to 2")));
}

TEST_F(ReadCsvSamples, RowsOfAGroupAreThePointsOfOneSample) {
  const std::string mapping =
      "group: n\njoints: {columns: {pan: q}}\nobservations:\n"
      "- {sensor: scanner, frame: scanner, points: [[x, 0, z]]}\n"
      "- {sensor: arm, frame: hand, constant: [0, 0, 0]}\n";
  const std::string table = "n,q,x,z\n1,0.1,1,2\n1,0.1,3,4\n2,0.2,5,6\n1,0.1,7,8\n";
  const auto samples = read(table, mapping);
  ASSERT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_THAT(points_of(samples, "scanner"), ElementsAre(3u, 1u));
  EXPECT_THAT(points_of(samples, "arm"), ElementsAre(1u, 1u));
  EXPECT_EQ(samples[0].observation("scanner")->features[2].point, Vector3<double>(7.0, 0.0, 8.0));
  (void)read(with(table, "1,0.1,7", "1,0.2,7"), mapping);
  EXPECT_THAT(diagnostics_.errors,
              ElementsAre(AllOf(HasSubstr("t.csv:5: 'pan' is not where it is in"),
                                HasSubstr("t.csv:2, although both have n '1'"))));
}

TEST_F(ReadCsvSamples, TakesConditionsFromColumns) {
  const std::string mapping =
      kMapping + std::string("conditions: {temperature: u, load: [l, dl]}\n");
  const auto samples = read(kTable, mapping);
  ASSERT_THAT(diagnostics_.errors, IsEmpty());
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_EQ(samples[0].conditions,
            (std::map<std::string, double>{{"temperature", 320.5}, {"load", 100.5}}));
  (void)read(kTable, with(mapping, "temperature: u", "temperature: uu"));
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("m.yaml:18: column 'uu'")));
  (void)read(kTable, with(mapping, "{temperature: u, load: [l, dl]}", "[u]"));
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("m.yaml:18: conditions")));
}

TEST_F(ReadCsvSamples, TakesColumnsByNumberWhereThereIsNoHeader) {
  const std::string mapping =
      "separator: semicolon\nheader: false\njoints: {columns: {pan: 1}}\n"
      "observations: [{sensor: arm, frame: hand, points: [[2, 3, 4]]}]\n";
  const auto samples = read("0.5;1;2;3\r\n\r\n0.25;4;5;6\r\n;;;\r\n", mapping);
  ASSERT_THAT(diagnostics_.errors, IsEmpty());
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(samples[1].joint_positions[0], 0.25);
  EXPECT_EQ(samples[1].observations[0].features[0].point, Vector3<double>(4.0, 5.0, 6.0));
}

TEST_F(ReadCsvSamples, MakesAMissingValueAFeatureWithoutWeight) {
  for (const char* missing : {"", "nan", "NaN", "NA", "-"}) {
    const auto samples = read(with(kTable, "1000.1", missing));
    ASSERT_THAT(diagnostics_.errors, IsEmpty()) << missing;
    EXPECT_FALSE(samples[0].observations[1].features[0].point.allFinite());
    EXPECT_FALSE(samples[0].observations[1].features[1].point.allFinite());
    EXPECT_TRUE(samples[0].observations[2].features[0].point.allFinite());
  }
}

TEST_F(ReadCsvSamples, LeavesOutARowWithoutAJointAndSaysSo) {
  const std::string whole = "91,-44,100,0.5,1000,2,3,0.1,0.2,0.3,320,240\n";
  EXPECT_THAT(read(with(kTable, "-45", "") + whole), testing::SizeIs(1));
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_THAT(diagnostics_.warnings, ElementsAre(HasSubstr("t.csv:2: joint 'tilt' has no")));
}

/// As where a comma is the decimal point.
struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

TEST_F(ReadCsvSamples, RefusesATableOfWhichNoRowIsLeft) {
  EXPECT_THAT(read(with(kTable, "90,-45", "90,")), IsEmpty());
  EXPECT_THAT(diagnostics_.errors,
              ElementsAre(HasSubstr("t.csv: no row has a position of every joint")));
}

TEST_F(ReadCsvSamples, DoubtsNumbersOfWhichTheUnitIsMissing) {
  (void)read();
  EXPECT_THAT(diagnostics_.warnings, IsEmpty());
  const std::string twice = kTable + std::string("91,-44,100,0.5,1000,2,3,0.1,0.2,0.3,320,240\n");
  (void)read(twice,
             with(with(kMapping, "  unit: degrees\n", ""),
                  "   frame: tracker_frame\n   unit: millimetres\n", "   frame: tracker_frame\n"));
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_THAT(diagnostics_.warnings,
              ElementsAre(HasSubstr("t.csv:2: joint 'pan' is at 90 radians or metres; is a unit"),
                          HasSubstr("t.csv:2: joint 'tilt' is at -45 radians or metres"),
                          HasSubstr("t.csv:2: sensor 'tracker' is at 1000.1 metres")));
}

TEST_F(ReadCsvSamples, AConstantHasTheUnitOfItsObservation) {
  const auto samples = read(kTable, with(kMapping, "constant: [0, 0.5, 0]",
                                         "unit: millimetres\n   constant: [0, 500, 0]"));
  ASSERT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_EQ(samples.at(0).observations.at(0).features.at(0).point, Vector3<double>(0, 0.5, 0));
}

TEST_F(ReadCsvSamples, TakesSeveralFramesOfOneSensor) {
  const auto samples = read("q1,ax,ay,az,bx,by,bz\n0.5,1,2,3,4,5,6\n",
                            "joints: {columns: {pan: q1}}\nobservations:\n"
                            " - {sensor: arm, frame: smr_1, constant: [0, 0, 0]}\n"
                            " - {sensor: tracker, frame: laser, points: [[ax, ay, az]]}\n"
                            " - {sensor: arm, frame: board, constant: [[0, 0, 0], [0.1, 0, 0]]}\n"
                            " - {sensor: tracker, frame: laser, points: [[bx, by, bz]]}\n");
  ASSERT_THAT(diagnostics_.errors, IsEmpty());
  ASSERT_EQ(samples.size(), 1u);
  ASSERT_EQ(samples[0].observations.size(), 2u);
  const auto& arm = samples[0].observation("arm")->features;
  ASSERT_EQ(arm.size(), 3u);
  EXPECT_EQ(arm[0].frame, "smr_1");
  EXPECT_EQ(arm[1].frame, "board");
  EXPECT_EQ(arm[2].frame, "board");
  EXPECT_EQ(arm[2].point, Vector3<double>(0.1, 0.0, 0.0));
  const auto& tracker = samples[0].observation("tracker")->features;
  ASSERT_EQ(tracker.size(), 2u);
  EXPECT_EQ(tracker[1].point, Vector3<double>(4.0, 5.0, 6.0));
}

TEST_F(ReadCsvSamples, TakesTheFrameOfARowFromAColumn) {
  const std::string mapping =
      "joints: {columns: {pan: q1}}\nobservations:\n"
      " - {sensor: arm, frame_column: ball, constant: [0, 0, 0]}\n"
      " - {sensor: tracker, frame: laser, points: [[x, y, z]]}\n";
  const std::string table = "q1,ball,x,y,z\n0.5,smr_a,1,2,3\n0.6,smr_b,1,2,3\n";
  const auto samples = read(table, mapping);
  ASSERT_THAT(diagnostics_.errors, IsEmpty());
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(samples[0].observation("arm")->features[0].frame, "smr_a");
  EXPECT_EQ(samples[1].observation("arm")->features[0].frame, "smr_b");
  EXPECT_EQ(samples[1].observation("tracker")->features[0].frame, "laser");
  (void)read(with(table, "smr_b", ""), mapping);
  EXPECT_THAT(diagnostics_.errors,
              ElementsAre(HasSubstr("t.csv:3: column 'ball' is empty; it names the frame")));
  const auto named =
      read(table, with(mapping, "frame_column: ball", "frame: hand, frame_column: ball"));
  EXPECT_EQ(named.at(1).observation("arm")->features[0].frame, "hand_smr_b");
  (void)read(table, with(mapping, "frame_column: ball", "frame_column: [ball, x]"));
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("one column names the frame")));
}

TEST_F(ReadCsvSamples, SaysThatAHeaderLooksLikeData) {
  const std::string mapping =
      "joints: {columns: {pan: 1}}\n"
      "observations: [{sensor: arm, frame: hand, points: [[2, 3, 4]]}]\n";
  EXPECT_THAT(read("0.5,1,2,3\n0.25,4,5,6\n", mapping), testing::SizeIs(1));
  EXPECT_THAT(diagnostics_.warnings, ElementsAre(AllOf(HasSubstr("t.csv:1: row 1 looks like data"),
                                                       HasSubstr("write 'header: false'"))));
  (void)read("1,2,3,4\n0.25,4,5,6\n", mapping);
  EXPECT_THAT(diagnostics_.warnings, IsEmpty()) << "it counts the columns";
  (void)read("0.5,1,2,3\n0.25,4,5,6\n", "header: false\n" + mapping);
  EXPECT_THAT(diagnostics_.warnings, IsEmpty());
  (void)read("0.5,1,2,3\n0.25,4,5,6\n", with(mapping, "pan: 1", "pan: q1"));
  EXPECT_THAT(diagnostics_.errors,
              ElementsAre(HasSubstr("column 'q1' is not in the table's header")));
  EXPECT_THAT(diagnostics_.warnings, ElementsAre(HasSubstr("row 1 looks like data")));
}

TEST_F(ReadCsvSamples, DoesNotDependOnTheLocale) {
  const std::locale before =
      std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  (void)std::setlocale(LC_ALL, "de_DE.UTF-8");  // of the C library too, where it is installed
  const auto samples = read();
  std::locale::global(before);
  ASSERT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_EQ(samples[0].observations[2].features[0].point, Vector3<double>(320.5, 240.0, 0.0));
  EXPECT_EQ(samples[0].observations[0].features[0].point.y(), 0.5) << "of the mapping";
}

TEST_F(ReadCsvSamples, ReportsAMissingColumnAndTheNearestName) {
  (void)read(kTable, with(kMapping, "dx]", "dxx]"));
  EXPECT_THAT(diagnostics_.errors,
              ElementsAre(AllOf(HasSubstr("m.yaml:14: column 'dxx'"), HasSubstr("is not in"))));
  (void)read(with(kTable, "q1", "joint_1"), with(kMapping, "q1", "jiont_1"));
  EXPECT_THAT(diagnostics_.errors, ElementsAre(AllOf(HasSubstr("m.yaml:3: column 'jiont_1'"),
                                                     HasSubstr("did you mean 'joint_1'?"))));
  (void)read(kTable, with(kMapping, "q1", "13"));
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("has columns 1 to 12")));
  (void)read(kTable, std::string("header: false\n") + kMapping);
  EXPECT_THAT(diagnostics_.errors, testing::Contains(HasSubstr("the table has no header")));
  (void)read(with(kTable, "q2", "q1"), with(kMapping, "q2", "2"));
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("column 'q1' occurs twice")));
}

TEST_F(ReadCsvSamples, QuotesTheHeaderThatItRead) {
  (void)read(std::string("# session 7\n") + kTable, with(kMapping, "q1", "j1"));
  EXPECT_THAT(diagnostics_.errors,
              ElementsAre(HasSubstr("line 2 was read as the header: 'q1, q2, l, dl, x, y, z")));
}

TEST_F(ReadCsvSamples, ARowOfUnitsMustAgreeWithTheColumnsFile) {
  const std::string units = "deg,deg,mm,mm,mm,mm,mm,mm,mm,mm,px,px\n";
  const auto below = [&](const std::string& row) { return with(kTable, "v\n", "v\n" + row); };
  const auto samples = read(below(units));
  ASSERT_THAT(diagnostics_.errors, IsEmpty());
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_EQ(samples[0].source, (folder_ / "t.csv").string() + ":3");
  (void)read(below(with(units, "deg", "rad")));
  EXPECT_THAT(
      diagnostics_.errors,
      ElementsAre(AllOf(HasSubstr("m.yaml:3: column 'q1' is in rad, by the row of units in"),
                        HasSubstr("t.csv:2; write 'unit: radians'"))));
  (void)read(below(with(units, "mm,mm,mm,mm,mm,mm,mm,mm", "mm,mm,cm,mm,mm,mm,mm,mm")));
  EXPECT_THAT(diagnostics_.errors, testing::Each(HasSubstr("column 'x' is in cm")));
}

TEST_F(ReadCsvSamples, ReadsPosesThatASensorSaw) {
  const auto samples = read(
      "x,y,z,rx,ry,rz,mx,my,mz,mw,mi,mj,mk\n1,2,3,0,0,0,10,20,30,0,1,0,0\n1,2,3,0,0,0,,,,,,,\n",
      "poses: {flange: {form: ur, columns: [x, y, z, rx, ry, rz]}}\n"
      "observations:\n - {sensor: object, frame: target, form: quaternion_xyzw, constant_poses: "
      "[[0, "
      "0, 0, 0, 0, 0, 1]]}\n"
      " - {sensor: camera, frame: camera, form: abb, poses: [[mx, my, mz, mw, mi, mj, mk]]}\n");
  ASSERT_THAT(diagnostics_.errors, IsEmpty());
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(*samples[0].observation("object")->features[0].rotation, Eigen::Matrix3d::Identity());
  const Feature& seen = samples[0].observation("camera")->features[0];
  EXPECT_LE((seen.point - Vector3<double>(0.01, 0.02, 0.03)).norm(), 1e-15);
  EXPECT_EQ((*seen.rotation)(1, 1), -1.0);
  EXPECT_FALSE(samples[1].observation("camera")->features[0].point.allFinite());
}

TEST_F(ReadCsvSamples, DoubtsRotationVectorsOfMoreThanHalfATurn) {
  const std::string mapping =
      "poses: {flange: {form: ur, unit: millimetres, angles: degrees, columns: [1, 2, 3, 4, 5, "
      "6]}}\n"
      "observations: [{sensor: arm, frame: hand, constant: [0, 0, 0]}]\n";
  (void)read("x,y,z,rx,ry,rz\n1,2,3,170,0,150\n1,2,3,-160,20,160\n1,2,3,0,0,9\n", mapping);
  EXPECT_THAT(diagnostics_.warnings,
              ElementsAre(AllOf(HasSubstr("2 poses of 'flange'"), HasSubstr("up to 227 deg"))));
  (void)read("x,y,z,rx,ry,rz\n1,2,3,170,0,0\n1,2,3,0,0,179\n", mapping);
  EXPECT_THAT(diagnostics_.warnings, IsEmpty());
}

TEST_F(ReadCsvSamples, ATableWhereSamplesGoIsReadByTheColumnsBesideIt) {
  write("log.csv", kTable);
  const std::string log = (folder_ / "log.csv").string();
  EXPECT_TRUE(is_csv_table(log));
  try {
    (void)read_csv_by_columns_beside(log, diagnostics_);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("is a table, not samples"), HasSubstr("kinecal convert"),
                                HasSubstr("--columns columns.yaml")));
  }
  write("columns.yaml", kMapping);
  EXPECT_THAT(read_csv_by_columns_beside(log, diagnostics_), testing::SizeIs(1));
  EXPECT_THAT(diagnostics_.notes, testing::Contains(HasSubstr("columns.yaml")));
  write("samples.txt", "joint_states:\n  name: [a]\n");
  EXPECT_FALSE(is_csv_table((folder_ / "samples.txt").string()));
}

TEST_F(ReadCsvSamples, SuspectsTheSeparatorWhereThereIsOneColumn) {
  (void)read(kTable, std::string("separator: semicolon\n") + kMapping);
  EXPECT_THAT(diagnostics_.errors, testing::Each(HasSubstr("is the separator right?")));
}

TEST_F(ReadCsvSamples, ReportsCellsThatAreNotNumbers) {
  (void)read(with(kTable, "1000.1", "1000.1mm"));
  EXPECT_THAT(diagnostics_.errors,
              testing::Each(HasSubstr("t.csv:2: column 'x' is '1000.1mm', which is not a number")));
  (void)read(with(kTable, "320.5", "\"320,5\""));
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("a decimal point, not a comma")));
  (void)read(with(kTable, "320.5", "inf"));
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("not a finite number")));
  (void)read(with(kTable, ",320.5,240", ""));
  EXPECT_THAT(diagnostics_.errors, testing::Contains(HasSubstr("the row has 10 cells")));
}

TEST_F(ReadCsvSamples, CountsMistakesThatRepeatThemselves) {
  std::string table = kTable;
  for (int i = 0; i < 50; ++i) table += "a,0,0,0,0,0,0,0,0,0,0,0\n";
  (void)read(table);
  EXPECT_EQ(diagnostics_.errors.size(), 21u);
  EXPECT_THAT(diagnostics_.errors.back(), HasSubstr("t.csv: 30 more cells"));
}

TEST_F(ReadCsvSamples, ReportsErrorsOfTheMappingWithTheirLines) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"separator: colon\njoints:", "m.yaml:1: separator 'colon' is not one of"},
      {"jionts:", "m.yaml:1: unknown key 'jionts'; did you mean 'joints'?"},
      {"joints: {unit: degree}\nignored:", "m.yaml:1: joints: unit 'degree' is not one of"},
      {"header: maybe\njoints:", "m.yaml:1: header is 'maybe', not true or false"}};
  for (const auto& [text, message] : wrong) {
    (void)read(kTable, with(kMapping, "joints:", text));
    EXPECT_THAT(diagnostics_.errors, testing::Contains(HasSubstr(message))) << text;
  }
  (void)read(kTable, with(kMapping, "[[u, v]]", "[[u]]"));
  EXPECT_THAT(diagnostics_.errors, testing::Contains(AllOf(HasSubstr("m.yaml:17: sensor 'camera'"),
                                                           HasSubstr("two columns"))));
  (void)read(kTable, with(kMapping, "constant: [0, 0.5, 0]", "constant: [0, 0.5]"));
  EXPECT_THAT(diagnostics_.errors, testing::Contains(HasSubstr("m.yaml:10: sensor 'arm'")));
  (void)read(kTable, with(kMapping, "   constant: [0, 0.5, 0]\n", ""));
  EXPECT_THAT(diagnostics_.errors, testing::Contains(HasSubstr("has none of points, pixels")));
  (void)read(kTable, with(kMapping, "sensor: camera", "sensor: arm"));
  EXPECT_THAT(diagnostics_.errors,
              testing::Contains(HasSubstr("sensor 'arm': has pixels here and points")));
  (void)read(kTable, "[1, 2]");
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("the file is a list, not a map")));
}

TEST_F(ReadCsvSamples, NotesTheUnitsThatAreTaken) {
  (void)read(kTable, with(kMapping, "  unit: degrees\n", ""));
  EXPECT_THAT(diagnostics_.notes,
              testing::Contains(HasSubstr("m.yaml:1: joints: unit is not given: radians")));
}

TEST_F(ReadCsvSamples, AKeyThatLooksLikeAUnitIsAnErrorIfItIsUnknown) {
  (void)read(kTable, with(kMapping, "joints:", "joints: {columns: {pan: q1}, scale: 0.01}\nx:"));
  EXPECT_THAT(diagnostics_.errors,
              testing::Contains(HasSubstr("joints: unknown key 'scale' looks like a unit or scale, "
                                          "which would be lost; did you mean 'unit'?")));
}

TEST_F(ReadCsvSamples, JointsAloneNeedNoObservations) {
  std::ofstream(folder_ / "j.yaml") << "joints: {unit: degrees, columns: {pan: q1}}\n";
  const std::string path = (folder_ / "j.yaml").string();
  EXPECT_EQ(read_csv_mapping(path, diagnostics_, CsvUse::joints).joints.size(), 1u);
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  (void)read_csv_mapping(path, diagnostics_);
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("no observation is given")));
}

TEST_F(ReadCsvSamples, AddsUpIncrementsOfEachRun) {
  const char* const mapping = R"(conditions: {run: run}
increments:
  left_wheel: l
  track_x: {column: x, unit: millimetres}
  track_y: {column: y, unit: millimetres}
  track_yaw: {column: turn, unit: degrees}
)";
  const auto samples =
      read("run,l,x,y,turn\n1,2,1000,0,90\n1,3,1000,0,0\n1,1,,0,0\n2,4,0,500,-90\n", mapping);
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_THAT(diagnostics_.notes, ElementsAre(HasSubstr("1 row without all increments")));
  ASSERT_EQ(samples.size(), 5u);  // where each run began, too
  const double kTurn = std::numbers::pi / 2.0, kAlong[][4] = {{0, 0, 0, 0},
                                                              {2, 1, 0, kTurn},
                                                              {5, 1, 1, kTurn},
                                                              {5, 1, 1, kTurn},
                                                              {9, 0.5, 1, 0}};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto& conditions = samples[i].conditions;
    EXPECT_EQ(conditions.at("run"), i < 3 ? 1 : 2);
    EXPECT_EQ(conditions.at("left_wheel"), kAlong[i][0]);
    EXPECT_NEAR(conditions.at("track_x"), kAlong[i][1], 1e-12);
    EXPECT_NEAR(conditions.at("track_y"), kAlong[i][2], 1e-12);
    EXPECT_NEAR(conditions.at("track_yaw"), kAlong[i][3], 1e-12);
  }
  (void)read("l\n1\n", "conditions: {left_wheel: l}\nincrements: {left_wheel: l}\n");
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("'left_wheel' is a condition already")));
}

/// No row says where the tracker was before the first increment.
TEST_F(ReadCsvSamples, BesideAnAbsolutePoseRunsOfIncrementsBeginAtTheirFirstRow) {
  const auto samples = read("run,l,x\n1,2,10\n1,3,13\n2,4,20\n2,5,25\n",
                            "conditions: {run: run, track_x: x}\nincrements: {left_wheel: l}\n");
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  ASSERT_EQ(samples.size(), 4u);
  for (const std::size_t i : {1u, 3u}) {
    const auto &now = samples[i].conditions, &before = samples[i - 1].conditions;
    EXPECT_EQ(now.at("left_wheel") - before.at("left_wheel"),
              now.at("track_x") - before.at("track_x"));
  }
}

TEST_F(ReadCsvSamples, ReportsFilesThatAreEmptyOrMissing) {
  (void)read("");
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("the table has no rows")));
  EXPECT_THROW((void)read_csv_samples("nowhere.csv", (folder_ / "m.yaml").string(), diagnostics_),
               InputError);
  EXPECT_THROW((void)read_csv_samples((folder_ / "t.csv").string(), "nowhere.yaml", diagnostics_),
               InputError);
}

TEST(CsvExample, IsReadAsItsReadmeSays) {
  const std::string folder = test::source_folder() + "/examples/csv/";
  Diagnostics diagnostics;
  const auto samples =
      read_csv_samples(folder + "tracker.csv", folder + "columns.yaml", diagnostics);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.warnings, IsEmpty());
  ASSERT_EQ(samples.size(), 60u);
  EXPECT_FALSE(samples[17].observation("tracker")->features[0].point.allFinite());
  EXPECT_EQ(samples[17].source, folder + "tracker.csv:19");
}

}  // namespace
}  // namespace kinecal
