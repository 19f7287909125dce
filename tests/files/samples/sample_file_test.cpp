#include "kinecal/files/samples/sample_file.ipp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "kinecal/files/samples/write_samples.hpp"

namespace kinecal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

struct ReadPieces {
  std::string samples;  ///< as they are written, and where they came from
  std::vector<std::string> errors, warnings;
  bool operator==(const ReadPieces&) const = default;
};

std::ostream& operator<<(std::ostream& out, const ReadPieces& r) {
  return out << r.samples << ::testing::PrintToString(r.errors)
             << ::testing::PrintToString(r.warnings);
}

ReadPieces read_pieces(const std::string& text, std::size_t piece_bytes, std::size_t threads) {
  std::istringstream in(text);
  detail::SampleFile file(in, "s.yaml", piece_bytes);
  file.read(threads);
  Diagnostics diagnostics;
  const std::vector<Sample> samples = file.take(diagnostics);
  std::ostringstream out;
  write_samples(out, samples);
  for (const Sample& sample : samples) out << sample.source << '\n';
  return {out.str(), diagnostics.errors, diagnostics.warnings};
}

constexpr std::size_t kAll = 1 << 20;  ///< bytes of a piece that holds the whole file

/// In one piece or many, on one thread or several: the same.
ReadPieces read_in_every_way(const std::string& text) {
  ReadPieces whole = read_pieces(text, kAll, 1);
  for (const std::size_t bytes : {1, 7, 100, 250, 1000}) {
    for (const std::size_t threads : {1, 4}) {
      EXPECT_EQ(read_pieces(text, bytes, threads), whole)
          << bytes << " bytes, " << threads << " threads\n"
          << text;
    }
  }
  return whole;
}

const std::string kTwoJoints = "joint_states: {name: [a, b], position: [0.5, -1]}\n";
const std::string kOneArm =
    "observations:\n"
    "- sensor_name: arm\n"
    "  features: [{header: {frame_id: tip}, point: {x: 1, y: 2, z: 3}}]\n";
const std::string kOneSample = kTwoJoints + kOneArm + "---\n";  // four lines and the separator

/// Different samples, so that their order shows.
std::string many_samples(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    text +=
        "joint_states: {name: [a], position: [" + std::to_string(i) + "]}\n" + kOneArm + "---\n";
  }
  return text;
}

TEST(SampleFile, SamplesStandInTheOrderOfTheFile) {
  const ReadPieces reading = read_in_every_way(many_samples(200));
  EXPECT_THAT(reading.errors, IsEmpty());
  EXPECT_THAT(reading.warnings, IsEmpty());
  std::size_t at = 0;
  for (int i = 0; i < 200; ++i) {
    at = reading.samples.find("position: [" + std::to_string(i) + ".0]", at);
    ASSERT_NE(at, std::string::npos) << i;
  }
  EXPECT_THAT(reading.samples, HasSubstr("\ns.yaml:996\n"));
}

TEST(SampleFile, FirstErrorOfTheFileIsTheFirstThatIsReported) {
  const std::string mistake = "joint_states: {name: [a], position: [x]}\n" + kOneArm + "---\n";
  const ReadPieces reading = read_in_every_way(many_samples(30) + mistake + many_samples(30) +
                                               mistake + "---\n" + kTwoJoints + "---\n");
  EXPECT_THAT(reading.errors, ElementsAre(HasSubstr("s.yaml:151: position: 'x' is not a number"),
                                          HasSubstr("s.yaml:306: position: 'x' is not a number"),
                                          HasSubstr("s.yaml:312: sample without 'observations'")));
}

