// Mistakes in recordings: each changes a recording in one way.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "support/real_recordings.hpp"

namespace kinecal::test {

inline constexpr double kOneDegree = std::numbers::pi / 180.0;

using Change = std::function<void(Recording&)>;

inline Change points(const std::function<void(Vector3<double>& p, double part)>& change) {
  return [=](Recording& of) {
    const double last = static_cast<double>(of.samples.size() - 1);
    for (std::size_t s = 0; s < of.samples.size(); ++s) {
      for (Observation& seen : of.samples[s].observations) {
        if (seen.sensor != of.sensor) continue;
        for (Feature& feature : seen.features) change(feature.point, static_cast<double>(s) / last);
      }
    }
  };
}

/// @param error  added to the position of one joint, by its position and the one before
inline Change joint(std::size_t number,
                    const std::function<double(double q, double before, double part)>& error) {
  return [=](Recording& of) {
    const std::vector<Sample> true_ones = of.samples;
    const double last = static_cast<double>(of.samples.size() - 1);
    for (std::size_t s = 0; s < of.samples.size(); ++s) {
      const double q = true_ones[s].joint_positions[number];
      const double before = true_ones[s == 0 ? 0 : s - 1].joint_positions[number];
      of.samples[s].joint_positions[number] += error(q, before, static_cast<double>(s) / last);
    }
  };
}

inline Change all_joints(const std::function<double(double q, double before, double part)>& error) {
  return [=](Recording& of) {
    const std::size_t joints = of.samples[0].joint_positions.size();
    for (std::size_t j = 0; j < joints; ++j) joint(j, error)(of);
  };
}

inline Change gear(std::size_t j, double factor) {
  return joint(j, [=](double q, double, double) { return (factor - 1.0) * q; });
}
inline Change backlash(std::size_t j, double degrees) {
  return joint(j, [=](double q, double before, double) {
    return 0.5 * degrees * kOneDegree * (q > before ? 1.0 : -1.0);
  });
}
inline Change eccentric(std::size_t j, double degrees) {
  return joint(j,
               [=](double q, double, double) { return degrees * kOneDegree * std::sin(q + 0.7); });
}
inline Change slip(std::size_t j, double degrees, double from) {
  return joint(
      j, [=](double, double, double part) { return part < from ? 0.0 : degrees * kOneDegree; });
}
inline Change sag(double degrees) {
  return joint(1, [=](double q, double, double) { return degrees * kOneDegree * std::cos(q); });
}
inline Change rounded(double degrees) {
  return all_joints([=](double q, double, double) {
    const double step = degrees * kOneDegree;
    return std::round(q / step) * step - q;
  });
}
inline Change lag(double share) {
  return all_joints([=](double q, double before, double) { return share * (before - q); });
}
inline Change scaled(double factor) {
  return points([=](Vector3<double>& p, double) { p *= factor; });
}
inline Change axis_scaled(int axis, double factor) {
  return points([=](Vector3<double>& p, double) { p(axis) *= factor; });
}
inline Change drift(double metres) {
  return points([=](Vector3<double>& p, double part) { p.x() += metres * part; });
}
inline Change bump(double metres, double from) {
  return points([=](Vector3<double>& p, double part) { p.y() += part < from ? 0.0 : metres; });
}
inline Change noise(int axis, double metres) {
  return [=](Recording& of) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0.0, metres);
    points([&](Vector3<double>& p, double) { p(axis) += normal(random); })(of);
  };
}
inline Change ruined(double share, double metres) {
  return [=](Recording& of) {
    std::mt19937 random(9);
    std::normal_distribution<double> normal;
    std::vector<std::size_t> order(of.samples.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), random);
    order.resize(static_cast<std::size_t>(share * static_cast<double>(order.size())));
    for (const std::size_t s : order) {
      const Vector3<double> way{normal(random), normal(random), normal(random)};
      for (Observation& seen : of.samples[s].observations) {
        if (seen.sensor != of.sensor) continue;
        for (Feature& feature : seen.features) feature.point += metres * way.normalized();
      }
    }
  };
}
inline Change read_again(std::size_t times) {
  return [=](Recording& of) {
    std::mt19937 random(2);
    std::normal_distribution<double> normal(0.0, 1e-5);
    std::vector<Sample> all;
    for (std::size_t s = 0; s < std::min<std::size_t>(20, of.samples.size()); ++s) {
      for (std::size_t i = 0; i < times; ++i) {
        all.push_back(of.samples[s]);
        for (double& q : all.back().joint_positions) q += normal(random);
      }
    }
    of.samples = all;
  };
}
/// Makes the longest coordinate of the origin of a moving joint longer.
inline Change link(int number, double metres) {
  return [=](Recording& of) {
    int seen = 0;
    for (std::size_t at = of.urdf.find("<joint"); at != std::string::npos;
         at = of.urdf.find("<joint", at + 1)) {
      const std::size_t end = of.urdf.find("</joint>", at);
      const std::string type = of.urdf.substr(at, of.urdf.find('>', at) - at);
      if (type.find("revolute") == std::string::npos &&
          type.find("continuous") == std::string::npos) {
        continue;
      }
      if (++seen != number) continue;
      const std::size_t first = of.urdf.find("xyz=\"", of.urdf.find("<origin", at)) + 5;
      if (first > end) return;
      const std::size_t last = of.urdf.find('"', first);
      std::istringstream numbers(of.urdf.substr(first, last - first));
      Vector3<double> xyz = Vector3<double>::Zero();
      numbers >> xyz.x() >> xyz.y() >> xyz.z();
      Eigen::Index longest = 0;
      (void)xyz.cwiseAbs().maxCoeff(&longest);
      xyz(longest) += metres;
      std::ostringstream text;
      text.precision(12);
      text << xyz.x() << ' ' << xyz.y() << ' ' << xyz.z();
      of.urdf.replace(first, last - first, text.str());
      return;
    }
  };
}

