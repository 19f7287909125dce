// A term of the cost: an error block with the sensors it compares, its weight and its loss.
//
// The block is known at compile time, the term hides it: a problem holds terms of different blocks.
// A term takes a pack of samples at a time, so hiding it costs nothing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kinecal/crate/difference_gram.hpp"
#include "kinecal/crate/feature_gram.hpp"
#include "kinecal/crate/local_sums.hpp"
#include "kinecal/errors/difference.hpp"
#include "kinecal/errors/loss.hpp"
#include "kinecal/errors/plane_fit.hpp"

namespace kinecal {

struct TermOptions {
  double weight = 1.0;     ///< the residual is multiplied by it: scale / sigma
  Loss loss = {};          ///< of each feature's weighted residual
  bool alone = false;      ///< only samples in which no other sensor observes
  std::string type = {};   ///< for reports: "chain3d_to_chain3d"
  std::string unit = "m";  ///< of the unweighted residual, for reports: "m", "px" or "1"

  [[nodiscard]] Loss loss_for(Losses losses) const {
    return losses == Losses::convex ? loss.convex() : loss;
  }
};

/// Residuals of one term in one sample, features one after the other, and their derivatives.
struct TermResiduals {
  Eigen::VectorXd residual;  ///< unweighted
  Eigen::MatrixXd jacobian;  ///< rows as the residual, a column for each free parameter

  void resize(Eigen::Index rows, int columns) {
    residual.setZero(rows);
    jacobian.setZero(columns >= 0 ? rows : 0, columns >= 0 ? columns : 0);
  }
};

/// Residuals of one term in a pack of samples, and their derivatives.
template <class S>
struct PackedRows {
  /// Features next to each other that hang on the same chains.
  struct Run {
    std::size_t features = 0;
    BodyChains<2> chains{};    ///< those on which they hang
    std::size_t width = 0;     ///< number of columns: see Term::columns()
    std::size_t jacobian = 0;  ///< where its values start
  };
  std::vector<Run> runs;     ///< the first `num_runs` of them
  std::size_t num_runs = 0;  ///< (vectors keep their memory for the next pack)
  std::vector<S> weight;     ///< of each feature: one, or zero where it is missing
  std::vector<S> residual;   ///< of each feature, unweighted
  std::vector<S> jacobian;   ///< of each residual, a value for each column of its run; behind
                             ///< those of the last run, what earlier packs left

  [[nodiscard]] Run& next_run() {
    if (num_runs == runs.size()) runs.emplace_back();
    runs[num_runs].features = 0;
    return runs[num_runs++];
  }
};

/// The normal equations of one term while they are summed.
template <class S>
struct TermSums {
  S twice_cost{0.0};  ///< sum of rho
  std::vector<std::pair<BodyChains<2>, LocalSums<S>>> by_chains;
  FeatureGram<S> gram;                ///< of the features at hand
  DifferenceGram<S> difference;       ///< the same where the block is a difference, and
  std::vector<S> weights;             ///< the features' weights and
  std::vector<Vector3<S>> residuals;  ///< residuals

  void set_zero() {
    twice_cost = S(0.0);
    for (auto& [chains, local] : by_chains) local.set_zero();
  }
};

/// At which points derivatives are taken.
enum class Linearization {
  measured,   ///< those that the sensors saw
  error_free  ///< measurements replaced by the model's prediction.  With residuals, a change that
              ///< no measurement shows still turns them and looks as if it could be seen.  Planes
              ///< are taken as they are.
};

template <class S>
class Term {
 public:
  using Views = std::span<const SensorView<S>* const>;
  using Observations = std::span<const PackedObservation<double>* const>;

  Term(std::string name, std::vector<int> sensors, TermOptions options)
      : name_(std::move(name)), sensors_(std::move(sensors)), options_(std::move(options)) {}
  virtual ~Term() = default;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::vector<int>& sensors() const { return sensors_; }
  [[nodiscard]] const TermOptions& options() const { return options_; }

  /// Number of residuals of one feature.
  [[nodiscard]] virtual int feature_size() const = 0;
  /// True if feature i of one sensor is compared with feature i of the other.
  [[nodiscard]] virtual bool pairs_features() const = 0;
  /// Features that can be compared, given what the sensors observed.
  [[nodiscard]] virtual int count(Observations seen) const = 0;
  /// Why the block cannot take these observations of one sample; empty if it can.
  [[nodiscard]] virtual std::string why_not(Observations seen) const = 0;

  /// Adds the cost of a pack of samples; not finite where a residual is not defined (a point behind
  /// a camera).
  virtual void add_cost(Views views, const Loss& loss, TermSums<S>& sums) const = 0;
  /// Adds the cost and the normal equations of a pack of samples.
  virtual void add_normal_equations(Views views, const Loss& loss, TermSums<S>& sums) const = 0;
  /// @param derivatives  the Jacobian, too
  virtual void evaluate(Views views, bool derivatives, Linearization at,
                        PackedRows<S>& out) const = 0;
  /// The columns of the whole Jacobian that features on these chains can touch: local_columns().
  virtual void columns(Views views, const BodyChains<2>& chains, std::vector<int>& out) const = 0;

 private:
  std::string name_;
  std::vector<int> sensors_;
  TermOptions options_;
};

}  // namespace kinecal
