// A crate: a robot's sensors, free parameters and error blocks as one type.
//
//   using Arm = Chain3d<"arm", Chain<fetch::Robot, "torso_lift_link", "wrist_roll_link">>;
//   using Head = Camera3d<"camera", Chain<fetch::Robot, "torso_lift_link", "camera_frame">>;
//   using HandEye = Crate<Arm, Head,
//                         JointOffset<"elbow_flex_joint">, DepthIntrinsics<"camera">,
//                         Block<"hand_eye", PointToPoint, "camera", "arm">>;
//
// The order of the parts does not matter but for that of the parameters.  Crates are parts, too:
// Crate<HandEye, Ground> has the parameters of both, each once, and the blocks of both; a list of
// parameters that several crates share is one, too.  Names are checked against the robot while
// compiling (crate_checks.hpp).  A crate fills the same Problem as a configuration does, with walks
// that are compiled for its chains.
// Source: the design of kinecal, idea 7.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/camera_parameters.hpp"
#include "kinecal/crate/crate_checks.hpp"
#include "kinecal/crate/problem.hpp"

namespace kinecal {

template <class... Parts>
class Crate;

namespace detail {

/// The lists of a part, of which most are empty.
template <class P>
struct ListsOf {
  using Sensors = OnlyIf<SensorPart<P>, P>;
  using Parameters = OnlyIf<FreeParameter<P>, P>;
  using Blocks = OnlyIf<BlockPart<P>, P>;
  using Priors = OnlyIf<PriorPart<P>, P>;
  static constexpr bool kIsPart = SensorPart<P> || FreeParameter<P> || BlockPart<P> || PriorPart<P>;
  static constexpr Unless<kIsPart, PartOfCrate<P>> kCheck = {};
};
template <class... Parts>
struct ListsOf<Crate<Parts...>> {
  using Sensors = typename AllOf<typename ListsOf<Parts>::Sensors...>::type;
  using Parameters = typename AllOf<typename ListsOf<Parts>::Parameters...>::type;
  using Blocks = typename AllOf<typename ListsOf<Parts>::Blocks...>::type;
  using Priors = typename AllOf<typename ListsOf<Parts>::Priors...>::type;
};

template <class List>
struct Frames;
template <class... Ps>
struct Frames<TypeList<Ps...>> {
  [[nodiscard]] static constexpr bool contains(std::string_view name) {
    return ((Ps::kKind == ParameterKind::frame_offset && Ps::kOwner == name) || ...);
  }
  [[nodiscard]] static std::set<std::string> all() {
    std::set<std::string> names;
    const auto add = [&](ParameterKind kind, std::string_view owner) {
      const bool is_frame =
          kind == ParameterKind::frame_offset || kind == ParameterKind::virtual_frame;
      if (is_frame) names.emplace(owner);
    };
    (add(Ps::kKind, Ps::kOwner), ...);
    return names;
  }
};

}  // namespace detail

template <class... Parts>
class Crate {
  using Lists = detail::ListsOf<Crate>;

 public:
  using Sensors = typename Lists::Sensors;
  using Parameters = typename Lists::Parameters;
  using Blocks = typename Lists::Blocks;
  using Priors = typename Lists::Priors;
  using Free = typename Parameters::template As<FreeParameters>;

  /// Checked here and not before: a part of another crate needs no sensor or block of its own.
  Crate() {
    [[maybe_unused]] constexpr
        typename detail::CheckCrate<Sensors, Parameters, Blocks, Priors>::type kCheck = {};
  }

  /// The error block of a name, with its options.
  template <FixedString Name>
  [[nodiscard]] auto& block() {
    return part_of<Name>(blocks_);
  }
  /// The prior of a name.
  template <FixedString Name>
  [[nodiscard]] auto& prior() {
    return part_of<Name>(priors_);
  }

  [[nodiscard]] static Robot robot() { return robot_from<RobotOf>(); }
  [[nodiscard]] static std::string base() { return std::string(BaseChain::kBase); }

  /// All parameters: those of the depth cameras, and those that are free with their whole frames.
  /// @param samples  a camera's settings start from what its driver had when they were recorded
  [[nodiscard]] static ParameterTable table(std::span<const Sample> samples) {
    ParameterTable table;
    for_each(Sensors{}, [&]<class P>(P*) { add_camera_parameters(table, P::sensor(), samples); });
    for_each(Parameters{}, [&]<class P>(P*) { add_parameter<P>(table); });
    return table;
  }

  /// The columns of the Jacobian: all free parameters.
  [[nodiscard]] static FreeSet free(const ParameterTable& table) {
    std::vector<int> indices;
    for (const ParameterId& id : Free::kIds) indices.push_back(table.index(id.name()));
    return FreeSet(std::move(indices), table.size());
  }

