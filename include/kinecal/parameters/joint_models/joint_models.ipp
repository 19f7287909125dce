// Definitions of joint_models.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <stdexcept>
#include <typeinfo>
#include <utility>

#include "kinecal/parameters/joint_models/joint_models.hpp"

namespace kinecal {

namespace detail {

/// The unit of a parameter for a joint that slides: metres in place of radians, newtons of torques.
[[nodiscard]] inline std::string unit_of_sliding(std::string_view unit) {
  std::string sliding(unit);
  if (sliding.starts_with("rad")) sliding.replace(0, 3, "m");
  if (sliding.ends_with("Nm")) sliding.pop_back();
  return sliding;
}

/// Why a joint cannot have a parameter; empty if it can.
[[nodiscard]] inline std::string model_fault(const Robot& robot, const JointModelParameter& of) {
  const Joint& joint = robot.joint(of.joint);
  if (!moves(joint.type)) return "does not move";
  if (!of.model->suits(joint.type, joint.mimic.has_value())) {
    if (joint.mimic && of.model->suits(joint.type, false)) return "mimics another; name that one";
    if (!joint.mimic && of.model->suits(joint.type, true)) return "does not mimic another";
    return "slides; only a joint that rotates has this parameter";
  }
  if (of.model->needs_masses() && robot.weight().links.empty()) {
    return "moves links without mass: the URDF has no <inertial>, or it is a crate's robot, which "
           "has "
           "none; '" +
           of.joint + "_link_sag_' and a link is the sag by that link, of unknown mass";
  }
  if (of.model->partner() == ModelPartner::joint) {
    const Joint& other = robot.joint(of.partner);
    if (of.partner == of.joint) return "cannot move itself along";
    if (!moves(other.type)) return "is not moved by '" + of.partner + "', which does not move";
    if (other.mimic) return "is moved by '" + of.partner + "', which mimics another; name that one";
  }
  return {};
}

[[nodiscard]] inline JointModelParameter model_parameter(const Robot& robot,
                                                         const AnyJointModel& model,
                                                         std::size_t part, const Joint& joint,
                                                         std::string partner) {
  JointModelParameter of{&model, part, joint.name, std::move(partner), {}, {}};
  const std::string_view unit = model.parameters()[part].unit;
  of.unit = joint.type == JointType::prismatic ? unit_of_sliding(unit) : std::string(unit);
  if (model.partner() == ModelPartner::joint) {
    const auto own = position_unit(joint.type), other = position_unit(robot.joint(of.partner).type);
    if (own != other) of.unit = std::string(own) + "/" + std::string(other);
  }
  of.fault = model_fault(robot, of);
  return of;
}

}  // namespace detail

KINECAL_INLINE std::vector<std::shared_ptr<const AnyJointModel>>& joint_models() {
  static std::vector<std::shared_ptr<const AnyJointModel>> models = [] {
    std::vector<std::shared_ptr<const AnyJointModel>> built_in;
    std::apply(
        [&](const auto&... all) {
          (built_in.push_back(
               std::make_shared<const detail::JointModelOf<std::decay_t<decltype(all)>>>(all)),
           ...);
        },
        JointModels{});
    return built_in;
  }();
  return models;
}

KINECAL_INLINE void detail::add_joint_model(std::shared_ptr<const AnyJointModel> model) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  const AnyJointModel& added = *model;
  for (const auto& known : joint_models()) {
    const AnyJointModel& other = *known;
    if (typeid(added) == typeid(other)) return;
    for (const ParameterInfo& info : added.parameters()) {
      for (const ParameterInfo& taken : other.parameters()) {
        if (info.name != taken.name) continue;
        throw std::invalid_argument("two joint models have a parameter '" + std::string(info.name) +
                                    "'; rename one of them");
      }
    }
  }
  joint_models().push_back(std::move(model));
}

KINECAL_INLINE std::optional<JointModelParameter> joint_model_parameter(const Robot& robot,
                                                                        std::string_view name) {
  for (const Joint& joint : robot.joints()) {
    if (!name.starts_with(joint.name) || name.size() <= joint.name.size() + 1) continue;
    if (name[joint.name.size()] != '_') continue;
    const std::string_view rest = name.substr(joint.name.size() + 1);
    for (const auto& model : joint_models()) {
      const auto infos = model->parameters();
      for (std::size_t part = 0; part < infos.size(); ++part) {
        if (model->partner() == ModelPartner::none) {
          if (rest == infos[part].name)
            return detail::model_parameter(robot, *model, part, joint, {});
          continue;
        }
        const std::string prefix = std::string(infos[part].name) + "_";
        if (!rest.starts_with(prefix)) continue;
        const std::string partner(rest.substr(prefix.size()));
        const bool exists = model->partner() == ModelPartner::joint ? robot.has_joint(partner)
                                                                    : robot.has_link(partner);
        if (exists) return detail::model_parameter(robot, *model, part, joint, partner);
      }
    }
  }
  return std::nullopt;
}

KINECAL_INLINE JointModelParameter checked_joint_model(const Robot& robot,
                                                       const std::string& name) {
  const std::optional<JointModelParameter> of = joint_model_parameter(robot, name);
  if (!of) throw RobotError("parameter '" + name + "' is not of a joint model");
  if (of->fault.empty()) return *of;
  throw RobotError("parameter '" + name + "': joint '" + of->joint + "' " + of->fault);
}

KINECAL_INLINE std::vector<std::string> joint_model_names(const Robot& robot, const Joint& joint) {
  std::vector<std::string> names;
  const auto add = [&](const ParameterInfo& info, const std::string& partner) {
    const std::string name = parameter_name(joint.name, info.name);
    names.push_back(partner.empty() ? name : name + "_" + partner);
  };
  for (const auto& model : joint_models()) {
    if (!moves(joint.type) || !model->suits(joint.type, joint.mimic.has_value())) continue;
    if (model->needs_masses() && robot.weight().links.empty()) continue;
    for (const ParameterInfo& info : model->parameters()) {
      if (model->partner() == ModelPartner::none) add(info, "");
      if (model->partner() == ModelPartner::link) {
        for (const std::string& link : robot.link_names()) add(info, link);
      }
      if (model->partner() != ModelPartner::joint) continue;
      for (const Joint& other : robot.joints()) {
        if (moves(other.type) && !other.mimic && other.name != joint.name) add(info, other.name);
      }
    }
  }
  return names;
}

}  // namespace kinecal
