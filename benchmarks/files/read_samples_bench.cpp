// Reading samples.  Control: the YAML parser with a handler that ignores every event.
//
//   BM_read_samples/10000       as many threads as there are processors
//   BM_read_samples_one/10000   one thread
//   BM_yaml_control/10000       one thread, the parser alone
// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/samples/read_samples.hpp"
#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/files/yaml/yaml_events.ipp"

namespace kinecal {
namespace {

/// Samples of a mobile manipulator: 9 joints, a camera with its camera_info and the arm, 4 features
/// each.
std::vector<Sample> made_samples(std::int64_t count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> number(-1.5, 1.5);
  CameraInfo camera;
  camera.width = 640;
  camera.height = 480;
  camera.distortion_model = "plumb_bob";
  camera.d = {0.0, 0.0, 0.0, 0.0, 0.0};
  camera.k = {554.2546911911879, 0.0, 320.5, 0.0, 554.2546911911879, 240.5, 0.0, 0.0, 1.0};
  camera.r = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  camera.p = {camera.k[0], 0.0, 320.5, 0.0, 0.0, camera.k[4], 240.5, 0.0, 0.0, 0.0, 1.0, 0.0};
  std::vector<Sample> samples(static_cast<std::size_t>(count));
  for (Sample& sample : samples) {
    sample.joint_names = {"shoulder_pan_joint", "shoulder_lift_joint", "upperarm_roll_joint",
                          "elbow_flex_joint",   "forearm_roll_joint",  "wrist_flex_joint",
                          "wrist_roll_joint",   "head_pan_joint",      "head_tilt_joint"};
    for (std::size_t i = 0; i < 9; ++i) sample.joint_positions.push_back(number(random));
    Observation seen{"camera", {}, camera}, held{"arm", {}};
    for (int i = 0; i < 4; ++i) {
      seen.features.push_back(
          {"head_camera_rgb_optical_frame", {number(random), number(random), number(random)}});
      held.features.push_back({"wrist_roll_link", {0.1044, 0.0355, 0.01 * i}});
    }
    sample.observations = {seen, held};
  }
  return samples;
}

std::string written(const std::vector<Sample>& samples) {
  std::ostringstream out;
  write_samples(out, samples);
  return out.str();
}

/// A file of samples that exists as long as this object.
struct SampleText {
  explicit SampleText(std::int64_t count) : text(written(made_samples(count))) {
    std::ofstream(path, std::ios::binary) << text;
  }
  ~SampleText() { std::filesystem::remove(path); }
  SampleText(const SampleText&) = delete;
  SampleText& operator=(const SampleText&) = delete;

  std::string text;
  std::string path = (std::filesystem::temp_directory_path() / "read_samples_bench.yaml").string();
};

void count(benchmark::State& state, const SampleText& file) {
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(file.text.size()));
}

void read(benchmark::State& state, unsigned threads) {
  const SampleText file(state.range(0));
  Diagnostics once;
  const std::vector<Sample> samples = read_samples(file.path, once, threads);
  if (!once.errors.empty() || !once.warnings.empty() || written(samples) != file.text) {
    state.SkipWithError("what is read is not what was written");
    return;
  }
  for (auto _ : state) {
    Diagnostics diagnostics;
    benchmark::DoNotOptimize(read_samples(file.path, diagnostics, threads));
  }
  count(state, file);
}

void BM_read_samples(benchmark::State& state) {
  read(state, 0);
}
void BM_read_samples_one(benchmark::State& state) {
  read(state, 1);
}

/// Ignores every event.
struct Ignore {
  std::size_t documents = 0;
  void document_starts() { ++documents; }
  void null(int) {}
  void scalar(int, std::string_view) {}
  void alias(int) {}
  void list_starts(int) {}
  void map_starts(int) {}
  void ends() {}
};

void BM_yaml_control(benchmark::State& state) {
  const SampleText file(state.range(0));
  for (auto _ : state) {
    detail::YamlEvents events(file.text);
    Ignore handler;
    while (events.next_document(handler)) {
    }
    benchmark::DoNotOptimize(handler.documents);
    if (handler.documents != static_cast<std::size_t>(state.range(0)) + 1) {
      state.SkipWithError("a document is missing");  // the one after the last `---` is empty
      break;
    }
  }
  count(state, file);
}

void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->Arg(100)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond)->UseRealTime();
}
BENCHMARK(BM_read_samples)->Apply(sizes);
BENCHMARK(BM_read_samples_one)->Apply(sizes);
BENCHMARK(BM_yaml_control)->Apply(sizes);

}  // namespace
}  // namespace kinecal

BENCHMARK_MAIN();
