// The tree reads as the way of the data: a folder includes only folders that stand above it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <pugixml.hpp>
#include <string>
#include <vector>

namespace kinecal {
namespace {

namespace fs = std::filesystem;

const fs::path kHeaders = fs::path(KINECAL_SOURCE_DIR) / "include/kinecal";

/// From the ground up; what a folder may include stands before it.
const std::vector<std::string> kFolders = {"geometry", "kinematics", "parameters", "samples",
                                           "sensors",  "errors",     "crate",      "solve",
                                           "trust",    "io",         "report"};

struct Include {
  fs::path header;
  std::string target;
};

std::vector<Include> all_includes() {
  std::vector<Include> includes;
  const std::string directive = "#include ";
  for (const auto& file : fs::recursive_directory_iterator(kHeaders)) {
    if (file.path().extension() != ".hpp") continue;
    std::ifstream in(file.path());
    for (std::string line; std::getline(in, line);) {
      if (!line.starts_with(directive)) continue;
      const std::size_t first = directive.size() + 1;
      includes.push_back(
          {file.path(), line.substr(first, line.find_first_of(">\"", first) - first)});
    }
  }
  return includes;
}

/// Where a header stands in the order; the doors and kinecal.hpp stand outside of it.
std::ptrdiff_t rank(const std::string& folder) {
  return std::find(kFolders.begin(), kFolders.end(), folder) - kFolders.begin();
}

/// The folder of include/kinecal in which a header stands; empty for a door.
std::string folder_of(const fs::path& header) {
  const fs::path relative = fs::relative(header, kHeaders);
  return relative.has_parent_path() ? relative.begin()->string() : "";
}

TEST(Architecture, AFolderIncludesOnlyFoldersThatStandAboveIt) {
  const auto includes = all_includes();
  ASSERT_GT(includes.size(), 100u);
  for (const auto& [header, target] : includes) {
    const std::string folder = folder_of(header);
    if (folder.empty() || !target.starts_with("kinecal/")) continue;
    ASSERT_LT(rank(folder), std::ssize(kFolders)) << "unknown folder " << folder;
    const fs::path path = fs::path(target).lexically_relative("kinecal");
    const std::string other = path.begin()->stem().string();
    EXPECT_LE(rank(other), rank(folder)) << header << " includes " << target;
  }
}

TEST(Architecture, CoreSeesEigenAndTheStandardLibraryOnly) {
  for (const auto& [header, target] : all_includes()) {
    const std::string folder = folder_of(header);
    if (folder.empty() || target.starts_with("kinecal/") || target.starts_with("Eigen/")) continue;
    const bool standard = target.find_first_of("/.") == std::string::npos ||
                          target.ends_with("mmintrin.h");  // the compiler's own
    if (rank(folder) < rank("solve")) {
      EXPECT_TRUE(standard) << header << " includes " << target;
    }
    if (target.starts_with("ceres/")) {
      EXPECT_EQ(folder, "solve") << header << " includes " << target;
    }
    if (target.starts_with("urdf") || target.starts_with("yaml-cpp/") || target == "yaml.h" ||
        target == "pugixml.hpp") {
      EXPECT_EQ(folder, "io") << header << " includes " << target;
    }
  }
}

TEST(Architecture, EachFolderHasADoorThatOpensAllOfIt) {
  for (const std::string& folder : kFolders) {
    const fs::path door = kHeaders / (folder + ".hpp");
    ASSERT_TRUE(fs::exists(door)) << door;
    std::ifstream in(door);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    for (const auto& file : fs::recursive_directory_iterator(kHeaders / folder)) {
      if (file.is_directory()) continue;
      const std::string name = "kinecal/" + fs::relative(file.path(), kHeaders).string();
      EXPECT_THAT(text, testing::HasSubstr("\"" + name + "\"")) << "not in " << door;
    }
  }
}

/// What a door of the whole tree opens: kinecal/<name>.hpp.
std::vector<std::string> opened_by(const std::string& door) {
  std::vector<std::string> doors;
  for (const auto& [header, target] : all_includes()) {
    if (header == kHeaders / door) doors.push_back(fs::path(target).stem().string());
  }
  return doors;
}

TEST(Architecture, CoreOpensAllFoldersThatNeedEigenAloneAndKinecalOpensTheRest) {
  const auto solve = std::find(kFolders.begin(), kFolders.end(), "solve");
  EXPECT_THAT(opened_by("core.hpp"), testing::UnorderedElementsAreArray(kFolders.begin(), solve));
  std::vector<std::string> rest(solve, kFolders.end());
  rest.push_back("core");
  EXPECT_THAT(opened_by("kinecal.hpp"), testing::UnorderedElementsAreArray(rest));
}

TEST(Architecture, EveryHeaderHasALicenceAndFitsIntoTheHead) {
  for (const auto& file : fs::recursive_directory_iterator(kHeaders)) {
    if (file.path().extension() != ".hpp") continue;
    std::ifstream in(file.path());
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    EXPECT_THAT(text, testing::HasSubstr("SPDX-License-Identifier: Apache-2.0")) << file.path();
    EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 270) << file.path();
    EXPECT_THAT(text, testing::StartsWith("// ")) << file.path();
  }
}

TEST(Architecture, RosSeesTheVersionThatCMakeHas) {
  pugi::xml_document xml;
  ASSERT_TRUE(xml.load_file((fs::path(KINECAL_SOURCE_DIR) / "package.xml").c_str()));
  const pugi::xml_node package = xml.child("package");
  EXPECT_STREQ(package.attribute("format").value(), "3");
  EXPECT_STREQ(package.child_value("name"), "kinecal");
  EXPECT_STREQ(package.child_value("version"), KINECAL_VERSION);
  EXPECT_STREQ(package.child("export").child_value("build_type"), "cmake");
}

}  // namespace
}  // namespace kinecal
