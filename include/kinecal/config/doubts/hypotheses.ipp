// Possible mistakes in samples or configurations, and how to undo each.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// A possible mistake.
struct Hypothesis {
  std::string undone;  ///< "with the positions of 'a' and 'b' exchanged"
  std::function<void(Sample&)> correct = {};
  std::function<void(std::vector<Sample>&)> correct_all = {};  ///< where samples depend on others
  std::function<void(Config&)> correct_config = {};
  double shrinks = 1.0;  ///< factor on lengths, and so on residuals
};

/// The position of a joint in a sample; nullptr if it has none.
[[nodiscard]] inline double* position_in(Sample& sample, const std::string& joint) {
  const auto at = std::find(sample.joint_names.begin(), sample.joint_names.end(), joint);
  const auto index = static_cast<std::size_t>(at - sample.joint_names.begin());
  return index < sample.joint_positions.size() ? &sample.joint_positions[index] : nullptr;
}

inline void add_joint_hypotheses(const std::vector<UsedJoint>& joints,
                                 std::vector<Hypothesis>& all) {
  for (std::size_t a = 0; a < joints.size(); ++a) {
    const std::string& first = joints[a].joint.name;
    all.push_back({fmt::format("with the positions of '{}' negated", first), [first](Sample& s) {
                     if (double* q = position_in(s, first)) *q = -*q;
                   }});
    for (std::size_t b = a + 1; b < joints.size(); ++b) {
      const std::string& second = joints[b].joint.name;
      all.push_back({fmt::format("with the positions of '{}' and '{}' exchanged", first, second),
                     [first, second](Sample& s) {
                       double *q = position_in(s, first), *r = position_in(s, second);
                       if (q != nullptr && r != nullptr) std::swap(*q, *r);
                     }});
    }
  }
}

/// Positions in the robot's order under names in another order, or vice versa.
inline void add_order_hypotheses(const std::vector<UsedJoint>& joints,
                                 std::vector<Hypothesis>& all) {
  std::vector<std::string> names, sorted, reversed;
  for (const UsedJoint& joint : joints) names.push_back(joint.joint.name);
  sorted = names;
  std::sort(sorted.begin(), sorted.end());
  reversed.assign(names.rbegin(), names.rend());
  const auto add = [&](const std::string& undone, std::vector<std::string> from,
                       std::vector<std::string> to) {
    if (from == to) return;
    all.push_back({undone, [from = std::move(from), to = std::move(to)](Sample& s) {
                     const Sample before = s;
                     for (std::size_t i = 0; i < from.size(); ++i) {
                       double* q = position_in(s, to[i]);
                       if (const auto value = before.position(from[i]); q != nullptr && value) {
                         *q = *value;
                       }
                     }
                   }});
  };
  add("with positions taken in alphabetical order of the joints", names, sorted);
  add("with positions taken in the order of the chain, names being alphabetical", sorted, names);
  add("with the positions of all joints in reverse order", names, reversed);
  constexpr double kDegrees = std::numbers::pi / 180.0;
  for (const double factor : {kDegrees, 1.0 / kDegrees}) {
    std::vector<std::string> turning;
    for (const UsedJoint& joint : joints) {
      if (turns(joint.joint.type)) turning.push_back(joint.joint.name);
    }
    all.push_back({factor < 1.0 ? "with joint positions taken as degrees"
                                : "with joint positions converted from radians to degrees",
                   [factor, turning](Sample& s) {
                     for (const std::string& name : turning) {
                       if (double* q = position_in(s, name)) *q *= factor;
                     }
                   }});
  }
}

inline void add_sensor_hypotheses(const Config& config, std::vector<Hypothesis>& all) {
  const std::set<std::string> pixels = pixel_models(config);
  for (const ModelConfig& model : models_of(config)) {
    const std::string name = model.name;
    const auto each = [name](Sample& s, auto&& change) {
      for (Observation& seen : s.observations) {
        if (seen.sensor == name) change(seen);
      }
    };
    all.push_back({fmt::format("with the features of '{}' in reverse order", name), [=](Sample& s) {
                     each(s, [](Observation& seen) {
                       std::vector<Feature>& features = seen.features;
                       std::reverse(features.begin(), features.end());
                       for (std::size_t i = 0; i < features.size() / 2; ++i) {  // ids stay
                         std::swap(features[i].id, features[features.size() - 1 - i].id);
                       }
                     });
                   }});
    if (pixels.contains(name)) continue;
    const auto points = [each](auto&& change) {
      return [=](Sample& s) {
        each(s, [=](Observation& seen) {
          for (Feature& feature : seen.features) feature.point = change(feature.point);
        });
      };
    };
    using Point = Vector3<double>;
    const std::string of = fmt::format("with the points of '{}' ", name);
    all.push_back({of + "taken as millimetres",
                   points([](const Point& p) -> Point { return 1e-3 * p; }),
                   {},
                   {},
                   1e-3});
    all.push_back(
        {of + "multiplied by 1000", points([](const Point& p) -> Point { return 1e3 * p; })});
    all.push_back({of + "mirrored, as if its axes were left-handed",
                   points([](const Point& p) { return Point(p.x(), -p.y(), p.z()); })});
    all.push_back(
        {of + "turned from the axes of a link (x forward) to those of a camera (z forward)",
         points([](const Point& p) { return Point(-p.y(), -p.z(), p.x()); })});
  }
}

/// Frames of two models, or their names in the samples, exchanged.
inline void add_model_hypotheses(const Config& config, std::vector<Hypothesis>& all) {
  const std::vector<ModelConfig> models = models_of(config);
  for (std::size_t a = 0; a < models.size(); ++a) {
    for (std::size_t b = a + 1; b < models.size(); ++b) {
      const ModelConfig &first = models[a], &second = models[b];
      if (first.frame != second.frame) {
        all.push_back({fmt::format("with the frames of the models '{}' and '{}' exchanged",
                                   first.name, second.name),
                       {},
                       {},
                       [first, second](Config& changed) {
                         for (StepConfig& step : changed.steps) {
                           for (ModelConfig& model : step.models) {
                             if (model.name == first.name) {
                               model.frame = second.frame;
                             } else if (model.name == second.name) {
                               model.frame = first.frame;
                             }
                           }
                         }
                       }});
      }
      all.push_back(
          {fmt::format("with the observations of '{}' and '{}' exchanged", first.name, second.name),
           [first, second](Sample& s) {
             for (Observation& seen : s.observations) {
               if (seen.sensor == first.name) {
                 seen.sensor = second.name;
               } else if (seen.sensor == second.name) {
                 seen.sensor = first.name;
               }
             }
           }});
    }
  }
}

[[nodiscard]] inline std::vector<Hypothesis> hypotheses(const Config& config,
                                                        const std::vector<UsedJoint>& joints) {
  std::vector<Hypothesis> all;
  add_joint_hypotheses(joints, all);
  add_order_hypotheses(joints, all);
  add_sensor_hypotheses(config, all);
  add_model_hypotheses(config, all);
  return all;
}

}  // namespace kinecal::detail
