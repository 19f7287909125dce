// A crate: a robot's sensors, free parameters and error blocks as one type.
//
//   using Arm = Chain3d<"arm", Chain<fetch::Robot, "torso_lift_link", "wrist_roll_link">>;
//   using Head = Camera3d<"camera", Chain<fetch::Robot, "torso_lift_link", "camera_frame">>;
//   using HandEye = Crate<Arm, Head,
//                         JointOffset<"elbow_flex_joint">, DepthIntrinsics<"camera">,
//                         Block<"hand_eye", PointToPoint, "camera", "arm">>;
//
// Parts may come in any order; parameters keep theirs.  A crate is a part, too: Crate<HandEye,
// Ground> has the parameters and blocks of both, each once.  So crates can share a list of
// parameters by including a crate of them.  The compiler checks the names against the robot
// (crate_checks.hpp).  A crate fills the same Problem as a configuration does, with walks compiled
// for its chains.
// Source: ARCHITECTURE.md, idea 7: one problem, two ways to fill it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/crate_checks.hpp"
#include "kinecal/evaluation/problem.hpp"

namespace kinecal {

template <class... Parts>
class Crate;

namespace detail {

/// Sorts a part into four lists, most of them empty.
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
  using Sensors = Joined<typename ListsOf<Parts>::Sensors...>;
  using Parameters = Joined<typename ListsOf<Parts>::Parameters...>;
  using Blocks = Joined<typename ListsOf<Parts>::Blocks...>;
  using Priors = Joined<typename ListsOf<Parts>::Priors...>;
};

}  // namespace detail

/// A calibration as a type.
/// @tparam Parts  sensors, free parameters, Blocks, PriorOns and other crates
template <class... Parts>
class Crate {
  using Lists = detail::ListsOf<Crate>;

 public:
  using Sensors = typename Lists::Sensors;        ///< type list
  using Parameters = typename Lists::Parameters;  ///< type list
  using Blocks = typename Lists::Blocks;          ///< type list
  using Priors = typename Lists::Priors;          ///< type list
  /// The parameters' slots.
  using Free = typename Parameters::template As<FreeParameters>;

  /// Instantiates the checks.  Not earlier, because a crate that is only a part of another may lack
  /// sensors or blocks.
  Crate() { [[maybe_unused]] constexpr Check kCheck = {}; }

  /// The error block with this name, and its options.
  template <FixedString Name>
  [[nodiscard]] auto& block() {
    return part_of<Name>(blocks_);
  }
  /// The prior with this name, and its options.
  template <FixedString Name>
  [[nodiscard]] auto& prior() {
    return part_of<Name>(priors_);
  }

  /// A block or prior by its type: Block<...> or PriorOn<...>.
  template <class P>
  [[nodiscard]] const P& part() const {
    if constexpr (BlockPart<P>) {
      return std::get<P>(blocks_);
    } else {
      return std::get<P>(priors_);
    }
  }

  /// The robot of the chains, at run time.
  [[nodiscard]] static Robot robot() { return robot_from<RobotOf>(); }
  /// The link at which all chains start and in which the sensors are compared.
  [[nodiscard]] static std::string base() { return std::string(BaseChain::kBase); }

  /// All parameters: those of sensors and blocks, the joint offsets, all six of each free frame.
  /// @param samples  a camera's parameters start from its driver's settings during recording
  [[nodiscard]] ParameterTable table(std::span<const Sample> samples) const {
    ParameterTable table;
    IfRight<Sensors>::for_each([&]<class P>(std::type_identity<P>) {
      add_sensor_parameters(table, *detail::behind_interface(typename P::Model{}), P::mount(),
                            samples);
    });
    IfRight<Blocks>::for_each([&]<class P>(std::type_identity<P>) {
      add_parameters(table, P::kName, parameters_of(std::get<P>(blocks_).error));
    });
    IfRight<Parameters>::for_each([&]<class P>(std::type_identity<P>) { add_parameter<P>(table); });
    return table;
  }

  /// The free parameters, as columns of the Jacobian.
  [[nodiscard]] static FreeSet free(const ParameterTable& table) {
    std::vector<int> indices;
    for (const ParameterId& id : Free::kIds) indices.push_back(table.index(id.name()));
    return FreeSet(std::move(indices), table.size());
  }

