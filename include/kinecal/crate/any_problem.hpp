// A calibration problem, independent of the scalar that evaluates it: a robot's sensors, its samples
// and the terms of the cost.
//
// Names are resolved when sensors, blocks and samples are added; evaluation works on numbers only.
// BasicProblem (problem.hpp) adds the samples, packed for evaluation.  solve/, trust/ and report/
// use only this interface, so they are compiled once for all instruction sets.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "kinecal/crate/any_evaluator.hpp"
#include "kinecal/crate/prior_term.hpp"
#include "kinecal/crate/sensor_model.hpp"
#include "kinecal/errors/plane_to_plane.hpp"
#include "kinecal/errors/point_to_pixel.hpp"
#include "kinecal/errors/point_to_plane.hpp"
#include "kinecal/errors/point_to_point.hpp"
#include "kinecal/linkage.hpp"

namespace kinecal {

/// The error blocks that configurations can name.
using BuiltInBlock = std::variant<PointToPoint, PointToPixel, PointToPlane, PlaneToPlane>;

/// A calibration problem.  Add sensors, then error blocks and priors, then samples.
class AnyProblem {
 public:
  /// A problem without sensors, terms and samples.
  /// @param base    the link in which the sensors are compared
  /// @param frames  names of the free frames: joints of the robot or virtual frames
  /// @throws RobotError  if the link does not exist
  AnyProblem(Robot robot, std::string base, ParameterTable table, std::set<std::string> frames);
  virtual ~AnyProblem() = default;

  /// Adds a sensor.
  /// @throws RobotError        if no chain leads from the base to the sensor
  /// @throws std::logic_error  if samples have been added already
  void add_sensor(const Sensor& sensor);

  /// Adds an error block between sensors that have been added.
  /// @throws std::invalid_argument  if a sensor does not exist, or their number or kind is wrong
  /// @throws std::logic_error       if samples have been added already
  virtual void add_built_in(const std::string& name, const BuiltInBlock& block,
                            const std::vector<std::string>& sensors,
                            const TermOptions& options) = 0;

  /// Adds a prior.  It counts once for each sample.
  /// @throws std::invalid_argument  if its joint or frame has no parameter in the table, with the
  ///                                nearest name
  void add_prior(const std::string& name, const Prior& prior, const TermOptions& options = {});

  /// Adds a sample.  Sensors and blocks must have been added before.
  /// @throws SampleError  with the sample and what is missing or wrong; the sample is not added
  void add_sample(const Sample& sample);

  /// All parameters with their initial values and bounds.
  [[nodiscard]] const ParameterTable& table() const { return table_; }
  /// The sensors in the order in which they were added.
  [[nodiscard]] const std::vector<SensorModel>& sensors() const { return sensors_; }
  /// The priors in the order in which they were added.
  [[nodiscard]] const std::vector<PriorTerm>& priors() const { return priors_; }
  /// Number of error blocks, without priors.
  [[nodiscard]] virtual int num_terms() const = 0;
  /// The term of an error block, from 0 in the order in which blocks were added.
  [[nodiscard]] virtual const AnyTerm& term(int index) const = 0;
  /// Number of samples that were added.
  [[nodiscard]] int num_samples() const { return static_cast<int>(sources_.size()); }
  /// Source location of a sample: "samples.yaml:37".
  [[nodiscard]] const std::string& source(int sample) const {
    return sources_[static_cast<std::size_t>(sample)];
  }
  /// Number of residuals: those of all features, and those of each prior once.
  [[nodiscard]] int num_residuals() const {
    return residuals_ + static_cast<int>(priors_.size()) * Prior::kRows;
  }
  /// Number of samples to which a term applies.
  [[nodiscard]] int samples_of(int term) const;
  /// Number of samples of a term to which another term applies as well.
  [[nodiscard]] int shared_samples(int term) const;
  /// The joint, free frame or sensor (its prefix) to which each parameter of the table belongs;
  /// empty for a parameter that belongs to none.
  [[nodiscard]] const std::vector<std::string>& owners() const { return owners_; }
  /// Checks that each free parameter belongs to a joint that moves, a free frame or a sensor.
  /// @throws std::invalid_argument  if one does not, with the nearest name, or if the set is that of
  ///                                another table
  void check(const FreeSet& free) const;
  /// Table indices of the parameters on which some residual of the samples depends; ascending.
  [[nodiscard]] std::vector<int> touched_parameters() const;

  /// An evaluator of the problem.  The problem must outlive it; do not add samples meanwhile.
  /// @param free     the Jacobian's columns
  /// @param threads  number of threads that share the work; zero: one per core
  /// @throws std::invalid_argument  as check()
  [[nodiscard]] virtual std::unique_ptr<AnyEvaluator> evaluator(const FreeSet& free,
                                                                int threads = 1) const = 0;

 protected:
  using Observations = std::vector<std::optional<PackedObservation<double>>>;  ///< by each sensor

  /// Derived classes can be moved.
  AnyProblem(AnyProblem&&) = default;
  /// Derived classes can be moved.
  AnyProblem& operator=(AnyProblem&&) = default;

  /// Samples of one shape.
  struct OfShape {
    int samples = 0;            ///< number of them
    std::size_t open_pack = 0;  ///< the last one; it may have lanes left
  };

  /// @throws std::logic_error  if samples have been added already
  void check_no_samples() const;
  /// The sensors of an error block, by name.
  /// @throws std::invalid_argument  as add_built_in()
  [[nodiscard]] std::vector<int> sensors_of_block(const std::string& name,
                                                  const std::vector<std::string>& sensors,
                                                  int expected, bool second_is_pinhole) const;

 private:
  /// Takes the sample num_samples(), the `shape.samples`th of its shape.
  virtual void pack_sample(const SampleShape& shape, OfShape& of_shape,
                           const Observations& seen) = 0;

  [[nodiscard]] const SensorModel& model(int s) const {
    return sensors_[static_cast<std::size_t>(s)];
  }
  void set_owners();
  void set_owner(int parameter, const std::string& owner) {
    if (parameter >= 0) owners_[static_cast<std::size_t>(parameter)] = owner;
  }
  [[nodiscard]] int sensor_index(const std::string& name) const;
  [[nodiscard]] bool applies(const AnyTerm& term, const Sample& sample,
                             const Observations& observed) const;
  void forget_unused(SampleShape& shape, Observations& seen) const;
  void add_touched(int s, const std::vector<std::size_t>& chains, std::set<int>& touched) const;

  Robot robot_;
  std::string base_;
  ParameterTable table_;
  std::set<std::string> frames_;
  std::vector<std::string> owners_;  ///< of each parameter
  std::vector<SensorModel> sensors_;
  std::vector<PriorTerm> priors_;
  int residuals_ = 0;                      ///< of all features
  std::vector<std::string> sources_;       ///< of each sample
  std::map<SampleShape, OfShape> shapes_;  ///< a node stays where it is: packs point to its key
};

/// A problem that the library evaluates in packets, as wide as its instruction set allows.
/// Parameters as those of the constructor of AnyProblem.
[[nodiscard]] std::unique_ptr<AnyProblem> make_problem(Robot robot, std::string base,
                                                       ParameterTable table,
                                                       std::set<std::string> frames);

/// How the library evaluates problems.
struct Evaluation {
  std::string_view instruction_set;  ///< what its packets are compiled for: "x86-64-v3"
  int lanes = 1;                     ///< samples evaluated at a time
};
/// How the library that this program is linked with evaluates problems.
[[nodiscard]] Evaluation evaluation_of_library();

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/crate/any_problem.ipp"
#include "kinecal/crate/problem.hpp"  // make_problem()
#endif
