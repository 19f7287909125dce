// Files that a xacro file includes, by literal names and by packages, and what cannot be found.
#include "kinecal/files/urdf/xacro_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

class XacroFiles : public test::FolderTest {
 protected:
  static std::string robot(const std::string& content) {
    return "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'>\n" + content + "</robot>\n";
  }
  static std::string include(const std::string& name) {
    return "<xacro:include filename='" + name + "'/>\n";
  }
  [[nodiscard]] std::vector<std::string> read(const std::string& name) {
    diagnostics_ = {};
    std::vector<std::string> names;
    for (const XacroFile& file : read_xacro_files(folder_ / name, diagnostics_)) {
      names.push_back(std::filesystem::path(file.name).filename());
    }
    return names;
  }
  void make(const std::string& folder) { std::filesystem::create_directories(folder_ / folder); }

  Diagnostics diagnostics_;
};

TEST_F(XacroFiles, AreReadOnceEachInTheOrderOfIncludes) {
  make("parts");
  write("top.xacro", robot(include("parts/arm.xacro") + "<xacro:if value='1'>" +
                           include("hand.xacro") + "</xacro:if>"));
  write("parts/arm.xacro", robot(include("$(dirname)/wrist.xacro") + include("../top.xacro")));
  write("parts/wrist.xacro", robot(""));
  write("hand.xacro", robot(include("parts/wrist.xacro")));
  EXPECT_THAT(read("top.xacro"),
              ElementsAre("top.xacro", "arm.xacro", "wrist.xacro", "hand.xacro"));
  EXPECT_THAT(diagnostics_.warnings, IsEmpty());
}

TEST_F(XacroFiles, OfAPackageAreFoundInAParentFolder) {
  make("arm_description/urdf");
  make("work/urdf");
  write("arm_description/urdf/top.xacro", robot(include("$(find arm_description)/urdf/a.xacro")));
  write("arm_description/urdf/a.xacro", robot(""));
  EXPECT_THAT(read("arm_description/urdf/top.xacro"), ElementsAre("top.xacro", "a.xacro"));
  write("work/package.xml", "<package><name>arm_description</name></package>");
  write("work/urdf/top.xacro", robot(include("$(find arm_description)/urdf/a.xacro")));
  write("work/urdf/a.xacro", robot(""));
  EXPECT_THAT(read("work/urdf/top.xacro"), ElementsAre("top.xacro", "a.xacro"));
  EXPECT_THAT(diagnostics_.warnings, IsEmpty());
}

TEST_F(XacroFiles, ThatCannotBeReadAreNamed) {
  write("top.xacro", robot(include("$(find other)/a.xacro") + include("${name}.xacro") +
                           include("missing.xacro") + include("notes.xacro") +
                           "<xacro:include filename='missing.xacro' optional='true'/>"));
  write("notes.xacro", "no XML");
  EXPECT_THAT(read("top.xacro"), ElementsAre("top.xacro"));
  EXPECT_THAT(
      diagnostics_.warnings,
      ElementsAre(EndsWith("top.xacro:2: '$(find other)/a.xacro' is included and not patched: no "
                           "folder above is package 'other' and has it"),
                  EndsWith("top.xacro:3: '${name}.xacro' is included and not patched: its name is "
                           "an expression"),
                  EndsWith("top.xacro:4: 'missing.xacro' is included and not patched: there is no "
                           "such file"),
                  AllOf(HasSubstr("top.xacro:5: 'notes.xacro' is included and not patched: "),
                        HasSubstr("notes.xacro:1: malformed XML"))));
}

TEST_F(XacroFiles, ItselfMustBeXacro) {
  EXPECT_THROW((void)read("nowhere.xacro"), InputError);
  write("a.xacro", "<a/>");
  EXPECT_THROW((void)read("a.xacro"), InputError);
}

}  // namespace
}  // namespace kinecal
