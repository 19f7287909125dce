// Reading samples from bags with point clouds.  Control: reading the same bytes without parsing.
//
//   read_bag_bench [MEGABYTES]     of the bag, 1000 by default
//
// Prints seconds, MB/s and the largest memory of the process.  The bags are written to the folder
// for temporary files and removed afterwards: a cloud of 100 kB per sample, chunks not compressed.
// SPDX-License-Identifier: Apache-2.0
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "kinecal/files/recordings/bag_output.hpp"
#include "kinecal/files/recordings/read_recording.hpp"
#include "kinecal/files/recordings/sample_message.ipp"

namespace kinecal {
namespace {

constexpr std::size_t kCloud = 100'000;  // bytes

Sample made_sample(int n) {
  Sample sample;
  for (int j = 0; j < 15; ++j) {
    sample.joint_names.push_back("joint_" + std::to_string(j));
    sample.joint_positions.push_back(0.1 * j + 1e-3 * (n % 100));
  }
  CameraInfo camera;
  camera.width = 640;
  camera.height = 480;
  camera.k = {554.25, 0, 320.5, 0, 554.25, 240.5, 0, 0, 1};
  camera.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  camera.p = {554.25, 0, 320.5, 0, 0, 554.25, 240.5, 0, 0, 0, 1, 0};
  sample.observations = {{"camera", {}, camera}, {"arm", {}, {}}};
  for (Observation& seen : sample.observations) {
    for (int i = 0; i < 4; ++i) seen.features.push_back({"frame", {0.1 * i, 0.2, 1.0 + 1e-3 * n}});
  }
  return sample;
}

MessageFields with_cloud(MessageFields message, Bytes cloud) {
  for (auto& [name, value] : message.fields) {
    if (name != "observations") continue;
    auto& seen = std::get<MessageValue::List>(static_cast<MessageValue::variant&>(value));
    auto& first = std::get<MessageFields>(static_cast<MessageValue::variant&>(seen.front()));
    first.fields.emplace_back("cloud", detail::fields("height", std::int64_t{1}, "point_step",
                                                      std::int64_t{32}, "data", cloud));
  }
  return message;
}

void write_bag(const std::string& path, Encoding encoding, int samples) {
  const BagTopic topic{"calibration_data", "robot_calibration_msgs/CalibrationData"};
  const std::vector<std::byte> cloud(kCloud, std::byte{42});
  BagOutput bag(path, encoding, Compression::none);
  for (int n = 0; n < samples; ++n) {
    const Sample sample = made_sample(n);
    std::deque<std::string> texts;
    bag.write(topic, n + 1, with_cloud(detail::sample_message(sample, texts), cloud));
  }
  bag.finish();
}

double seconds_of(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Largest memory of this process so far, megabytes.
double most_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1e-3 * static_cast<double>(usage.ru_maxrss);
}

void only_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<char> piece(1 << 20);
  while (file.read(piece.data(), static_cast<std::streamsize>(piece.size()))) {
  }
}

void measure(const char* name, const std::string& path, Encoding encoding, int samples) {
  write_bag(path, encoding, samples);
  const double size = 1e-6 * static_cast<double>(std::filesystem::file_size(path));
  const double bytes = seconds_of([&] { only_bytes(path); });
  Diagnostics diagnostics;
  std::size_t found = 0;
  const double read = seconds_of([&] { found = read_recording(path, diagnostics).samples.size(); });
  std::filesystem::remove(path);
  if (found != static_cast<std::size_t>(samples) || !diagnostics.errors.empty()) {
    std::fprintf(stderr, "error: %zu samples of %d\n", found, samples);
    std::exit(1);
  }
  std::printf(
      "%-10s %8.0f MB %6d samples  %6.2f s %7.0f MB/s   bytes alone %6.0f MB/s   %5.0f MB\n", name,
      size, samples, read, size / read, size / bytes, most_memory());
}

}  // namespace
}  // namespace kinecal

int main(int argc, char** argv) {
  const int megabytes = argc > 1 ? std::atoi(argv[1]) : 1000;
  if (megabytes < 1) {
    std::fprintf(stderr, "usage: read_bag_bench [MEGABYTES]\n");
    return 1;
  }
  const int samples = megabytes * 10;
  const auto path =
      std::filesystem::temp_directory_path() / ("read_bag_bench_" + std::to_string(getpid()));
  kinecal::measure("ROS 1 bag", path, kinecal::Encoding::ros1, samples);
  kinecal::measure("MCAP", path, kinecal::Encoding::cdr, samples);
}
