// kinecal calibrate --scene: a file for viewers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "support/meshes.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string kMagic = "\x89MCAP0\r\n";

class SceneFile : public test::TrackerExampleTest {
 protected:
  void SetUp() override {
    ASSERT_EQ(kinecal("convert tracker.csv samples.yaml --columns columns.yaml").code, 0);
    ASSERT_EQ(kinecal("init --urdf ur5e.urdf --target tracker --arm tool0").code, 0);
  }
  [[nodiscard]] Outcome calibrate(const std::string& more) const {
    return kinecal(
        "calibrate --urdf ur5e.urdf --config calibrate.yaml --samples samples.yaml --dry-run " +
        more);
  }
  /// Replaces the first occurrence of a text in a file.
  void replace(const std::string& file, const std::string& from, const std::string& to) const {
    std::string text = read(file);
    ASSERT_NE(text.find(from), std::string::npos) << from;
    write(file, text.replace(text.find(from), from.size(), to));
  }
};

TEST_F(SceneFile, IsAWholeMcapFileAndTheSameEachTime) {
  const Outcome done = calibrate("--scene s.mcap");
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("wrote s.mcap"));
  const std::string bytes = read("s.mcap");
  EXPECT_EQ(bytes.substr(0, 8), kMagic);
  EXPECT_EQ(bytes.substr(bytes.size() - 8), kMagic);
  EXPECT_EQ(calibrate("--scene s.mcap --force").code, 0);
  EXPECT_EQ(read("s.mcap"), bytes);
}

TEST_F(SceneFile, ReplacesAFileOnlyIfForcedAndAnInputNever) {
  write("s.mcap", "mine");
  const Outcome refused =
      kinecal("calibrate --urdf none --config none --samples none --output out --scene s.mcap");
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err, HasSubstr("s.mcap: exists; use --force to replace it"));
  EXPECT_EQ(read("s.mcap"), "mine");
  EXPECT_EQ(calibrate("--scene s.mcap --force").code, 0);
  EXPECT_EQ(read("s.mcap").substr(0, 8), kMagic);
  const std::string samples = read("samples.yaml");
  EXPECT_THAT(calibrate("--scene samples.yaml --force").err, HasSubstr("would replace an input"));
  EXPECT_EQ(read("samples.yaml"), samples);
}

TEST_F(SceneFile, LeavesNothingWhereItCannotBeWritten) {
  write("file", "");
  const Outcome refused = calibrate("--scene file/s.mcap");
  EXPECT_NE(refused.code, 0);
  EXPECT_THAT(refused.err, HasSubstr("file"));
  const auto entries = [&] { return std::distance(fs::directory_iterator(folder_), {}); };
  const auto before = entries();
  EXPECT_NE(calibrate("--scene /proc/nowhere/s.mcap").code, 0);
  EXPECT_EQ(entries(), before);
}

TEST_F(SceneFile, IsWrittenWhateverTheVerdict) {
  replace("calibrate.yaml", "max_num_iterations: 1000", "max_num_iterations: 1");
  const Outcome bad = calibrate("--scene s.mcap");
  EXPECT_EQ(bad.code, 2) << bad.out << bad.err;
  EXPECT_THAT(bad.err, HasSubstr("no results written"));
  EXPECT_EQ(read("s.mcap").substr(0, 8), kMagic);
}

TEST_F(SceneFile, HasMeshesFromTheGivenPath) {
  replace("ur5e.urdf", "<link name=\"upper_arm_link\"/>",
          "<link name=\"upper_arm_link\"><visual><geometry>"
          "<mesh filename=\"package://ur/base.stl\"/></geometry></visual></link>");
  const Outcome without = calibrate("--scene a.mcap");
  EXPECT_EQ(without.code, 0);
  EXPECT_THAT(without.err, AllOf(HasSubstr("is of package 'ur', which was not found"),
                                 HasSubstr("--mesh-path")));
  fs::create_directories(folder_ / "robots/ur");
  write("robots/ur/base.stl", test::binary_stl(test::ball(30)));
  const Outcome with = calibrate("--scene b.mcap --mesh-path robots");
  EXPECT_EQ(with.code, 0);
  EXPECT_THAT(with.err, Not(HasSubstr("mesh")));
  EXPECT_GT(read("b.mcap").size(), read("a.mcap").size() + 5000);
}

}  // namespace
}  // namespace kinecal
