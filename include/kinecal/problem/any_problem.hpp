// A calibration problem, independent of the scalar that evaluates it: a robot's sensors, its
// samples and the terms of the cost.
//
// Names are resolved when you add sensors, blocks and samples; evaluation works on numbers only.
// BasicProblem (evaluation/problem.hpp) stores the samples in batches.  solve/, trust/ and report/
// use only this interface, so they are compiled once for all instruction sets.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/errors/built_in_block.hpp"
#include "kinecal/linkage.hpp"
#include "kinecal/problem/sample_layout.hpp"
#include "kinecal/problem/term.hpp"
#include "kinecal/sensors/built_in_sensor.hpp"

namespace kinecal {

class AnyEvaluator;

/// What of a sample no error block uses, though it may have been meant.
struct UnusedInput {
  std::vector<std::string> others = {};       ///< sensors that are observed, and not of the problem
  std::vector<std::string> absent = {};       ///< sensors of the problem that are not observed
  std::vector<std::string> not_numbers = {};  ///< sensors with a feature that is not a number
};

/// A calibration problem.  Add sensors, then error blocks and priors, then samples.
class AnyProblem {
 public:
  /// A problem without sensors, terms and samples.
  /// @param base    the link in which the sensors are compared
  /// @param frames  names of the free frames: joints of the robot or virtual frames
  /// @throws RobotError             if the link does not exist
  /// @throws std::invalid_argument  if numbers of a parameter, or a frame, cannot be right
  AnyProblem(Robot robot, std::string base, ParameterTable table, std::set<std::string> frames);
  virtual ~AnyProblem() = default;

  /// Gives each sample poses of its own of floating joints, which are fitted and not measured: a board that a
  /// person holds.  They are eliminated in the evaluation (evaluation/sample_poses.hpp); Sample::poses says where they
  /// start.
  /// @param joints  names of floating joints that are free frames; none of their parameters may be free
  /// @throws std::invalid_argument  if one is no floating joint and free frame
  /// @throws std::logic_error       if samples have been added already
  void give_sample_poses(std::vector<std::string> joints);

  /// Adds a sensor of a built-in type.
  /// @throws RobotError        if no chain leads from the base to the sensor
  /// @throws std::logic_error  if samples have been added already
  virtual void add_built_in(const BuiltInSensor& sensor, const Mount& mount) = 0;

  /// Adds an error block of a built-in type between sensors that have been added.
  /// @throws std::invalid_argument  if a sensor does not exist, their number or kind is wrong, a name
  ///                                or number cannot be right, or a parameter is not in the table
  /// @throws std::logic_error       if samples have been added already
  virtual void add_built_in(const std::string& name, const BuiltInBlock& block,
                            const std::vector<std::string>& sensors,
                            const TermOptions& options) = 0;

  /// Adds a prior.  It counts once for each sample.
  /// @throws std::invalid_argument  if the table has neither parameters of its joint or frame nor
  ///                                one of its name, with the nearest name; or if a mean has no
  ///                                parameter
  void add_prior(const std::string& name, const Prior& prior, const TermOptions& options = {});

  /// Adds a sample.  Sensors and blocks must have been added before.
  /// @throws SampleError  with the sample and what is missing or wrong; the sample is not added
  void add_sample(const Sample& sample);
  /// Leaves samples out, as if they had never been added; the others move up.
  /// @param samples  their numbers, from 0; any order
  void exclude(const std::set<int>& samples);
  /// Replaces what a sensor observed in a sample, as when points are associated anew: points, orientations, camera_info
  /// and conditions.  Frames, sigmas and joints stay.  Make new evaluators afterwards.
  /// @param seen  as many features as were added, in the same frames and in the order of paired()
  /// @throws SampleError            with the sample and what differs; then nothing changes
  /// @throws std::invalid_argument  if there is no such sensor
  void set_measurements(int sample, const Observation& seen);
  /// Sets the noise of an error block: its weight changes in proportion to 1 / sigma.
  /// @param sigma  standard deviation of a residual, in its unit; positive
  void set_sigma(int term, double sigma);
  /// A problem with the same sensors and terms, to which samples can be added.
  [[nodiscard]] virtual std::unique_ptr<AnyProblem> without_samples() const = 0;
  /// The sample as blocks pair its features by their ids: see pair_features().
  [[nodiscard]] std::optional<Sample> paired(const Sample& sample) const;

