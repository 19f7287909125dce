// A sensor on its robot: its parameters and the chains from the base to what it observes.
//
// A feature is given in the sensor's own frame, in a virtual frame (a checkerboard, a tracker)
// beyond it, or in one of Mount::links; each of these frames has its own chain.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "kinecal/linkage.hpp"
#include "kinecal/problem/sampled_chain.hpp"
#include "kinecal/sensors/any_sensor.hpp"

namespace kinecal {

namespace detail {

/// What one sensor observed in one sample.
struct ObservationNumbers {
  std::vector<std::size_t> chain;  ///< of each feature: the sensor's chain to it
  std::vector<double> usable;      ///< of each feature: one, or zero if it is NaN
  std::vector<double> variance;  ///< of each feature: its sigma squared, or zero; empty: no sigmas
  std::vector<double> measured;  ///< of each feature: 3, or 12 with an orientation
  std::vector<double> settings;  ///< see AnySensor::settings()
  /// Of each chain to a feature: the numbers of JointStates (batches.hpp).
  std::vector<std::optional<std::vector<double>>> joints;
};

}  // namespace detail

/// A sensor with its chains and the table indices of its parameters.
class MountedSensor {
 public:
  /// @param frames  names of all free frames: a joint's name corrects that joint, any other name is
  ///                a virtual frame
  /// @throws RobotError  if no chain leads from the base to the sensor's frame or a further link
  MountedSensor(const Robot& robot, const std::string& base, Mount mount,
                std::shared_ptr<const AnySensor> sensor, const ParameterTable& table,
                const std::set<std::string>& frames);

  /// Where it is mounted, and its name.
  [[nodiscard]] const Mount& mount() const { return mount_; }
  /// The sensor itself.
  [[nodiscard]] const AnySensor& sensor() const { return *sensor_; }
  /// The chain to the sensor's frame, then those to virtual frames and further links.
  [[nodiscard]] const std::vector<SampledChain>& chains() const { return chains_; }
  /// Table index of the sensor's lag behind the positions of the joints, seconds: its name is "lag"
  /// after the prefix; -1 if the table does not have it.
  [[nodiscard]] int lag() const { return lag_; }
  /// Table indices of the sensor's own parameters; -1 if the table does not have them.
  [[nodiscard]] const std::vector<int>& parameters() const { return parameters_; }

  /// The values of its own parameters; 0 where the table does not have one.
  /// @param values  of all parameters of the table
  [[nodiscard]] std::vector<double> own_values(ParameterValues values) const;

  /// What the sensor observed, as numbers, without the chains' joints.
  /// @throws SampleError  with what is missing or wrong
  [[nodiscard]] detail::ObservationNumbers measurements(const Observation& seen) const;
  /// The same in a sample, with the joints of the chains that lead to its features.
  /// @throws SampleError  with what is missing or wrong
  [[nodiscard]] detail::ObservationNumbers numbers(const Sample& sample,
                                                   const Observation& seen) const;

 private:
  void add_chain(const Robot& robot, const RuntimeChain& chain, const ParameterTable& table);
  void add_feature(const Feature& feature, detail::ObservationNumbers& all) const;
  void add_sigmas(const Observation& seen, detail::ObservationNumbers& all) const;
  [[nodiscard]] std::size_t chain_to(const std::string& frame) const;
  /// The numbers of JointStates of chain c.
  [[nodiscard]] std::vector<double> joints(const Sample& sample, std::size_t c) const;

  Mount mount_;
  std::shared_ptr<const AnySensor> sensor_;
  std::vector<int> parameters_;
  int lag_ = -1;
  std::vector<SampledChain>
      chains_;  ///< [0] ends at the sensor's frame, the others at virtual frames and further links
  std::map<std::string, std::size_t> chain_by_frame_;
};

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/problem/mounted_sensor.ipp"
#endif
