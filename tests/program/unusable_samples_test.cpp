// Samples without a feature that an error block could use: every command leaves them out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "kinecal/files/samples/write_samples.hpp"
#include "support/arm_scene.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

/// What a command prints, without how fast it was.
std::string without_speed(const std::string& out) {
  std::istringstream lines(out);
  std::string kept;
  for (std::string line; std::getline(lines, line);) {
    if (!line.ends_with(" per second and core")) kept += line + '\n';
  }
  return kept;
}

class UnusableSamples : public test::ProgramTest {
 protected:
  UnusableSamples() {
    write("arm.urdf", test::kArmUrdf);
    write("c.yaml", test::kArmConfig);
    write_samples_file("usable.yaml", usable_);
  }

  void write_samples_file(const std::string& name, const std::vector<Sample>& samples) const {
    std::ostringstream text;
    write_samples(text, samples);
    write(name, text.str());
  }
  /// One of each kind: not a number, no features, no observation, a single sensor.
  [[nodiscard]] std::vector<Sample> unusable() const {
    std::vector<Sample> samples(usable_.begin(), usable_.begin() + 4);
    for (Feature& feature : samples[0].observations[1].features)
      feature.point.setConstant(std::nan(""));
    samples[1].observations[1].features.clear();
    samples[2].observations.clear();
    samples[3].observations.pop_back();
    return samples;
  }
  [[nodiscard]] test::Outcome call(const std::string& command, const std::string& samples,
                                   const std::string& options) const {
    return kinecal(command + " --urdf arm.urdf --config c.yaml --samples " + samples + " " +
                   options);
  }

  std::vector<Sample> usable_ = test::arm_samples(parse_urdf(test::kArmUrdf, "arm.urdf"), 30);
};

TEST_F(UnusableSamples, AreLeftOutByEveryCommand) {
  std::vector<Sample> first = unusable(), last = usable_;
  first.insert(first.end(), usable_.begin(), usable_.end());
  const std::vector<Sample> more = unusable();
  last.insert(last.end(), more.begin(), more.end());
  write_samples_file("first.yaml", first);
  write_samples_file("last.yaml", last);
  ASSERT_EQ(call("calibrate", "usable.yaml", "--output out").code, 0);
  for (const std::string samples : {"first.yaml", "last.yaml"}) {
    for (const auto& [command, options] :
         {std::pair("check", ""), std::pair("calibrate", "--dry-run"),
          std::pair("identify", "-o i.yaml --force")}) {
      const test::Outcome outcome = call(command, samples, options);
      EXPECT_EQ(outcome.code, 0) << command << " " << samples << "\n" << outcome.err << outcome.out;
    }
    for (const std::string command : {"verify out ", "evaluate out "}) {
      const test::Outcome outcome = kinecal(command + samples);
      EXPECT_EQ(outcome.code, 0) << command << samples << "\n" << outcome.err;
    }
    for (const auto& [command, options] :
         {std::pair("plan", ""), std::pair("select-poses", "--count 5"),
          std::pair("study", "--robots 1 --repeat 2 --poses 20"),
          std::pair("select-poses", "--tell-apart lift,lift_gear_ratio --count 5")}) {
      const test::Outcome outcome = call(command, samples, options),
                          expected = call(command, "usable.yaml", options);
      EXPECT_EQ(outcome.code, expected.code) << command << " " << samples << "\n" << outcome.err;
      EXPECT_THAT(outcome.err, HasSubstr("note: 4 samples left out: no error block")) << command;
      EXPECT_EQ(without_speed(outcome.out), without_speed(expected.out))
          << command << ": the others give what they give alone";
    }
  }
}

TEST_F(UnusableSamples, AloneAreAnErrorWithoutACrash) {
  write_samples_file("none.yaml", unusable());
  for (const std::string command :
       {"check", "calibrate --dry-run", "identify -o i.yaml", "plan", "select-poses", "study"}) {
    const test::Outcome outcome = call(command, "none.yaml", "");
    EXPECT_EQ(outcome.code, 1) << command << "\n" << outcome.err << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr("no sample has usable features")) << command;
  }
}

}  // namespace
}  // namespace kinecal