  /// The calibration problem without samples.
  template <class S = Packet>
  [[nodiscard]] BasicProblem<S> problem(ParameterTable table) const {
    const auto& frames = Frames::kNames;
    BasicProblem<S> problem(robot(), base(), std::move(table), {frames.begin(), frames.end()});
    IfRight<Sensors>::for_each([&]<class P>(std::type_identity<P>) {
      problem.add_sensor(typename P::Model{}, P::mount(), walks<S, P>());
    });
    IfRight<Blocks>::for_each([&]<class P>(std::type_identity<P>) {
      const P& part = std::get<P>(blocks_);
      const auto& names = P::kSensorNames;
      problem.add_block(std::string(P::kName), part.error, {names.begin(), names.end()},
                        part.options);
    });
    IfRight<Priors>::for_each([&]<class P>(std::type_identity<P>) {
      const P& part = std::get<P>(priors_);
      problem.add_prior(std::string(P::kName),
                        {std::string(P::kOf), part.joint_scale, part.position_scale,
                         part.rotation_scale, part.mean},
                        part.options);
    });
    return problem;
  }

 private:
  using Check = typename detail::CheckCrate<Sensors, Parameters, Blocks, Priors>::type;
  /// A wrong crate fills nothing, so its sentence is the only error where it is used.
  template <class List>
  using IfRight =
      std::conditional_t<std::is_same_v<Check, detail::Holds>, List, detail::TypeList<>>;

  using Frames = typename Parameters::template As<detail::FreeFrames>;
  using BaseChain = typename Sensors::template As<detail::FirstChain>;
  using RobotOf = typename BaseChain::Robot;

  /// Adds the robot's own parameters; sensors and blocks have added theirs.
  template <class P>
  static void add_parameter(ParameterTable& table) {
    if constexpr (P::kKind == ParameterKind::joint_offset) {
      constexpr std::size_t i = detail::joint_index(RobotOf::kJoints, P::kOwner);
      add_joint_offset(table, P::kOwner, RobotOf::kJoints[i].type);
    } else if constexpr (P::kKind == ParameterKind::joint_model) {
      if constexpr (requires { typename P::Model; }) register_joint_model(typename P::Model{});
      const Robot of_crate = robot();
      for (const ParameterId& id : P::kIds) {
        table.add({.name = id.name(), .unit = checked_joint_model(of_crate, id.name()).unit});
      }
    } else if constexpr (is_frame(P::kKind)) {
      add_parameters(table, P::kOwner, kFrameParameters);
    } else if constexpr (P::kKind == ParameterKind::sensor) {
      for (const ParameterId& id : P::kIds) {
        if (id.part == kLag.name) add_parameters(table, P::kOwner, {&kLag, 1});
      }
    }
  }

  /// The compiled walks to a sensor, to the virtual frames beyond it, and to further links.
  template <class S, class Sensor>
  [[nodiscard]] static std::vector<detail::CompiledWalk<S>> walks() {
    std::vector<detail::CompiledWalk<S>> walks = {
        detail::compiled_walk<S, ChainWithFrames<typename Sensor::Chain>, Free>()};
    if constexpr (!kIsInOwnFrame<typename Sensor::Model>) {
      Parameters::for_each([&]<class P>(std::type_identity<P>) {
        if constexpr (P::kKind == ParameterKind::virtual_frame) {
          walks.push_back(
              detail::compiled_walk<S, ChainWithFrames<typename Sensor::Chain, P>, Free>());
        }
      });
    }
    if constexpr (requires { typename Sensor::Further; }) {
      [&]<class... Cs>(std::type_identity<std::tuple<Cs...>>) {
        (walks.push_back(detail::compiled_walk<S, ChainWithFrames<Cs>, Free>()), ...);
      }(std::type_identity<typename Sensor::Further>());
    }
    return walks;
  }

  /// A sensor's chain with the frame corrections of this crate.
  template <class C, class VirtualFrame = void>
  using ChainWithFrames = detail::CorrectedChain<C, Frames, VirtualFrame>;

  template <FixedString Name, class... Ts>
  [[nodiscard]] static auto& part_of(std::tuple<Ts...>& parts) {
    using List = detail::TypeList<Ts...>;
    using Match = LookedUp<kView<Name>, List>;
    [[maybe_unused]] constexpr detail::Unless<Match::kExists, detail::PartOfName<Name, Match>>
        kPartCheck = {};
    if constexpr (Match::kExists) {
      constexpr auto kPlace = std::find(List::kNames.begin(), List::kNames.end(), Name);
      return std::get<kPlace - List::kNames.begin()>(parts);
    } else if constexpr (sizeof...(Ts) > 0) {
      return std::get<0>(parts);  // Also has options, so no further error follows
    } else {
      return parts;
    }
  }

  typename Blocks::template As<std::tuple> blocks_;
  typename Priors::template As<std::tuple> priors_;
};

}  // namespace kinecal