  /// The robot as in its URDF.
  [[nodiscard]] const Robot& robot() const { return robot_; }
  /// The link in which the sensors are compared.
  [[nodiscard]] const std::string& base() const { return base_; }
  /// Names of the free frames: joints of the robot or virtual frames.
  [[nodiscard]] const std::set<std::string>& frames() const { return frames_; }
  /// Floating joints of which each sample has a pose of its own: see give_sample_poses().
  [[nodiscard]] const std::vector<std::string>& sample_poses() const { return sample_poses_; }
  /// The poses that samples have of their own, by sample and joint: where they start.
  [[nodiscard]] const std::vector<std::vector<Pose<double>>>& poses_of_samples() const {
    return poses_of_samples_;
  }
  /// Sets where these poses start.
  /// @param poses  by sample and joint
  void set_poses_of_samples(std::vector<std::vector<Pose<double>>> poses) {
    poses_of_samples_ = std::move(poses);
  }
  /// All parameters with their initial values and bounds.
  [[nodiscard]] const ParameterTable& table() const { return table_; }
  /// The sensors in the order in which they were added.
  [[nodiscard]] const std::vector<MountedSensor>& sensors() const { return sensors_; }
  /// The priors in the order in which they were added.
  [[nodiscard]] const std::vector<PriorTerm>& priors() const { return priors_; }
  /// Number of error blocks, without priors.
  [[nodiscard]] int num_terms() const { return static_cast<int>(terms_.size()); }
  /// The term of an error block, from 0 in the order in which blocks were added.
  [[nodiscard]] const Term& term(int index) const {
    return terms_[static_cast<std::size_t>(index)];
  }
  /// Number of samples that were added.
  [[nodiscard]] int num_samples() const { return static_cast<int>(samples_.size()); }
  /// Source location of a sample: "samples.yaml:37"; "sample 4", from 0, if it has none.
  [[nodiscard]] const std::string& source(int sample) const {
    return samples_[static_cast<std::size_t>(sample)].source;
  }
  /// The feature of a residual: the i-th that a term compares in a sample.
  [[nodiscard]] FeatureLabel feature(int term, int sample, std::ptrdiff_t i) const;
  /// True if an error block compares something of a sample.
  [[nodiscard]] bool is_used(int sample) const {
    return samples_[static_cast<std::size_t>(sample)].residuals > 0;
  }
  /// What of a sample is left out.
  [[nodiscard]] const UnusedInput& unused(int sample) const {
    return samples_[static_cast<std::size_t>(sample)].unused;
  }
  /// Equal for samples whose numbers are equal, to 1e-6 of their units, for all error blocks.
  [[nodiscard]] std::uint64_t fingerprint(int sample) const {
    return samples_[static_cast<std::size_t>(sample)].fingerprint;
  }
  /// Number of residuals: those of all features, and those of each prior once.
  [[nodiscard]] int num_residuals() const {
    return residuals_ + static_cast<int>(priors_.size()) * Prior::kRows;
  }
  /// Number of samples to which a term applies.
  [[nodiscard]] int samples_of(int term) const { return samples_of(term, 1); }
  /// Number of samples of a term to which another term applies as well.
  [[nodiscard]] int shared_samples(int term) const { return samples_of(term, 2); }
  /// The joint, free frame, sensor (its prefix) or error block that owns each parameter of the
  /// table; empty for a parameter without owner.
  [[nodiscard]] const std::vector<std::string>& owners() const { return owners_; }
  /// Checks that each free parameter belongs to a joint that moves, a free frame, a
  /// sensor or an error block.
  /// @throws std::invalid_argument  if one does not, with the nearest name, or if the set belongs
  ///                                to another table
  void check(const FreeSet& free) const;
  /// Table indices of the parameters that affect some residual of the samples; ascending.
  /// @param term  of this error block only; -1: of any
  [[nodiscard]] std::vector<int> touched_parameters(int term = -1) const;

