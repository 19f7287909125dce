#include "kinecal/text/shell_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/text/name_list.hpp"
#include "support/hostile_names.hpp"
#include "support/shell_words.hpp"

namespace kinecal {
namespace {

using testing::ElementsAreArray;

TEST(ShellCommand, AShellReadsEachWordAsItIsAndRunsNothingElse) {
  ShellCommand command{"kinecal"};
  std::vector<std::string> words = {"kinecal"};
  for (const std::string& name : test::kHostileNames) {
    command.add({name});
    words.push_back(name);
    const test::PastedCommand alone = test::paste(ShellCommand{"kinecal", name}.str());
    EXPECT_FALSE(alone.did_more) << name;
    EXPECT_THAT(alone.words, ElementsAreArray({std::string("kinecal"), name}));
  }
  EXPECT_THAT(test::paste(command.str()).words, ElementsAreArray(words));
}

TEST(ShellCommand, IsOneLineThatHidesNothing) {
  for (const std::string& name : test::kRefusedNames) {
    const std::string line = ShellCommand{"kinecal", name, "\xff'\\\t", "gpj.\u202Eexe"}.str();
    EXPECT_EQ(line.find_first_of("\n\r\t\x1b\xff"), std::string::npos) << line;
    EXPECT_EQ(line.find("\u202E"), std::string::npos) << line;
    EXPECT_THAT(test::paste(line, "bash").words,
                ElementsAreArray({std::string("kinecal"), name, std::string("\xff'\\\t"),
                                  std::string("gpj.\u202Eexe")}));
    EXPECT_FALSE(test::paste(line).did_more)
        << "older shells take it for another word, but run nothing";
  }
}

TEST(ShellCommand, LeavesPlainWordsAlone) {
  EXPECT_EQ((ShellCommand{"kinecal", "calibrate", "--camera", "cam=a/b.yaml:cam1", "50%"}.str()),
            "kinecal calibrate --camera cam=a/b.yaml:cam1 50%");
  EXPECT_EQ(shell_word(""), "''");
  EXPECT_EQ(shell_word("=ls"), "'=ls'") << "zsh would take it for the path of ls";
}

TEST(ShellCommand, JoinsValuesThatLookLikeOptionsToTheirOption) {
  EXPECT_EQ(ShellCommand().add_option("--hold", {"a", "-b", "c", "d"}).str(),
            "--hold a --hold=-b --hold c d");
  EXPECT_TRUE(ShellCommand().add_option("--hold", {}).empty());
  EXPECT_EQ(ShellCommand().add_names("--hold", {"-a,b", "c"}).str(), "'--hold=-a\\,b' --hold c");
  EXPECT_EQ(shell_file("-a.yaml"), "./-a.yaml");
  EXPECT_EQ(shell_file("a.yaml"), "a.yaml");
}

TEST(NameList, GivesNamesAsTheyWere) {
  for (const std::string& name : test::kHostileNames) {
    EXPECT_THAT(names_of_list(list_entry(name)), ElementsAreArray({name}));
    EXPECT_THAT(names_of_list("a," + list_entry(name) + ",,b"),
                ElementsAreArray({std::string("a"), name, std::string("b")}));
  }
  EXPECT_THAT(names_of_list("C:\\x,"), ElementsAreArray({"C:\\x"})) << "as somebody types it";
  EXPECT_THAT(names_of_list(","), testing::IsEmpty());
}

TEST(ShellCommand, KnowsItsWords) {
  const ShellCommand command = ShellCommand{"kinecal"}.add({"--output", "--force it"});
  EXPECT_TRUE(command.has("--output"));
  EXPECT_FALSE(command.has("--force"));
  EXPECT_FALSE(command.empty());
}

}  // namespace
}  // namespace kinecal