TEST(SampleFile, NothingIsReportedAfterTextThatIsNotYaml) {
  const std::string open = "joint_states: {name: [a], position: [x]\n";
  for (const std::string& not_yaml :
       {open + kOneArm + "---\n", std::string(", a\n---\n"), std::string("\"a\n---\n"),
        std::string("a: [\n---\n"), std::string("]\n"), std::string("*a\n---\n"),
        std::string("a\nb: c\n---\n"), std::string("\tx: [}\n"), std::string("? [\n---\n---\n")}) {
    const ReadPieces reading =
        read_in_every_way(many_samples(20) + not_yaml + many_samples(20) + open + "---\n");
    ASSERT_FALSE(reading.errors.empty());
    EXPECT_THAT(reading.errors.back(), AllOf(StartsWith("s.yaml:10"), HasSubstr("not YAML"),
                                             HasSubstr("the last sample begins at line ")));
    EXPECT_THAT(reading.samples, HasSubstr("\ns.yaml:96\n"));
    EXPECT_LE(reading.errors.size(), 2u);
  }
}

TEST(SampleFile, SampleBeforeTextThatIsNotYamlMayBeInAnotherPiece) {
  const ReadPieces reading = read_in_every_way(kOneSample + kOneSample + ", a\n");
  EXPECT_THAT(reading.errors, ElementsAre(AllOf(StartsWith("s.yaml:11: not YAML"),
                                                HasSubstr("the last sample begins at line 6;"))));
}

TEST(SampleFile, OutputOfARecordingToolIsNamed) {
  const std::string lost = "A message was lost!!!\n\ttotal count change:1\n\ttotal count: 1---\n";
  const std::string silent =
      "WARNING: no messages received and simulated time is active.\nIs /clock being published?\n";
  const ReadPieces reading = read_in_every_way(silent + kOneSample + lost + kOneSample + silent +
                                               silent + many_samples(20) + lost + kOneSample);
  const std::string says = " are output of the tool that recorded the file; delete them";
  EXPECT_THAT(reading.errors,
              ElementsAre("s.yaml:1: lines 1 to 2" + says, "s.yaml:8: lines 8 to 10" + says,
                          "s.yaml:16: lines 16 to 17" + says, "s.yaml:18: lines 18 to 19" + says,
                          "s.yaml:120: lines 120 to 122" + says));
}

TEST(SampleFile, OnlyTheLastSampleMayBeCutOff) {
  const std::string wrong = "joint_states: {name: [a], position: [x]}\n" + kOneArm;
  const std::string not_yaml = "joint_states: {name: [a], position: [x]\n" + kOneArm;
  const auto asks = [](const ReadPieces& reading) {
    return !reading.errors.empty() && reading.errors.back().ends_with("; is the file cut off?");
  };
  EXPECT_TRUE(asks(read_in_every_way(kOneSample + wrong)));
  EXPECT_TRUE(asks(read_in_every_way(kOneSample + not_yaml)));
  EXPECT_FALSE(asks(read_in_every_way(kOneSample + wrong + "---\n")));
  EXPECT_FALSE(asks(read_in_every_way(kOneSample + not_yaml + "---\n" + kOneSample)));
  EXPECT_FALSE(asks(read_in_every_way(kOneSample + wrong + "---\n" + kTwoJoints + kOneArm)));
}

