// kinecal_robot_header as a build runs it: a header, or a message with file and line and nothing
// written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

const char* const kHeaderUrdf = R"(<?xml version="1.0"?>
<robot name="arm">
  <link name="base"/>
  <link name="upper"/>
  <joint name="shoulder" type="continuous">
    <origin xyz="0 0 0.5"/>
    <parent link="base"/>
    <child link="upper"/>
  </joint>
</robot>
)";

class RobotHeaderProgram : public test::ProgramTest {
 protected:
  RobotHeaderProgram() { write("arm.urdf", kHeaderUrdf); }

  [[nodiscard]] test::Outcome generate(const std::string& arguments) const {
    return run(test::program("kinecal_robot_header") + " " + arguments);
  }

  /// The URDF with one piece of text replaced is refused with this message; the header that was
  /// there before stays, alone.
  void expect_refused(const std::string& from, const std::string& to,
                      const testing::Matcher<std::string>& message,
                      const std::string& more = "") const {
    std::string text = kHeaderUrdf;
    text.replace(text.find(from), from.size(), to);
    write("bad.urdf", text);
    ASSERT_EQ(generate("--urdf arm.urdf --output out/arm.hpp").code, 0);
    const std::string before = read("out/arm.hpp");
    const test::Outcome refused = generate("--urdf bad.urdf --output out/arm.hpp " + more);
    EXPECT_EQ(refused.code, 1);
    EXPECT_THAT(refused.err, message);
    EXPECT_EQ(refused.out, "");
    EXPECT_EQ(read("out/arm.hpp"), before);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "out"), {}), 1) << "left something";
    (void)generate("--urdf bad.urdf --output new/arm.hpp " + more);
    EXPECT_FALSE(fs::exists(folder_ / "new"));
  }
};

TEST_F(RobotHeaderProgram, WritesTheHeaderAndItsFolderAndSaysNothing) {
  const test::Outcome result = generate("--urdf arm.urdf --output out/robots/arm.hpp");
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(result.out + result.err, "");
  EXPECT_THAT(read("out/robots/arm.hpp"),
              AllOf(StartsWith("// Generated from \"arm.urdf\"; changes are lost.\n#pragma once\n"),
                    HasSubstr("namespace arm {"), HasSubstr("\"shoulder\"")));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "out/robots"), {}), 1);
}

TEST_F(RobotHeaderProgram, TakesTheNamespaceItIsGiven) {
  ASSERT_EQ(generate("--urdf arm.urdf --output arm.hpp --namespace robots::left").code, 0);
  EXPECT_THAT(read("arm.hpp"), HasSubstr("namespace robots::left {"));
}

TEST_F(RobotHeaderProgram, ReplacesTheHeaderAsAWhole) {
  write("arm.hpp", std::string(100000, 'x'));
  fs::create_hard_link(folder_ / "arm.hpp", folder_ / "opened_before.hpp");
  ASSERT_EQ(generate("--urdf arm.urdf --output arm.hpp").code, 0);
  EXPECT_THAT(read("arm.hpp"), StartsWith("// Generated"));
  EXPECT_EQ(read("opened_before.hpp"), std::string(100000, 'x')) << "was written into";
}

TEST_F(RobotHeaderProgram, AnErrorIsReportedWithFileAndLine) {
  expect_refused("</joint>", "", StartsWith("bad.urdf:10: malformed XML"));
  expect_refused("<parent link=\"base\"/>", "<parent link=\"bass\"/>",
                 AllOf(StartsWith("bad.urdf:5: "), HasSubstr("bass"), HasSubstr("shoulder")));
  expect_refused("0 0 0.5", "0 0 half", StartsWith("bad.urdf:6: joint 'shoulder': xyz="));
  expect_refused("continuous", "continous", HasSubstr("did you mean 'continuous'?"));
  expect_refused(kHeaderUrdf, "", StartsWith("bad.urdf: the file is empty"));
}

TEST_F(RobotHeaderProgram, ANameThatCannotBeANamespaceIsReportedWithItsLine) {
  expect_refused("\"arm\"", "\"3 arms\"", StartsWith("bad.urdf:2: the robot's name '3 arms' "));
  expect_refused("\"arm\"", "\"class\"", StartsWith("bad.urdf:2: the robot's name 'class' "));
  expect_refused("arm", "arm", StartsWith("'3arms' cannot be a namespace"), "--namespace 3arms");
}

TEST_F(RobotHeaderProgram, FilesThatCannotBeReadOrWritten) {
  const test::Outcome missing = generate("--urdf none.urdf --output arm.hpp");
  EXPECT_EQ(missing.code, 1);
  EXPECT_EQ(missing.err, "none.urdf: cannot be read: No such file or directory\n");
  fs::create_directory(folder_ / "folder.hpp");
  const test::Outcome folder = generate("--urdf arm.urdf --output folder.hpp");
  EXPECT_EQ(folder.code, 1);
  EXPECT_THAT(folder.err, HasSubstr("folder.hpp: exists and is not a file"));
  const test::Outcome itself = generate("--urdf arm.urdf --output ./arm.urdf");
  EXPECT_EQ(itself.code, 1);
  EXPECT_EQ(itself.err, "./arm.urdf: would replace the URDF\n");
  EXPECT_EQ(read("arm.urdf"), kHeaderUrdf);
}

TEST_F(RobotHeaderProgram, PrintsItsUsageWhenItIsCalledWrongly) {
  for (const char* arguments : {"", "arm.urdf", "--urdf arm.urdf", "--output arm.hpp",
                                "--urdf arm.urdf --output", "--urdf a --output b --name c"}) {
    const test::Outcome result = generate(arguments);
    EXPECT_EQ(result.code, 1) << arguments;
    EXPECT_THAT(result.err, StartsWith("usage: kinecal_robot_header --urdf FILE")) << arguments;
  }
}

}  // namespace
}  // namespace kinecal
