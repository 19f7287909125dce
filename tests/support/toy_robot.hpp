// A robot of two joints and a camera, as simple as the concepts allow, and with the faults that a
// session must survive.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "kinecal/capture/robot_interface.hpp"

namespace kinecal::test {

using std::chrono::milliseconds;

/// Joints turn at 1 rad/s from 100 ms after the command, and are measured every 10 ms with noise.
class ToyArm {
 public:
  std::string stuck = {};                               ///< joint that does not arrive
  std::string creeping = {};                            ///< joint that never stops
  double noise = 2e-4;                                  ///< of its encoders, radians
  int readings_left = std::numeric_limits<int>::max();  ///< until the stream stops
  int moves_left = std::numeric_limits<int>::max();     ///< until the robot is gone
  Stamp now = std::chrono::seconds(1000);               ///< of the robot's clock

  void move(const JointTarget& target) {
    if (--moves_left < 0) throw ConnectionError("the robot is gone");
    for (std::size_t i = 0; i < target.names.size(); ++i) {
      const auto found = std::find(names_.begin(), names_.end(), target.names[i]);
      if (found == names_.end()) throw PoseError("no joint '" + target.names[i] + "'");
      const auto joint = static_cast<std::size_t>(found - names_.begin());
      target_[joint] = target.names[i] == stuck ? 0.25 * target.positions[i] : target.positions[i];
    }
    start_ = now + milliseconds(100);
  }

  MeasuredJoints next_joints(Stamp after) {
    if (--readings_left < 0) throw SilenceError("no joint states since 1000 s", "joints", now);
    do advance();
    while (now <= after);
    std::normal_distribution<double> normal(0.0, noise);
    MeasuredJoints joints{now, names_, position_};
    for (double& position : joints.positions) position += normal(random_);
    return joints;
  }

  /// True position of a joint, radians.
  [[nodiscard]] double position(std::size_t joint) const { return position_[joint]; }

  void advance() {
    now += milliseconds(10);
    for (std::size_t i = 0; i < position_.size(); ++i) {
      if (names_[i] == creeping) position_[i] += 1e-3;
      if (now < start_ || names_[i] == creeping) continue;
      position_[i] += std::clamp(target_[i] - position_[i], -0.01, 0.01);
    }
  }

 private:
  std::vector<std::string> names_ = {"pan", "tilt"};
  std::vector<double> position_ = {0.0, 0.0}, target_ = {0.0, 0.0};
  Stamp start_{};
  std::mt19937_64 random_{1};
};

/// A bright square that moves with the first joint; a picture every 50 ms.
class ToyCamera {
 public:
  ToyArm& arm;
  Stamp ahead{};          ///< of its clock against the joints'
  bool flickers = false;  ///< something moves in front of it
  int pictures = 0;       ///< so far
  int size = 64;          ///< of the image, pixels

  View next_view(Stamp after) {
    do {
      for (int i = 0; i < 5; ++i) arm.advance();
    } while (arm.now + ahead <= after);
    View view;
    view.stamp = arm.now + ahead;
    view.frame = "camera";
    view.image = GrayImage(size, size, 30);
    ++pictures;
    const int left = 20 + static_cast<int>(std::lround(20.0 * arm.position(0)));
    for (int v = 20; v < 40; ++v) {
      for (int u = left; u < left + 20; ++u) {
        if (view.image.contains(u, v)) view.image(u, v) = 200;
        if (flickers) view.image((u + 7 * pictures) % size, v) = 90;
      }
    }
    return view;
  }
};

/// Finds the left edge of the square, if it is there.
struct ToyFinder {
  std::string camera = "camera", chain = "arm";

  [[nodiscard]] Found find(const View& view) const {
    for (int u = 1; u < view.image.width; ++u) {
      if (view.image(u - 1, 30) != 30 || view.image(u, 30) != 200) continue;
      const Feature seen{view.frame, {1.0 * u, 30.0, 0.0}};
      return {{{camera, {seen}}, {chain, {{"tool", {0.0, 0.0, 0.0}}}}}, {}, {{1.0 * u, 30.0}}};
    }
    return refused("no square in the image");
  }
};

static_assert(RobotArm<ToyArm> && RobotCamera<ToyCamera> && Finder<ToyFinder>);

}  // namespace kinecal::test
