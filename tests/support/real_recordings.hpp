// Recordings of real robots: those of the data, and a KUKA of the cases beside it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "support/calibrated.hpp"
#include "support/data.hpp"

namespace kinecal::test {

/// A robot, its recording, and other samples of it that are right.
struct Recording {
  std::string name, sensor;
  std::string urdf;
  Config config;
  std::vector<Sample> samples, right;
  std::string config_text = {};
};

inline Recording read_recording(const char* name, const std::filesystem::path& urdf,
                                const std::filesystem::path& config,
                                const std::filesystem::path& samples, const char* sensor) {
  Diagnostics diagnostics;
  Recording of{name, sensor, text_of(urdf), read_config(config.string(), diagnostics), {}, {}};
  const std::vector<Sample> all = read_samples(samples.string(), diagnostics);
  diagnostics.throw_if_errors();
  of.config_text = text_of(config);
  const bool many = all.size() > 500;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (many ? i >= 260 : false) break;
    (many ? i >= 60 : i % 3 == 0) ? of.right.push_back(all[many ? (i * 389) % all.size() : i])
                                  : of.samples.push_back(all[many ? (i * 389) % all.size() : i]);
  }
  return of;
}

/// A recording as a calibration takes it.
inline CalibrationSetup setup_of(const Recording& of) {
  return {.robot = parse_urdf(of.urdf, "robot.urdf"),
          .config = of.config,
          .samples = of.samples,
          .urdf_text = of.urdf,
          .urdf = "robot.urdf"};
}

inline Recording recording(const std::string& name) {
  const std::filesystem::path ur5 = data_folder() / "ur5_tracker",
                              panda = data_folder() / "mukca_panda";
  const std::filesystem::path cases = data_folder().parent_path() / "cases";
  if (name == "ur5")
    return read_recording("ur5", ur5 / "ur5.urdf", ur5 / "full.yaml", ur5 / "grid.yaml", "tracker");
  if (name == "ur5_offsets") {
    return read_recording("ur5_offsets", ur5 / "ur5.urdf", ur5 / "offsets.yaml", ur5 / "grid.yaml",
                          "tracker");
  }
  if (name == "panda") {
    return read_recording("panda", panda / "panda.urdf", panda / "panda_6/minimal.yaml",
                          panda / "panda_6/front.yaml", "fixture");
  }
  Recording kuka =
      read_recording("kuka", cases / "trust-01-scale-10-percent-good/robot_kuka.urdf",
                     cases / "trust-01-scale-10-percent-good/config_kuka.yaml",
                     cases / "trust-01-scale-10-percent-good/samples_kuka.yaml", "fixture");
  for (std::vector<Sample>* samples : {&kuka.samples, &kuka.right}) {
    for (Sample& sample : *samples) {  // its sockets are 50 mm apart, not 55
      for (Observation& seen : sample.observations) {
        for (Feature& feature : seen.features) feature.point *= 50.0 / 55.0;
      }
    }
  }
  return kuka;
}

}  // namespace kinecal::test

/// Skips the test and says why if a recording is absent.
#define KINECAL_NEEDS_RECORDING(name)                                                   \
  KINECAL_NEEDS_DATA("ur5_tracker");                                                    \
  KINECAL_NEEDS_DATA("mukca_panda");                                                    \
  if (std::string(name) == "kuka" &&                                                    \
      !std::filesystem::exists(kinecal::test::data_folder().parent_path() / "cases")) { \
    GTEST_SKIP() << "the cases are not beside " << kinecal::test::data_folder();        \
  }