struct Mutation {
  const char* name;
  Change change;
  bool is_of_robot = false;  ///< the robot has it whenever it moves, not only in these samples
};

inline std::vector<Mutation> mutations() {
  return {
      {"points_10_percent_larger", scaled(1.1)},
      {"points_2_percent_larger", scaled(1.02)},
      {"points_5_percent_smaller", scaled(0.95)},
      {"drift_of_10_mm", drift(0.01)},
      {"drift_of_3_mm", drift(0.003)},
      {"x_2_percent_longer", axis_scaled(0, 1.02)},
      {"y_5_percent_longer", axis_scaled(1, 1.05)},
      {"noise_of_3_mm_in_x", noise(0, 0.003)},
      {"noise_of_5_mm_in_z", noise(2, 0.005)},
      {"gear_of_joint_2", gear(1, 1.02)},
      {"gear_of_joint_3", gear(2, 1.02)},
      {"gear_of_joint_4", gear(3, 1.01)},
      {"gear_of_joint_5", gear(4, 1.03)},
      {"backlash_of_joint_1", backlash(0, 1.0)},
      {"backlash_of_joint_2", backlash(1, 1.0)},
      {"backlash_of_joint_3", backlash(2, 0.3)},
      {"backlash_of_joint_4", backlash(3, 1.0)},
      {"eccentric_joint_2", eccentric(1, 0.5), true},
      {"eccentric_joint_4", eccentric(3, 0.5), true},
      {"joint_2_slipped", slip(1, 0.5, 0.5)},
      {"joint_5_slipped", slip(4, 1.0, 0.6)},
      {"bump_of_3_mm", bump(0.003, 0.5)},
      {"bump_of_8_mm", bump(0.008, 0.7)},
      {"a_tenth_ruined", ruined(0.1, 0.005)},
      {"a_fifth_ruined", ruined(0.2, 0.003)},
      {"three_tenths_ruined", ruined(0.3, 0.01)},
      {"read_three_times", read_again(3)},
      {"read_five_times", read_again(5)},
      {"joints_rounded_to_a_degree", rounded(1.0)},
      {"joints_rounded_to_a_third", rounded(0.3)},
      {"joints_5_percent_late", lag(0.05)},
      {"joints_1_percent_late", lag(0.01)},
      {"sag_of_half_a_degree", sag(0.5), true},
      {"sag_of_0_3_degrees", sag(0.3), true},
      {"link_2_a_centimetre_longer", link(2, 0.01)},
      {"link_3_a_centimetre_longer", link(3, 0.01)},
      {"link_4_a_centimetre_longer", link(4, 0.01)},
      {"link_5_a_centimetre_longer", link(5, 0.01)},
  };
}

}  // namespace kinecal::test
