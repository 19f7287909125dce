// The order of the folders (ARCHITECTURE.md): a folder includes only folders above it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <pugixml.hpp>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "support/paths.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;

const fs::path kHeaders = fs::path(test::source_folder()) / "include/kinecal";

/// The folders in the order of ARCHITECTURE.md: each may include those before it.
const std::vector<std::string> kFolders = [] {
  std::ifstream file(fs::path(test::source_folder()) / "ARCHITECTURE.md");
  const std::regex row(R"(\| `([a-z]+)/` \|.*)");
  std::vector<std::string> folders;
  std::smatch found;
  for (std::string line; std::getline(file, line);) {
    if (std::regex_match(line, found, row)) folders.push_back(found[1]);
  }
  return folders;
}();
/// For tests: no umbrella header of the whole tree includes it.
const std::string kForTests = "testing";
/// A module that Python loads: no header for others.
const std::string kModule = "python";

struct Include {
  fs::path header;
  std::string target;
};

/// Headers, and their definitions (.cpp, .ipp).
bool is_source(const fs::path& file) {
  return file.extension() == ".hpp" || file.extension() == ".ipp" || file.extension() == ".cpp";
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<Include> all_includes(const fs::path& folder = kHeaders) {
  std::vector<Include> includes;
  const std::string directive = "#include ";
  for (const auto& file : fs::recursive_directory_iterator(folder)) {
    if (!is_source(file.path())) continue;
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

/// Place of a folder in the order.
std::ptrdiff_t rank(const std::string& folder) {
  return std::find(kFolders.begin(), kFolders.end(), folder) - kFolders.begin();
}

/// The folder of include/kinecal that holds a header; empty for an umbrella header.
std::string folder_of(const fs::path& header) {
  const fs::path relative = fs::relative(header, kHeaders);
  return relative.has_parent_path() ? relative.begin()->string() : "";
}

TEST(Architecture, AFolderIncludesOnlyFoldersAboveIt) {
  const auto includes = all_includes();
  ASSERT_GT(includes.size(), 100u);
  for (const auto& [header, target] : includes) {
    const std::string folder = folder_of(header);
    if (folder.empty() || !target.starts_with("kinecal/")) continue;
    if (target == "kinecal/linkage.hpp") continue;  // a macro, below all folders
    ASSERT_LT(rank(folder), std::ssize(kFolders)) << "unknown folder " << folder;
    const fs::path path = fs::path(target).lexically_relative("kinecal");
    const std::string other = path.begin()->stem().string();
    EXPECT_LE(rank(other), rank(folder)) << header << " includes " << target;
    EXPECT_TRUE(other != kForTests || folder == kForTests) << header << " includes " << target;
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
      EXPECT_EQ(folder, "files") << header << " includes " << target;
      EXPECT_NE(header.extension(), ".hpp") << header << " shows " << target << " to other folders";
    }
  }
}

/// An .ipp is the definitions of a header, or a piece of sources of its folder.
TEST(Architecture, NoFolderIncludesAPieceOfAnother) {
  for (const auto& [source, target] : all_includes()) {
    if (!target.starts_with("kinecal/") || !target.ends_with(".ipp")) continue;
    EXPECT_EQ(folder_of(kHeaders.parent_path() / target), folder_of(source))
        << source << " includes " << target;
  }
}

/// A file holds what its name says, whole: nothing is cut off only to make it shorter.  The exceptions are formats,
/// wraps of libraries that may be absent, classes in the files of their names, and chapters: the suspects of a drive, the
/// judgement of error blocks.
TEST(Architecture, APieceWithOneIncluderIsInIt) {
  const std::set<std::string> exceptions = {
      "explain/drive_suspects.ipp",         "explain/refit.ipp",
      "files/bags/codec/bz2.ipp",           "files/bags/codec/lz4.ipp",
      "files/bags/rosbag2/sqlite.ipp",      "files/images/bmp_image.ipp",
      "files/images/jpeg_image.ipp",        "files/images/png_image.ipp",
      "files/images/tiff_image.ipp",        "files/meshes/dae_mesh.ipp",
      "files/meshes/stl_mesh.ipp",          "trust/judge_blocks.ipp",
      "trust/systematic/change_trials.ipp", "trust/systematic/joint_trials.ipp",
      "trust/systematic/lens_trials.ipp",
  };
  std::map<std::string, std::set<std::string>> includers;  // of each piece
  for (const char* folder : {"include/kinecal", "examples", "tests", "benchmarks"}) {
    for (const auto& [source, target] : all_includes(fs::path(test::source_folder()) / folder)) {
      if (target.starts_with("kinecal/") && target.ends_with(".ipp")) {
        includers[target.substr(std::string("kinecal/").size())].insert(source.string());
      }
    }
  }
  ASSERT_GT(includers.size(), 50u);
  std::set<std::string> pieces;
  for (const auto& [piece, sources] : includers) {
    const bool defines = fs::exists((kHeaders / piece).replace_extension(".hpp"));
    if (fs::exists(kHeaders / piece) && !defines && sources.size() == 1)
      pieces.insert(piece);  // not made by CMake
  }
  EXPECT_EQ(pieces, exceptions);
}

TEST(Architecture, TheUmbrellaHeaderOfAFolderIncludesAllItsHeaders) {
  for (const std::string& folder : kFolders) {
    if (folder == kModule) continue;
    const fs::path umbrella = kHeaders / (folder + ".hpp");
    ASSERT_TRUE(fs::exists(umbrella)) << umbrella;
    const std::string text = text_of(umbrella);
    int headers = 0;
    for (const auto& file : fs::recursive_directory_iterator(kHeaders / folder)) {
      if (file.path().extension() != ".hpp") continue;
      ++headers;
      const std::string name = "kinecal/" + fs::relative(file.path(), kHeaders).string();
      EXPECT_THAT(text, testing::HasSubstr("\"" + name + "\"")) << "not in " << umbrella;
    }
    EXPECT_GT(headers, 0) << folder;
  }
}

/// The umbrella headers that an umbrella header of the whole tree includes, without ".hpp".
std::vector<std::string> included_by(const std::string& umbrella) {
  std::vector<std::string> names;
  for (const auto& [header, target] : all_includes()) {
    if (header == kHeaders / umbrella) names.push_back(fs::path(target).stem().string());
  }
  return names;
}

TEST(Architecture, CoreIncludesTheFoldersThatNeedOnlyEigenAndKinecalIncludesTheRest) {
  const auto solve = std::find(kFolders.begin(), kFolders.end(), "solve");
  std::vector<std::string> first(kFolders.begin(), solve);
  std::erase(first, kForTests);
  EXPECT_THAT(included_by("core.hpp"), testing::UnorderedElementsAreArray(first));
  std::vector<std::string> rest(solve, kFolders.end());
  std::erase(rest, kModule);
  rest.push_back("core");
  EXPECT_THAT(included_by("kinecal.hpp"), testing::UnorderedElementsAreArray(rest));
}

/// What files/ declares in a .ipp without a header of the same name is not for users.  (Other folders
/// also have .ipp files that only instantiate what their headers declare.)
TEST(Architecture, WhatNoHeaderDeclaresIsInDetail) {
  int insides = 0;
  for (const auto& file : fs::recursive_directory_iterator(kHeaders / "files")) {
    fs::path header = file.path();
    if (header.extension() != ".ipp" || fs::exists(header.replace_extension(".hpp"))) continue;
    ++insides;
    const std::string text = text_of(file.path());
    EXPECT_THAT(text, testing::HasSubstr("\nnamespace kinecal::detail {\n")) << file.path();
    EXPECT_THAT(text, testing::Not(testing::HasSubstr("\nnamespace kinecal {\n"))) << file.path();
  }
  EXPECT_GT(insides, 30);
}

/// Above solve/, `x.cpp` beside `x.hpp` defines; an .ipp is a piece without a header, for a .cpp.
TEST(Architecture, HeaderOnlyEndsWithSolve) {
  int units = 0;
  for (const auto& file : fs::recursive_directory_iterator(kHeaders)) {
    if (!is_source(file.path()) || file.path().parent_path() == kHeaders) continue;
    const bool is_unit = file.path().extension() == ".cpp";
    if (rank(folder_of(file.path())) <= rank("solve")) {
      EXPECT_FALSE(is_unit) << file.path()
                            << " is missing where every source compiles what it includes";
      continue;
    }
    units += is_unit;
    if (folder_of(file.path()) == kModule) continue;
    fs::path header = file.path();
    const bool has_header = fs::exists(header.replace_extension(".hpp"));
    EXPECT_EQ(has_header, file.path().extension() != ".ipp") << file.path();
    EXPECT_THAT(text_of(file.path()),
                testing::Not(testing::ContainsRegex("KINECAL_(HEADER_ONLY|INLINE)")))
        << file.path();
  }
  EXPECT_GT(units, 200);
}

TEST(Architecture, AUnitIncludesItsHeaderFirst) {
  std::string before;
  for (const auto& [source, target] : all_includes()) {
    const bool has_header = folder_of(source) != kModule;
    if (source.extension() == ".cpp" && has_header && source.string() != before) {
      fs::path header = fs::relative(source, kHeaders.parent_path());
      EXPECT_EQ(target, header.replace_extension(".hpp").string()) << source;
    }
    before = source.string();
  }
}

TEST(Architecture, EveryHeaderHasALicence) {
  int headers = 0;
  for (const auto& file : fs::recursive_directory_iterator(kHeaders)) {
    if (!is_source(file.path())) continue;
    ++headers;
    const std::string text = text_of(file.path());
    EXPECT_THAT(text, testing::HasSubstr("SPDX-License-Identifier: Apache-2.0")) << file.path();
    EXPECT_THAT(text, testing::StartsWith("// ")) << file.path();
  }
  EXPECT_GT(headers, 100);
}

/// A name in a command that people paste is quoted if the command is made of words: ShellCommand.  So no text has a place
/// for a name after a command of kinecal, or after an option that takes a name.
TEST(Architecture, CommandsAreMadeOfWords) {
  const std::regex place(
      R"re("[^"\n]*(kinecal [a-z-]+ (--[a-z-]+ )?|--(urdf|config|samples|camera|output|name)[ =])(\{|" ?\+))re");
  int sources = 0;
  for (const fs::path& root : {kHeaders, fs::path(test::source_folder()) / "examples/cli"}) {
    for (const auto& file : fs::recursive_directory_iterator(root)) {
      if (!is_source(file.path())) continue;
      ++sources;
      const std::string text = text_of(file.path());
      for (std::sregex_iterator at(text.begin(), text.end(), place), end; at != end; ++at) {
        ADD_FAILURE() << file.path() << ": compose it with ShellCommand: " << at->str();
      }
    }
  }
  EXPECT_GT(sources, 500);
}

TEST(Architecture, RosSeesTheVersionThatCMakeHas) {
  pugi::xml_document xml;
  ASSERT_TRUE(xml.load_file((fs::path(test::source_folder()) / "package.xml").c_str()));
  const pugi::xml_node package = xml.child("package");
  EXPECT_STREQ(package.attribute("format").value(), "3");
  EXPECT_STREQ(package.child_value("name"), "kinecal");
  EXPECT_STREQ(package.child_value("version"), KINECAL_VERSION);
  EXPECT_STREQ(package.child("export").child_value("build_type"), "cmake");
}

}  // namespace
}  // namespace kinecal
