#include "kinecal/files/recordings/write_recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/recordings/read_recording.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

std::vector<Sample> two_samples() {
  Sample sample;
  sample.joint_names = {"pan", "tilt"};
  sample.joint_positions = {0.125, -1.5};
  sample.observations = {{"camera", {{"optical", {0.1, 0.2, 0.3}}}}, {"arm", {{"led", {1, 2, 3}}}}};
  std::vector<Sample> samples(2, sample);
  samples[1].joint_positions[0] = 0.1;
  samples[1].stamp = std::chrono::nanoseconds(1'700'000'000'123'456'789);
  return samples;
}

TEST(WriteRecording, WritesWhatIsReadAgainInEachFormat) {
  const test::TemporaryFolder folder;
  for (const char* name : {"samples.yaml", "samples.bag", "samples.mcap"}) {
    const std::string path = (folder.path() / name).string();
    write_recording(path, {});
    write_recording(path, two_samples(), "<robot name='r'/>");  // replaces the first
    Diagnostics diagnostics;
    const Recording read = read_recording(path, diagnostics);
    EXPECT_THAT(diagnostics.errors, ::testing::IsEmpty()) << name;
    ASSERT_EQ(read.samples.size(), 2u) << name;
    EXPECT_EQ(read.samples[1].joint_positions, two_samples()[1].joint_positions);
    EXPECT_EQ(read.samples[0].stamp, std::nullopt);
    EXPECT_EQ(read.samples[1].stamp, two_samples()[1].stamp);
    EXPECT_EQ(read.samples[0].observation("camera")->features[0].point,
              Vector3<double>(0.1, 0.2, 0.3));
    EXPECT_EQ(read.urdf, output_encoding(path) ? "<robot name='r'/>" : "");
  }
}

TEST(WriteRecording, KeepsIdsInEachFormatAndWritesNothingWithoutThem) {
  const test::TemporaryFolder folder;
  for (const char* name : {"samples.yaml", "samples.bag", "samples.mcap"}) {
    const std::string path = (folder.path() / name).string();
    std::vector<Sample> samples = two_samples();
    for (const int id : {12, 0, 1, 7}) {
      samples[1].observations[0].features.push_back({"optical", {0.5, 0, 1}, {}, {}, id});
    }
    write_recording(path, samples);
    Diagnostics diagnostics;
    const Recording read = read_recording(path, diagnostics);
    EXPECT_THAT(diagnostics.errors, ::testing::IsEmpty()) << name;
    ASSERT_EQ(read.samples.size(), 2u) << name;
    EXPECT_EQ(read.samples[0].observations[0].features[0].id, std::nullopt);
    std::vector<std::optional<int>> ids;
    for (const Feature& f : read.samples[1].observations[0].features) ids.push_back(f.id);
    EXPECT_THAT(ids, ::testing::ElementsAre(std::nullopt, 12, 0, 1, 7)) << name;
  }
}

TEST(WriteRecording, RefusesAnotherFormat) {
  EXPECT_THROW(write_recording("samples.txt", two_samples()), InputError);
  EXPECT_FALSE(std::filesystem::exists("samples.txt"));
}

}  // namespace
}  // namespace kinecal
