// YAML documents as trees, also those that are meant to break the reader.
#include "kinecal/files/yaml/yaml_node.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "kinecal/files/diagnostics.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using namespace detail;

using ::testing::HasSubstr;

/// A node in short: "line:" before each value, ~ for null, tags before what they belong to.
std::string text_of(const YamlNode& node) {
  std::string text = std::to_string(node.line) + ":" + node.tag;
  if (node.is_null()) return text + "~";
  if (node.is_scalar()) return text + "'" + node.text + "'";
  text += node.is_list() ? "[" : "{";
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    text += " ";
    if (node.is_map()) text += text_of(node.keys[i]) + "=";
    text += text_of(node.items[i]);
  }
  return text + (node.is_list() ? " ]" : " }");
}

std::string trees_of(const std::string& text) {
  std::string trees;
  for (const YamlNode& document : parse_yaml(text, "f.yaml")) trees += text_of(document) + "\n";
  return trees;
}

/// The message with which a text is refused.
std::string refusal(const std::string& text) {
  try {
    return "read: " + trees_of(text).substr(0, 100);
  } catch (const InputError& error) {
    return error.what();
  }
}

/// a: &a ["...", ...], b: &b [*a, ...], c: &c [*b, ...] and so on: the last one has width^levels
/// values.
std::string bomb(int levels, int width) {
  std::string text = "a0: &a0 [x]\n";
  for (int level = 1; level <= levels; ++level) {
    const std::string name = "a" + std::to_string(level);
    text += name + ": &" + name + " [";
    for (int i = 0; i < width; ++i) {
      text += (i > 0 ? ", *a" : "*a") + std::to_string(level - 1);
    }
    text += "]\n";
  }
  return text;
}

TEST(YamlNode, HasTheValuesOfTheTextWithTheirLines) {
  EXPECT_EQ(trees_of("a: [1, 'x y']\nb:\n- c: |\n    two\n    lines\n- ~\n"),
            "1:{ 1:'a'=1:[ 1:'1' 1:'x y' ] 2:'b'=3:[ 3:{ 3:'c'=3:'two\nlines\n' } 6:~ ] }\n");
  EXPECT_EQ(trees_of("{a: , '~': ~, \"\": null}\n"), "1:{ 1:'a'=1:~ 1:'~'=1:~ 1:''=1:~ }\n");
  EXPECT_EQ(trees_of("? [a, b]\n: 1\na: 1\na: 2\n"),
            "1:{ 1:[ 1:'a' 1:'b' ]=2:'1' 3:'a'=3:'1' 4:'a'=4:'2' }\n");
}

TEST(YamlNode, KeepsTags) {
  EXPECT_EQ(trees_of("[!degrees 90, !!float 1, !m {}, ! a]\n"),
            "1:[ 1:!degrees'90' 1:tag:yaml.org,2002:float'1' 1:!m{ } 1:!'a' ]\n");
}

TEST(YamlNode, IsADocumentEach) {
  EXPECT_EQ(trees_of(""), "");
  EXPECT_EQ(trees_of("---\n---\na\n...\nb\n"), "2:~\n3:'a'\n5:'b'\n");
}

TEST(YamlNode, FindsTheFirstValueOfAKey) {
  const YamlNode map = parse_yaml("{a: 1, [b]: 2, a: 3, c: }", "f.yaml").at(0);
  ASSERT_NE(map.find("a"), nullptr);
  EXPECT_EQ(map.find("a")->text, "1");
  EXPECT_TRUE(map.find("c")->is_null());
  EXPECT_EQ(map.find("b"), nullptr);
  EXPECT_EQ(map.find("a")->find("a"), nullptr);
}

TEST(YamlNode, AliasesAreCopiesOfTheirAnchor) {
  EXPECT_EQ(trees_of("a: &x [1,\n 2]\nb: *x\n? &k c\n: *k\n"),
            "1:{ 1:'a'=1:[ 1:'1' 2:'2' ] 3:'b'=1:[ 1:'1' 2:'2' ] 4:'c'=4:'c' }\n");
  EXPECT_EQ(trees_of("[&x 1, *x, &x 2, *x, &y [&y 3], *y]\n"),
            "1:[ 1:'1' 1:'1' 1:'2' 1:'2' 1:[ 1:'3' ] 1:'3' ]\n");
  EXPECT_EQ(refusal("a: 1\nb: *c\n"), "f.yaml:2: the alias '*c' has no anchor");
  EXPECT_EQ(refusal("a: &a 1\n---\nb: *a\n"), "f.yaml:3: the alias '*a' has no anchor");
}

TEST(YamlNode, AnAliasInsideOfWhatItNamesIsEmpty) {
  EXPECT_EQ(trees_of("&a [1, *a, {b: *a}]\n"), "1:[ 1:'1' 1:[ ] 1:{ 1:'b'=1:[ ] } ]\n");
  EXPECT_EQ(trees_of("a: &m {b: *m}\n"), "1:{ 1:'a'=1:{ 1:'b'=1:{ } } }\n");
}

TEST(YamlNode, ErrorsHaveFileAndLine) {
  EXPECT_EQ(refusal("a: 1\nb: {c: 1\nd: 2\n"),
            "f.yaml:3: did not find expected ',' or '}' while parsing a flow mapping from line 2");
  EXPECT_THAT(refusal("a: \"b\n"), HasSubstr("f.yaml:2: found unexpected end of stream"));
  EXPECT_THAT(refusal(","), HasSubstr("f.yaml:1: "));
  EXPECT_THAT(refusal("a:\n\tb: 1\n"), HasSubstr("f.yaml:2: "));
}

TEST(YamlNode, RefusesAliasesThatMultiply) {
  EXPECT_THAT(trees_of(bomb(3, 10)), HasSubstr("2:'a1'=2:[ 1:[ 1:'x' ]"));
  EXPECT_THAT(refusal(bomb(20, 10)), HasSubstr("f.yaml:7: the file's values, with what its "
                                               "aliases repeat, need more than 128 MiB"));
  EXPECT_THAT(refusal("a: &a " + std::string(1 << 20, 'x') + "\nb: [*a" +
                      [] {
                        std::string more;
                        for (int i = 0; i < 200; ++i) more += ", *a";
                        return more;
                      }() +
                      "]\n"),
              HasSubstr("f.yaml:2: the file's values"));
}

TEST(YamlNode, RefusesDepthAlsoThroughAliases) {
  const std::string deep = std::string(400, '[') + "1" + std::string(400, ']');
  EXPECT_THAT(refusal(deep), HasSubstr("read: "));
  EXPECT_THAT(refusal(std::string(100000, '[')), HasSubstr("nested too deeply"));
  EXPECT_THAT(refusal("- &a " + deep + "\n- " + std::string(200, '[') + "*a" +
                      std::string(200, ']') + "\n"),
              HasSubstr("f.yaml:2: lists and maps are nested too deeply"));
}

class YamlFile : public test::FolderTest {};

TEST_F(YamlFile, HasASizeAtMost) {
  const std::string path = (folder_ / "large.yaml").string();
  std::ofstream(path) << "a: 1\n";
  EXPECT_EQ(read_yaml_text(path), "a: 1\n");
  std::filesystem::resize_file(path, kMostYamlBytes + 1);  // sparse
  EXPECT_EQ(test::thrown<InputError>([&] { (void)read_yaml_text(path); }),
            path + ": has 134217729 bytes; at most 128 MiB can be read");
  EXPECT_THROW((void)read_yaml_text((folder_ / "none.yaml").string()), InputError);
}

}  // namespace
}  // namespace kinecal
