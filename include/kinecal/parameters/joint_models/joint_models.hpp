// The joint models of a program, and the parameters of them that a robot's joints may have.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/kinematics/robot.hpp"
#include "kinecal/linkage.hpp"
#include "kinecal/parameters/joint_models/joint_model.hpp"

namespace kinecal {

/// A joint model behind an interface.
class AnyJointModel {
 public:
  AnyJointModel() = default;
  AnyJointModel(const AnyJointModel&) = delete;             ///< used through pointers
  AnyJointModel& operator=(const AnyJointModel&) = delete;  ///< used through pointers
  virtual ~AnyJointModel() = default;

  [[nodiscard]] virtual std::span<const ParameterInfo> parameters() const = 0;  ///< of a joint
  [[nodiscard]] virtual ModelPartner partner() const = 0;                       ///< in their names
  /// The effect of a parameter as a formula of the reading q, for people; may be empty.
  [[nodiscard]] virtual std::string_view formula(std::size_t part) const = 0;
  [[nodiscard]] virtual bool is_never_negative() const = 0;  ///< its parameters
  [[nodiscard]] virtual bool needs_masses() const = 0;       ///< of the links
  /// True if a joint of this type, which moves, may have it.
  [[nodiscard]] virtual bool suits(JointType type, bool is_mimic) const = 0;
  /// The effect of a parameter: radians or metres per unit.
  /// @param part     of parameters()
  /// @param partner  joint or link; empty for a model without one
  [[nodiscard]] virtual double effect(std::size_t part, const JointReading& joint,
                                      const std::string& partner) const = 0;
};

namespace detail {

template <JointModel M>
class JointModelOf final : public AnyJointModel {
 public:
  explicit JointModelOf(const M& model) : model_(model) {}
  [[nodiscard]] std::span<const ParameterInfo> parameters() const override {
    return M::kParameters;
  }
  [[nodiscard]] ModelPartner partner() const override { return partner_of<M>(); }
  [[nodiscard]] std::string_view formula(std::size_t part) const override {
    return formula_of<M>(part);
  }
  [[nodiscard]] bool is_never_negative() const override { return kinecal::is_never_negative<M>(); }
  [[nodiscard]] bool needs_masses() const override { return kinecal::needs_masses<M>(); }
  [[nodiscard]] bool suits(JointType type, bool is_mimic) const override {
    return suits_joint<M>(type, is_mimic);
  }
  [[nodiscard]] double effect(std::size_t part, const JointReading& joint,
                              const std::string& partner) const override {
    if constexpr (partner_of<M>() == ModelPartner::none) {
      (void)partner;
      return model_(joint)[part];
    } else {
      return model_(joint, partner)[part];
    }
  }

 private:
  M model_;
};

}  // namespace detail

/// The joint models of this program.  Do not change them while other threads use them.
[[nodiscard]] std::vector<std::shared_ptr<const AnyJointModel>>& joint_models();

namespace detail {
void add_joint_model(std::shared_ptr<const AnyJointModel> model);
}  // namespace detail

/// Adds a joint model: configurations and crates then know its parameters.  Added again, it changes
/// nothing.
/// @throws std::invalid_argument  if another model has a parameter of one of its names
template <JointModel M>
void register_joint_model(const M& model) {
  detail::add_joint_model(std::make_shared<const detail::JointModelOf<M>>(model));
}

/// A parameter of a joint model on a robot.
struct JointModelParameter {
  const AnyJointModel* model = nullptr;
  std::size_t part = 0;  ///< of model->parameters()
  std::string joint;     ///< whose position it changes
  std::string partner;   ///< joint or link; empty: none
  std::string unit;      ///< of the value
  std::string fault;     ///< why the joint cannot have it: "slides"; empty: it can
};

/// The parameter of a name such as "elbow_gear_ratio"; nullopt if it is not one of a joint and a
/// joint model.
[[nodiscard]] std::optional<JointModelParameter> joint_model_parameter(const Robot& robot,
                                                                       std::string_view name);

/// True if a URDF can hold the parameter: in <mimic> of its joint.
[[nodiscard]] inline bool fits_urdf(const JointModelParameter& of) {
  const std::string_view name = of.model->parameters()[of.part].name;
  return name == MimicErrors::kParameters[0].name || name == MimicErrors::kParameters[1].name;
}

/// The same.
/// @throws RobotError  if it is not one, or the joint cannot have it
[[nodiscard]] JointModelParameter checked_joint_model(const Robot& robot, const std::string& name);

/// Names of all parameters of joint models that a joint may have, in the order of the models; those
/// with partners once for each other joint that moves by itself, or each link.
[[nodiscard]] std::vector<std::string> joint_model_names(const Robot& robot, const Joint& joint);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/parameters/joint_models/joint_models.ipp"
#endif