  /// The calibration problem without samples.
  template <class S = Packet>
  [[nodiscard]] BasicProblem<S> problem(ParameterTable table) const {
    BasicProblem<S> problem(robot(), base(), std::move(table), FramesHere::all());
    for_each(Sensors{}, [&]<class P>(P*) { problem.add_sensor(P::sensor(), walks<S, P>()); });
    for_each(Blocks{}, [&]<class P>(P*) {
      const P& part = std::get<P>(blocks_);
      const auto& names = P::kSensorNames;
      problem.template add_block<SizesOf<P>>(std::string(P::kName), part.error,
                                             {names.begin(), names.end()}, part.options);
    });
    for_each(Priors{}, [&]<class P>(P*) {
      const P& part = std::get<P>(priors_);
      problem.add_prior(
          std::string(P::kName),
          {std::string(P::kOf), part.joint_scale, part.position_scale, part.rotation_scale},
          part.options);
    });
    return problem;
  }

 private:
  using FramesHere = detail::Frames<Parameters>;

  using BaseChain = typename detail::FirstChain<Sensors>::type;
  using RobotOf = typename BaseChain::Robot;

  template <class... Ts, class F>
  static constexpr void for_each(detail::TypeList<Ts...>, F&& f) {
    (f(static_cast<Ts*>(nullptr)), ...);
  }

  template <class P>
  static void add_parameter(ParameterTable& table) {
    const auto add = [&](const std::string& name, const char* unit) {
      if (table.find(name) < 0) table.add({.name = name, .unit = unit});
    };
    if constexpr (P::kKind == ParameterKind::joint_offset) {
      constexpr JointType type = RobotOf::kJoints[detail::joint_index<RobotOf>(P::kOwner)].type;
      add(std::string(P::kOwner), turns(type) ? "rad" : "m");
    } else if constexpr (P::kKind == ParameterKind::frame_offset ||
                         P::kKind == ParameterKind::virtual_frame) {
      for (std::size_t k = 0; k < 6; ++k) {
        add(parameter_name(P::kOwner, kFrameAxes[k]), k < 3 ? "m" : "rad");
      }
    }
  }

  /// The walks to a sensor and to the virtual frames beyond it.
  template <class S, class Sensor>
  [[nodiscard]] static std::vector<CompiledWalk<S>> walks() {
    std::vector<CompiledWalk<S>> walks = {
        compiled_walk<S, ChainWithFrames<typename Sensor::Chain>, Free>()};
    if constexpr (Sensor::kType == SensorType::chain3d) {
      for_each(Parameters{}, [&]<class P>(P*) {
        if constexpr (P::kKind == ParameterKind::virtual_frame) {
          walks.push_back(compiled_walk<S, ChainWithFrames<typename Sensor::Chain, P>, Free>());
        }
      });
    }
    return walks;
  }

  /// A sensor's chain with the corrections that are free here.
  template <class C, class VirtualFrame = void>
  using ChainWithFrames = detail::CorrectedChain<C, FramesHere, VirtualFrame>;

  /// How many columns the bodies of a block's sensors have, seen in the sensors' own frames.
  template <class Sensor>
  [[nodiscard]] static constexpr BodySizes sizes() {
    BodySizes size;
    using C = ChainWithFrames<typename Sensor::Chain>;
    for (std::size_t i = 0; i < C::kSize; ++i) {
      const JointIndices& joint = kColumnsOf<C, Free>[i];
      for (std::size_t k = 0; k < 6; ++k) {
        if (joint.frame[k] >= 0) ++(k < 3 ? size.shifts : size.turns);
      }
      if (joint.offset >= 0) ++(turns(C::kJoints[i].type) ? size.turns : size.shifts);
    }
    if (Sensor::kType != SensorType::chain3d) {
      for (const std::string_view part : kCameraParameters) {
        if (Free::find(Sensor::kName, part) >= 0) ++size.cameras;
      }
    }
    return size;
  }
  template <class... Ts>
  [[nodiscard]] static constexpr BodySizes sizes_of(std::string_view name,
                                                    detail::TypeList<Ts...>) {
    BodySizes size;
    (void)((Ts::kName == name ? (size = sizes<Ts>(), true) : false) || ...);
    return size;
  }
  template <class P>
  [[nodiscard]] static constexpr auto sizes_of_block() {
    if constexpr (P::kSensorNames.size() == 2) {
      return KnownSizes<sizes_of(P::kSensorNames[0], Sensors{}),
                        sizes_of(P::kSensorNames[1], Sensors{})>{};
    }
  }
  template <class P>
  using SizesOf = decltype(sizes_of_block<P>());

  template <FixedString Name, class... Ts>
  [[nodiscard]] static auto& part_of(std::tuple<Ts...>& parts) {
    using Names = detail::PartNames<detail::TypeList<Ts...>>;
    using Found = LookedUp<kView<Name>, Names>;
    [[maybe_unused]] constexpr detail::Unless<Found::kExists, detail::PartOfName<Name, Found>>
        kPartCheck = {};
    if constexpr (Found::kExists) {
      return std::get<Names::index(Name)>(parts);
    } else {
      return parts;
    }
  }

  typename Blocks::template As<std::tuple> blocks_;
  typename Priors::template As<std::tuple> priors_;
};

}  // namespace kinecal
