// The texts of the tree: their links lead to what is there, also in the installed copies.
#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "support/paths.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;

/// What cmake/KinecalInstall.cmake installs beside each other, with examples/.
const std::set<std::string> kTexts = {"README.md",   "MANUAL.md",       "BACKGROUND.md",
                                      "CONCEPTS.md", "ARCHITECTURE.md", "CONTRIBUTING.md"};

std::string content_of(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The anchors of a text: "## Take samples" is #take-samples.
std::set<std::string> anchors_of(const std::string& text) {
  std::set<std::string> anchors;
  const std::regex heading("(^|\n)#+ ([^\n]+)");
  for (std::sregex_iterator at(text.begin(), text.end(), heading), end; at != end; ++at) {
    std::string anchor;
    for (const char c : at->str(2)) {
      if (c == ' ' || c == '-') anchor += '-';
      const auto byte = static_cast<unsigned char>(c);
      if (std::isalnum(byte) != 0 || c == '_' || byte >= 0x80)
        anchor += static_cast<char>(std::tolower(byte));
    }
    anchors.insert(anchor);
  }
  return anchors;
}

TEST(Texts, LinksLeadToWhatIsInstalledAndToHeadings) {
  const fs::path root = test::source_folder();
  const std::regex link(R"(\]\(([^)#\s:]*)(#([^)\s]*))?\))");
  std::map<std::string, std::set<std::string>> anchors;
  for (const std::string& name : kTexts) anchors[name] = anchors_of(content_of(root / name));
  int links = 0;
  for (const std::string& name : kTexts) {
    const std::string text = content_of(root / name);
    ASSERT_FALSE(text.empty()) << name;
    for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at) {
      const std::string file = at->str(1).empty() ? name : at->str(1);
      EXPECT_TRUE(fs::exists(root / file)) << name << ": " << at->str();
      EXPECT_TRUE(kTexts.contains(file) || file == "LICENSE" || file.starts_with("examples"))
          << name << " links to " << file << ", which is not installed beside it";
      if (!at->str(3).empty()) {
        EXPECT_TRUE(anchors[file].contains(at->str(3)))
            << name << ": no heading in " << file << " for " << at->str();
      }
      ++links;
    }
  }
  EXPECT_GT(links, 60);
  const std::string installed = content_of(root / "cmake/KinecalInstall.cmake");
  for (const std::string& name : kTexts) {
    EXPECT_NE(installed.find(name), std::string::npos) << name << " is not installed";
  }
}

}  // namespace
}  // namespace kinecal
