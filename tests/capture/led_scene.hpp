// A camera that sees four LEDs on a gripper, and the lamp that switches them, for tests.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "kinecal/capture/finders/find_leds.hpp"

namespace kinecal {

constexpr double kFocal = 525.0;

inline CameraInfo vga_camera() {
  CameraInfo camera;
  camera.width = 640;
  camera.height = 480;
  camera.p = {kFocal, 0, 319.5, 0, 0, kFocal, 239.5, 0, 0, 0, 1, 0};
  return camera;
}

/// LEDs where Fetch has them, on a plate in front of a wall; the LEDs' frame is 0.8 m in front of the
/// camera, its z towards the camera.
struct LedScene {
  double sigma = 3.0;         ///< noise, grey levels
  double spot_sigma = 1.5;    ///< size of a light, pixels
  double brightness = 120.0;  ///< of a light
  double light_drift = 0.0;   ///< grey levels per second
  double latency = 0.0;       ///< seconds by which views lag behind their stamps
  double hole = 4.0;          ///< radius without depth around an LED, pixels
  double depth_sigma = 0.001;
  double sway = 0.0;    ///< of the gripper, pixels per view
  double walker = 0.0;  ///< a bright thing that moves through the image, pixels per view
  std::vector<bool> works = std::vector<bool>(4, true);
  std::vector<Vector3<double>> lights;        ///< extra lights of all LEDs (u, v, share)
  Vector3<double> gripper{0.03, -0.02, 0.8};  ///< (3) metres, in the optical frame
  Stamp period = std::chrono::milliseconds(33);

  LedFinder finder() const {
    LedFinder f;
    f.frame = "gripper";
    f.threshold = 500.0;
    f.max_iterations = 25;
    f.leds = {{1, "led1", {0.1044, 0.0355, 0.0396}},
              {2, "led2", {0.0514, 0.0355, 0.0396}},
              {4, "led3", {0.0514, -0.0355, 0.0396}},
              {8, "led4", {0.1044, -0.0355, 0.0396}}};
    return f;
  }

  Pose<double> camera_T_gripper() const {
    Pose<double> pose;
    pose.rotation << 1, 0, 0, 0, -1, 0, 0, 0, -1;
    pose.translation = gripper;
    return pose;
  }

  Vector3<double> led_in_camera(std::size_t i) const {
    return camera_T_gripper() * finder().leds[i].position;
  }

  Vector3<double> pixel(std::size_t i) const {
    const Vector3<double> p = led_in_camera(i);
    return {kFocal * p.x() / p.z() + 319.5, kFocal * p.y() / p.z() + 239.5, 0.0};
  }

  // The camera and the lamp.
  View next_view(Stamp after) {
    now = std::max(now, after) + period;
    ++views;
    View view{now, "optical", vga_camera(), image(), cloud(), {}};
    if (edit) edit(view);
    return view;
  }
  Stamp light(int new_code) {
    now += std::chrono::milliseconds(5);
    history.push_back({now, new_code});
    return now;
  }

  GrayImage image() {
    GrayImage out(640, 480);
    const double t = std::chrono::duration<double>(now - kStart).count();
    const int shift = static_cast<int>(sway * views);
    const double at = std::fmod(80.0 + walker * views, 560.0);
    for (int v = 0; v < 480; ++v) {
      for (int u = 0; u < 640; ++u) {
        const int checks = ((u - shift + 1000) / 16 + v / 16) % 2;
        double level = 50.0 + 30.0 * checks + light_drift * t;
        if (walker > 0.0 && std::hypot(u - at, v - 120.0) < 15.0) level += 120.0;
        out(u, v) = grey(level);
      }
    }
    const int lit = code();
    for (std::size_t i = 0; i < 4; ++i) {
      if ((lit & finder().leds[i].code) == 0 || !works[i]) continue;
      add_light(out, pixel(i).x() + shift, pixel(i).y(), brightness);
      for (const auto& extra : lights) add_light(out, extra.x(), extra.y(), brightness * extra.z());
    }
    return out;
  }

  /// Some noise of mean 0 and standard deviation 1.
  double noise() { return noises[random() % noises.size()]; }

  PointCloud cloud() {
    DepthImage depth(640, 480, 2.0F);
    const double z = led_in_camera(0).z();
    for (int v = 150; v < 330; ++v) {
      for (int u = 250; u < 480; ++u) depth(u, v) = static_cast<float>(z + depth_sigma * noise());
    }
    for (std::size_t i = 0; i < 4; ++i) {
      const Vector3<double> at = pixel(i);
      for (int v = 150; v < 330; ++v) {
        for (int u = 250; u < 480; ++u) {
          if (std::hypot(u - at.x(), v - at.y()) < hole) depth(u, v) = 0.0F;
        }
      }
    }
    return points_of(depth, vga_camera());
  }

  /// What the lamp showed at the time of the exposure.
  int code() const {
    const Stamp seen =
        now - std::chrono::duration_cast<Stamp>(std::chrono::duration<double>(latency));
    int shown = 0;
    for (const auto& [stamp, value] : history) {
      if (stamp <= seen) shown = value;
    }
    return shown;
  }

  void add_light(GrayImage& out, double at_u, double at_v, double level) {
    const int reach = 6 + static_cast<int>(4 * spot_sigma);
    for (int v = static_cast<int>(at_v) - reach; v <= at_v + reach; ++v) {
      for (int u = static_cast<int>(at_u) - reach; u <= at_u + reach; ++u) {
        if (!out.contains(u, v)) continue;
        const double d = std::hypot(u - at_u, v - at_v) / spot_sigma;
        const double sum = out(u, v) + level * std::exp(-0.5 * d * d);
        out(u, v) = static_cast<std::uint8_t>(std::clamp(sum + 0.5, 0.0, 255.0));
      }
    }
  }

  std::uint8_t grey(double level) {
    return static_cast<std::uint8_t>(std::clamp(level + sigma * noise() + 0.5, 0.0, 255.0));
  }

  struct Switch {
    Stamp stamp;
    int code;
  };
  std::vector<Switch> history;
  static constexpr Stamp kStart = std::chrono::seconds(100);
  Stamp now = kStart;
  int views = 0;
  std::function<void(View&)> edit;  ///< what is wrong with views
  std::mt19937 random{7};
  std::vector<double> noises = some_noises();

  static std::vector<double> some_noises() {
    std::mt19937 engine(3);
    std::normal_distribution<double> normal;
    std::vector<double> all(1 << 16);
    for (double& one : all) one = normal(engine);
    return all;
  }
};
static_assert(RobotCamera<LedScene> && RobotLamp<LedScene>);

}  // namespace kinecal
