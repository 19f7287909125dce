// A whole calibration from texts in memory, as a service or another language would ask for it: URDF, configuration and
// samples in; verdict, reasons, parameters with +-, what to do next and the calibrated URDF out.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "kinecal/config/read_config.hpp"
#include "kinecal/files/samples/read_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/procedure.hpp"
#include "kinecal/report/next_step.hpp"

namespace {

std::string text_of(const char* file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Prints what a calibration found.
/// @returns  the calibrated URDF; empty if the result should not be used
std::string calibrated_robot(const std::string& urdf, const std::string& config,
                             const std::string& samples) {
  using namespace kinecal;
  Diagnostics found;
  CalibrationSetup setup{.robot = parse_urdf(urdf, "robot.urdf"),
                         .config = parse_config(config, "calibrate.yaml", found),
                         .samples = parse_samples(samples, "samples.yaml", found),
                         .urdf_text = urdf,
                         .urdf = "robot.urdf"};
  found.throw_if_errors();
  const CalibratedRobot calibrated = calibrate_robot(std::move(setup));

  const Findings& findings = calibrated;
  std::printf("verdict: %s\n", to_string(findings.judgement.verdict).data());
  for (const std::string& reason : findings.judgement.reasons)
    std::printf("  %s\n", reason.c_str());
  for (const LeftOutSample& sample : findings.left_out) {
    std::printf("sample %d is left out: %s\n", sample.number, sample.why.c_str());
  }
  for (const int i : findings.result.calibrated) {
    const Parameter& parameter = findings.result.table[i];
    std::printf("%-32s %+.5f +- %.5f %s\n", parameter.name.c_str(), parameter.value,
                findings.deviation(i).value_or(HUGE_VAL), parameter.unit.c_str());
  }
  std::printf("next: %s\n", next_step(findings).c_str());
  return calibrated.is_usable() ? calibrated_urdf(calibrated) : "";
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 4) return std::fprintf(stderr, "usage: %s URDF CONFIG SAMPLES\n", argv[0]), 1;
  const std::string urdf = calibrated_robot(text_of(argv[1]), text_of(argv[2]), text_of(argv[3]));
  std::printf("the calibrated URDF has %zu bytes\n", urdf.size());
  return urdf.empty() ? 2 : 0;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "error: %s\n", error.what()), 1;
}
