// Definitions of suspect.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/explain/suspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <span>

#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/explain/drive_suspects.ipp"
#include "kinecal/explain/pose_suspects.ipp"
#include "kinecal/kinematics/chain.hpp"

namespace kinecal {

namespace detail {
namespace {

using Suspects = std::vector<Suspect>;

/// The other sign of each joint; two joints exchanged.
void add_names(const std::vector<UsedJoint>& joints, Suspects& all) {
  for (std::size_t a = 0; a < joints.size(); ++a) {
    const std::string& first = joints[a].joint.name;
    all.push_back({.undone = fmt::format("with the positions of '{}' negated", first),
                   .correct =
                       [first](Sample& s) {
                         if (double* q = position_in(s, first)) *q = -*q;
                       },
                   .sign_of = first});
    for (std::size_t b = a + 1; b < joints.size(); ++b) {
      const std::string& second = joints[b].joint.name;
      all.push_back(
          {.undone = fmt::format("with the positions of '{}' and '{}' exchanged", first, second),
           .correct = [first, second](Sample& s) {
             double *q = position_in(s, first), *r = position_in(s, second);
             if (q != nullptr && r != nullptr) std::swap(*q, *r);
           }});
    }
  }
}

/// Positions in the robot's order under names in another order, or vice versa.
void add_orders(const std::vector<UsedJoint>& joints, Suspects& all) {
  std::vector<std::string> names, sorted, reversed;
  for (const UsedJoint& joint : joints) names.push_back(joint.joint.name);
  sorted = names;
  std::sort(sorted.begin(), sorted.end());
  reversed.assign(names.rbegin(), names.rend());
  const auto add = [&](const std::string& undone, std::vector<std::string> from,
                       std::vector<std::string> to) {
    if (from == to) return;
    all.push_back(
        {.undone = undone, .correct = [from = std::move(from), to = std::move(to)](Sample& s) {
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
}

/// Degrees; zeros that are a quarter or half turn off, as of servos that were screwed on so.
void add_angles(const std::vector<UsedJoint>& joints, Suspects& all) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  std::vector<std::string> turning;
  for (const UsedJoint& joint : joints) {
    if (turns(joint.joint.type)) turning.push_back(joint.joint.name);
  }
  for (const double factor : {kDegree, 1.0 / kDegree}) {
    all.push_back({.undone = factor < 1.0
                                 ? "with joint positions taken as degrees"
                                 : "with joint positions converted from radians to degrees",
                   .correct = [factor, turning](Sample& s) {
                     for (const std::string& name : turning) {
                       if (double* q = position_in(s, name)) *q *= factor;
                     }
                   }});
  }
  for (const std::string& name : turning) {
    for (const int degrees : {90, -90, 180}) {
      all.push_back({.undone = fmt::format("with {} deg added to the positions of '{}', whose zero "
                                           "is a {} turn off",
                                           degrees, name, degrees == 180 ? "half" : "quarter"),
                     .kind = SuspectKind::zero,
                     .correct =
                         [name, by = degrees * kDegree](Sample& s) {
                           if (double* q = position_in(s, name)) *q += by;
                         },
                     .zero_of = name});
    }
  }
}

/// A joint that reads the sum or difference of itself and the one before or after it: an arm's third joint
/// against the horizontal, a wrist with bevel gears.
void add_couplings(const Config& config, const Robot& robot, const std::vector<UsedJoint>& joints,
                   Suspects& all) {
  const auto is_used = [&](const std::string& name) {
    return std::any_of(joints.begin(), joints.end(), [&](const UsedJoint& joint) {
      return joint.joint.name == name && turns(joint.joint.type);
    });
  };
  std::set<std::pair<std::string, std::string>> pairs;
  for (const ModelConfig& model : models_of(config)) {
    for (const std::string& frame : model.frames()) {
      if (!robot.has_link(frame) || !robot.has_link(config.base_link)) continue;
      std::string before;
      for (const ChainJoint& one : make_chain(robot, config.base_link, frame).joints) {
        if (!has_position(one) || !is_used(one.drive.joint)) continue;
        if (!before.empty() && before != one.drive.joint) {
          pairs.insert({one.drive.joint, before});
          pairs.insert({before, one.drive.joint});
        }
        before = one.drive.joint;
      }
    }
  }
  for (const auto& pair : pairs) {
    for (const double sign : {1.0, -1.0}) {
      all.push_back({.undone = fmt::format(
                         "with the positions of '{}', {} which those of '{}' are {}", pair.first,
                         sign > 0.0 ? "to" : "from", pair.second,
                         sign > 0.0 ? "added: it is coupled, or measured against the horizontal"
                                    : "subtracted: it is coupled"),
                     .kind = SuspectKind::property,
                     .correct = [pair, sign](Sample& s) {
                       double *q = position_in(s, pair.first), *other = position_in(s, pair.second);
                       if (q != nullptr && other != nullptr) *q += sign * *other;
                     }});
    }
  }
}

/// True if a sensor's points are in a frame whose orientation is fitted.
[[nodiscard]] bool are_turned_by_fit(const Config& config, const std::string& sensor,
                                     std::span<const Sample> samples) {
  std::set<std::string> frames;
  for (const Sample& sample : samples) {
    for (const Observation& seen : sample.observations) {
      if (seen.sensor != sensor) continue;
      for (const Feature& feature : seen.features) frames.insert(feature.frame);
    }
  }
  return std::any_of(config.steps.begin(), config.steps.end(), [&](const StepConfig& step) {
    return std::any_of(step.free_frames.begin(), step.free_frames.end(), [&](const auto& frame) {
      return frames.contains(frame.name) && frame.axes[3] && frame.axes[4] && frame.axes[5];
    });
  });
}

/// Order of features, units, axes and scale of the points of each model.
void add_features(const Config& config, std::span<const Sample> samples, Suspects& all) {
  const std::set<std::string> pixels = pixel_models(config);
  for (const ModelConfig& model : models_of(config)) {
    if (model.is_surface) continue;  // its points are those of meshes that were matched
    const std::string name = model.name;
    const auto each = [name](Sample& s, auto&& change) {
      for (Observation& seen : s.observations) {
        if (seen.sensor == name) change(seen);
      }
    };
    all.push_back({.undone = fmt::format("with the features of '{}' in reverse order", name),
                   .correct = [=](Sample& s) {
                     each(s, [](Observation& seen) {
                       std::vector<Feature>& features = seen.features;
                       std::reverse(features.begin(), features.end());
                       for (std::size_t i = 0; i < features.size() / 2; ++i) {  // ids stay
                         std::swap(features[i].id, features[features.size() - 1 - i].id);
                       }
                     });
                   }});
    using Point = Vector3<double>;
    const auto points = [each](auto&& change) {
      return [=](Sample& s) {
        each(s, [=](Observation& seen) {
          for (Feature& feature : seen.features) feature.point = change(feature.point);
        });
      };
    };
    const std::string of = fmt::format("with the points of '{}' ", name);
    const auto add = [&](const std::string& undone, auto&& change, double shrinks = 1.0) {
      all.push_back({.undone = of + undone, .correct = points(change), .shrinks = shrinks});
    };
    if (pixels.contains(name)) continue;
    const std::pair<const char*, double> units[] = {
        {"taken as millimetres", 1e-3}, {"taken as centimetres", 1e-2}, {"taken as inches", 0.0254},
        {"multiplied by 0.1", 1e-1},    {"multiplied by 10", 1e1},      {"multiplied by 100", 1e2},
        {"multiplied by 1000", 1e3}};
    for (const auto& [undone, factor] : units) {
      const double by = factor;
      add(
          undone, [by](const Point& p) -> Point { return by * p; }, by);
    }
    // Where the fit turns the points, to mirror them in one axis is to mirror them in each.
    const bool is_any = are_turned_by_fit(config, name, samples);
    for (const int axis : {0, 1, 2}) {
      if (is_any && axis > 0) break;
      add(fmt::format("mirrored{}, as if its axes were left-handed",
                      is_any ? "" : fmt::format(" in {}", "xyz"[axis])),
          [axis](Point p) {
            p(axis) = -p(axis);
            return p;
          });
    }
    add("turned from the axes of a link (x forward) to those of a camera (z forward)",
        [](const Point& p) { return Point(-p.y(), -p.z(), p.x()); });
    add("turned from the axes of a camera (z forward) to those of a link (x forward)",
        [](const Point& p) { return Point(p.z(), -p.x(), -p.y()); });
    all.push_back(
        {.undone = of, .kind = SuspectKind::property, .scale = [each](Sample& s, double factor) {
           each(s, [factor](Observation& seen) {
             for (Feature& feature : seen.features) feature.point *= factor;
           });
         }});
  }
}

/// Frames of two models, or their names in the samples, exchanged.
void add_models(const Config& config, Suspects& all) {
  std::vector<ModelConfig> models = models_of(config);
  std::erase_if(models, [](const ModelConfig& model) { return model.is_surface; });
  for (std::size_t a = 0; a < models.size(); ++a) {
    for (std::size_t b = a + 1; b < models.size(); ++b) {
      const ModelConfig &first = models[a], &second = models[b];
      if (first.frame != second.frame) {
        all.push_back(
            {.undone = fmt::format("with the frames of the models '{}' and '{}' exchanged",
                                   first.name, second.name),
             .correct_config = [first, second](Config& changed) {
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
      all.push_back({.undone = fmt::format("with the observations of '{}' and '{}' exchanged",
                                           first.name, second.name),
                     .correct = [first, second](Sample& s) {
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

/// Rows that belong to neighbours: a frame grabber that returns the image before, a row lost in one of two files.
void add_rows(const Config& config, const std::vector<UsedJoint>& joints,
              std::span<const Sample> samples, Suspects& all) {
  using Take = std::function<void(Sample&, const Sample& from)>;
  const auto add = [&](const std::string& what, const Take& take) {
    for (const int shift : {-1, 1}) {
      all.push_back(
          {.undone = fmt::format("with {} of the sample {}", what, shift < 0 ? "before" : "after"),
           .correct_all = [take, shift](std::vector<Sample>& s) {
             const std::vector<Sample> given = s;
             const auto count = std::ssize(s);
             for (std::ptrdiff_t i = 0; i < count; ++i) {
               const std::ptrdiff_t from = std::clamp<std::ptrdiff_t>(i + shift, 0, count - 1);
               take(s[static_cast<std::size_t>(i)], given[static_cast<std::size_t>(from)]);
             }
           }});
    }
  };
  for (const std::string& joint : measured_poses(config, samples)) {
    add(fmt::format("the poses of '{}'", joint), [joint](Sample& s, const Sample& from) {
      const auto pose = from.poses.find(joint);
      if (pose != from.poses.end()) s.poses[joint] = pose->second;
    });
  }
  if (joints.empty()) return;
  const Take take_joints = [](Sample& s, const Sample& from) {
    for (std::size_t j = 0; j < std::min(s.joint_names.size(), s.joint_positions.size()); ++j) {
      if (const auto q = from.position(s.joint_names[j])) s.joint_positions[j] = *q;
    }
  };
  add("the joint positions", take_joints);
  for (const std::size_t first : {0u, 1u}) {
    all.push_back({.undone = "with the joint positions of each two neighbouring samples exchanged",
                   .correct_all = [take_joints, first](std::vector<Sample>& s) {
                     const std::vector<Sample> given = s;
                     for (std::size_t i = first; i + 1 < s.size(); i += 2) {
                       take_joints(s[i], given[i + 1]);
                       take_joints(s[i + 1], given[i]);
                     }
                   }});
  }
}

}  // namespace
}  // namespace detail

double* position_in(Sample& sample, const std::string& joint) {
  const auto at = std::find(sample.joint_names.begin(), sample.joint_names.end(), joint);
  const auto index = static_cast<std::size_t>(at - sample.joint_names.begin());
  return index < sample.joint_positions.size() ? &sample.joint_positions[index] : nullptr;
}

std::vector<Suspect> suspects_of(const Config& config, const Robot& robot,
                                 std::span<const Sample> samples) {
  std::vector<Suspect> all;
  const std::vector<detail::UsedJoint> joints = detail::used_joints(config, robot, samples);
  detail::add_names(joints, all);
  detail::add_orders(joints, all);
  detail::add_angles(joints, all);
  detail::add_features(config, samples, all);
  detail::add_models(config, all);
  detail::add_pose_suspects(config, samples, all);
  detail::add_drive_suspects(config, all);
  detail::add_rows(config, joints, samples, all);
  detail::add_couplings(config, robot, joints, all);
  return all;
}

}  // namespace kinecal