  /// An evaluator of the problem.  The problem must outlive it; do not add samples meanwhile.
  /// @param free     the Jacobian's columns
  /// @param threads  number of threads that share normal_equations(); zero: one per core
  /// @param terms    indices of the error blocks that count; empty: all
  /// @throws std::invalid_argument  as check(); or if terms are given, and samples have poses of their own
  [[nodiscard]] virtual std::unique_ptr<AnyEvaluator> evaluator(
      const FreeSet& free, int threads = 0, std::span<const int> terms = {}) const = 0;

 protected:
  /// Movable by derived classes.
  AnyProblem(AnyProblem&&) = default;
  /// Movable by derived classes.
  AnyProblem& operator=(AnyProblem&&) = default;

  /// Marks a constructor that leaves the samples behind.
  struct WithoutSamples {};
  /// The sensors and terms of another problem.
  AnyProblem(const AnyProblem& other, WithoutSamples);

  /// Adds a sensor, apart from what evaluates it.
  void mount(std::shared_ptr<const AnySensor> sensor, const Mount& mount);
  /// Adds a term, without the code that evaluates it.
  /// @param term     with neither sensors nor parameters
  /// @param sensors  their names
  /// @param own      the block's own parameters
  /// @throws  as add_built_in()
  void add_term(Term term, const std::vector<std::string>& sensors,
                std::span<const ParameterInfo> own);

 private:
  /// Stores sample num_samples() in a batch.
  /// @param index  of its layout; layouts are numbered in order of first use
  virtual void add_to_batch(std::size_t index, const detail::SampleLayout& layout,
                            std::span<const double> numbers) = 0;
  /// The numbers of a sample in its batch.
  /// @param index  of its layout
  /// @param row    of the sample among those of the layout
  [[nodiscard]] virtual std::vector<double> row_in_batches(std::size_t index,
                                                           std::size_t row) const = 0;
  /// Changes one of them.
  virtual void set_in_batches(std::size_t index, std::size_t row, std::size_t offset,
                              double number) = 0;
  /// Gives the samples in the batches other numbers, and removes some.
  /// @param numbers  of each sample: its new number, or -1 to remove it
  virtual void renumber_in_batches(std::span<const int> numbers) = 0;

  [[nodiscard]] const MountedSensor& sensor(int s) const {
    return sensors_[static_cast<std::size_t>(s)];
  }
  /// Number of samples to which a term applies, and at least so many terms in all.
  [[nodiscard]] int samples_of(int term, std::size_t terms) const;
  void check_no_samples() const;
  void set_owners();
  void set_owner(int parameter, const std::string& owner) {
    if (parameter >= 0) owners_[static_cast<std::size_t>(parameter)] = owner;
  }
  [[nodiscard]] int sensor_index(const std::string& name) const;
  [[nodiscard]] std::vector<int> parameters_of_block(const std::string& name,
                                                     std::span<const ParameterInfo> infos);

  Robot robot_;
  std::string base_;
  ParameterTable table_;
  std::set<std::string> frames_;
  std::vector<std::string> owners_;  ///< of each parameter
  std::vector<std::string> sample_poses_;
  std::vector<std::vector<Pose<double>>> poses_of_samples_;  ///< by sample and joint
  std::vector<MountedSensor> sensors_;
  std::vector<Term> terms_;
  std::vector<PriorTerm> priors_;

  /// A layout and how many samples have it.
  struct LayoutUse {
    std::size_t index = 0;  ///< in order of first use
    int samples = 0;        ///< number of them
  };
  using Layouts = std::map<detail::SampleLayout, LayoutUse>;

  /// What is known of a sample beside its numbers.
  struct AddedSample {
    std::string source;                           ///< "samples.yaml:37"
    const Layouts::value_type* layout = nullptr;  ///< its layout
    std::size_t row = 0;                          ///< its place among the samples of the layout
    int residuals = 0;                            ///< of all features
    std::uint64_t fingerprint = 0;
    UnusedInput unused = {};
    /// Of a term: the features that it compares, unless they are 0, 1, 2 ... without ids.
    std::map<int, std::vector<FeatureLabel>> labels = {};
  };
  std::vector<AddedSample> samples_;
  int residuals_ = 0;  ///< of all samples
  Layouts layouts_;
};

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/problem/any_problem.ipp"
#endif