TEST(SampleFile, DocumentsEndAndBeginInEveryWayOfYaml) {
  const std::string sample = kTwoJoints + kOneArm;
  const std::string crlf = [](std::string text) {
    for (std::size_t i = 0; (i = text.find('\n', i)) != std::string::npos; i += 2) {
      text.insert(i, "\r");
    }
    return text;
  }(kOneSample + "...\n" + kOneSample + "---\n" + kOneSample);
  const std::pair<std::string, int> texts[] = {
      {"---\n" + kOneSample + kOneSample, 2},
      {"\xef\xbb\xbf" + kOneSample + kOneSample, 2},
      {kOneSample + "---\n---\n\n# a comment\n---\n" + kOneSample, 2},
      {kOneSample + "# ---\n" + sample + "# ---\n---\n", 2},
      {kOneSample + sample + "...\n---\n", 2},
      {sample + "...\n" + sample + "... # no marker follows\n" + sample + "---\n", 3},
      {"%YAML 1.2\n---\n" + sample + "...\n%YAML 1.1\n# c\n\n---\n" + kOneSample + kOneSample, 3},
      {"%TAG !e! tag:example.com,2000:\n---\nx: !e!a 1\n" + kOneSample, 1},
      {sample + "--- # a comment\n" + sample + "--- \n" + sample + "---\t\n", 3},
      {kOneSample + "--- {joint_states: {name: [], position: []}, observations: []}\n---\n", 2},
      {"x: |\n  ---\n  ...\ny: '\n  ---\n  '\nz: \"\n ---\n\"\n" + kOneSample + kOneSample, 2},
      {"x: a\n  ---\n  b\n" + kOneSample + "----: 1\n---x: 2\n...y: 3\n" + kOneSample, 2},
      {crlf, 3},
  };
  for (const auto& [text, count] : texts) {
    const ReadPieces reading = read_in_every_way(text);
    EXPECT_THAT(reading.errors, IsEmpty()) << text;
    EXPECT_THAT(reading.warnings, IsEmpty()) << text;
    int found = 0;
    for (std::size_t at = 0; (at = reading.samples.find("s.yaml:", at)) != std::string::npos;
         ++at) {
      ++found;
    }
    EXPECT_EQ(found, count) << text;
  }
}

TEST(SampleFile, MissingSeparatorAtTheEndIsReported) {
  const std::string sample = kTwoJoints + kOneArm;
  EXPECT_THAT(read_in_every_way(kOneSample + sample).warnings,
              ElementsAre(AllOf(StartsWith("s.yaml:6: "), HasSubstr("no '---'"))));
  EXPECT_THAT(read_in_every_way(kOneSample + sample + "...\n").warnings.size(), 1u);
  EXPECT_THAT(read_in_every_way(kOneSample + sample.substr(0, sample.size() - 2)).errors.size(),
              1u);
  EXPECT_THAT(read_in_every_way(kOneSample + sample + "x: 1").errors,
              ElementsAre(HasSubstr("s.yaml:6: the file ends within a line")));
}

TEST(SampleFile, FileWithoutSamplesIsAnErrorInEveryWay) {
  EXPECT_THAT(read_in_every_way("").errors, ElementsAre("s.yaml: no samples: the file is empty"));
  for (const std::string text : {"\n", "---\n", "---\n---\n# c\n---\n...\n---\n"}) {
    EXPECT_THAT(read_in_every_way(text).errors, ElementsAre("s.yaml: no samples in this file"));
  }
}

TEST(SampleFile, ManyErrorsEndAtTheSamePlaceOnAnyNumberOfThreads) {
  std::string text = many_samples(10);
  for (int i = 0; i < 500; ++i) text += kTwoJoints + "---\n";
  for (const std::size_t bytes : {std::size_t{1}, std::size_t{300}, kAll}) {
    for (const std::size_t threads : {1, 2, 8}) {
      const ReadPieces reading = read_pieces(text, bytes, threads);
      ASSERT_EQ(reading.errors.size(), 21u);
      EXPECT_THAT(reading.errors[0], StartsWith("s.yaml:51: sample without 'observations'"));
      EXPECT_THAT(reading.errors[20], StartsWith("s.yaml:91: more than 20 errors"));
      EXPECT_EQ(reading.samples, read_pieces(many_samples(10), kAll, 1).samples);
    }
  }
}

TEST(SampleFile, FileThatIsCutOffAnywhereIsTheSameInEveryWay) {
  const std::string text = kOneSample + "%YAML 1.2\n---\n" + kOneSample + "...\n" + kOneSample;
  for (std::size_t length = 0; length < text.size(); length += 3) {
    (void)read_in_every_way(text.substr(0, length));
  }
}

}  // namespace
}  // namespace kinecal
