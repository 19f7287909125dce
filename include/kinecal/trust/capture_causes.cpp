// Definitions of capture_causes.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/capture_causes.hpp"

#include <string>
#include <utility>

#include "kinecal/trust/capture_joints.ipp"
#include "kinecal/trust/capture_trials.ipp"

namespace kinecal {

namespace detail {
namespace {

/// A sample with its features in another order, and a description of that order.
struct FeatureOrder {
  std::string cause;
  Sample sample;
};

/// Reorders the measurements: place i gets that of place order[i].  Ids stay.
[[nodiscard]] Sample with_order(const Sample& sample, std::size_t observation,
                                const std::vector<std::size_t>& order) {
  Sample changed = sample;
  std::vector<Feature>& features = changed.observations[observation].features;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::optional<int> id = features[i].id;
    features[i] = sample.observations[observation].features[order[i]];
    features[i].id = id;
  }
  return changed;
}

/// Feature number `worst` exchanged with another one, or measured at another one.
/// @param of  " of 'camera'", if needed
void add_exchanges(const Sample& sample, std::size_t observation, std::size_t worst, int bad,
                   const std::string& of, std::vector<FeatureOrder>& all) {
  const std::vector<Feature>& features = sample.observations[observation].features;
  const auto label = [&](std::size_t i) {
    return FeatureLabel{static_cast<int>(i), features[i].id};
  };
  const auto number = [&](std::size_t i) {
    return std::to_string(features[i].id.value_or(static_cast<int>(i) + 1));
  };
  const std::string both = features[worst].id ? "the features with ids " : "features ";
  std::vector<std::size_t> order(features.size());
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t other = 0; other < order.size(); ++other) {
    if (other == worst) continue;
    const auto [less, more] = std::minmax(worst, other);
    std::vector<std::size_t> changed = order;
    std::swap(changed[worst], changed[other]);
    all.push_back({both + number(less) + " and " + number(more) + of + " are exchanged",
                   with_order(sample, observation, changed)});
    if (bad > 1) continue;
    changed = order;
    changed[worst] = other;
    all.push_back({label(worst).text() + " shows " + label(other).text(),
                   with_order(sample, observation, changed)});
  }
}

/// A board read from another corner.  Not for a partial board, whose corner is unknown.
void add_turns(const Sample& sample, std::size_t observation, std::vector<FeatureOrder>& all) {
  const std::vector<Feature>& features = sample.observations[observation].features;
  const std::size_t size = features.size();
  for (std::size_t i = 0; i < size; ++i) {
    if (features[i].id && *features[i].id != static_cast<int>(i)) return;
  }
  const auto add = [&](const std::string& cause, auto&& place) {
    std::vector<std::size_t> order(size);
    for (std::size_t i = 0; i < size; ++i) order[i] = place(i);
    all.push_back({cause, with_order(sample, observation, order)});
  };
  add("the features are in reverse order: a board turned by 180 degrees?",
      [&](std::size_t i) { return size - 1 - i; });
  const auto side = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(size))));
  if (side * side != size) return;
  const std::string quarter = "the features are turned by a quarter: a board turned by 90 degrees?";
  add(quarter, [&](std::size_t i) { return (i % side) * side + side - 1 - i / side; });
  add(quarter, [&](std::size_t i) { return (side - 1 - i % side) * side + i / side; });
}

/// The order of features that explains a sample; empty if none does.
/// @param problem  with the sensors whose observations are used
[[nodiscard]] std::string wrong_order(const CaptureTrials& trials, const AnyProblem& problem,
                                      const Sample& sample, const TrialRows& now) {
  const int bad = now.bad(), worst = now.worst().number;
  if (worst < 0) return {};
  std::vector<std::size_t> used;
  for (std::size_t o = 0; o < sample.observations.size(); ++o) {
    const auto is_sensor = [&](const MountedSensor& sensor) {
      return sensor.mount().name == sample.observations[o].sensor;
    };
    const auto& sensors = problem.sensors();
    if (std::any_of(sensors.begin(), sensors.end(), is_sensor)) used.push_back(o);
  }
  std::vector<FeatureOrder> orders;
  for (const std::size_t o : used) {
    const Observation& seen = sample.observations[o];
    const std::size_t size = seen.features.size();
    if (size < 2 || static_cast<std::size_t>(worst) >= size) continue;
    const std::string of = used.size() > 2 ? " of '" + seen.sensor + "'" : "";
    if (bad <= 2) add_exchanges(sample, o, static_cast<std::size_t>(worst), bad, of, orders);
    if (bad > 2) add_turns(sample, o, orders);
  }
  std::vector<Sample> variants;
  for (const FeatureOrder& order : orders) variants.push_back(order.sample);
  if (variants.empty()) return {};
  const std::vector<TrialRows> found = trials(variants);
  std::size_t best = variants.size();
  for (std::size_t i = 0; i < found.size(); ++i) {
    const bool better =
        best == variants.size() || found[i].rows.squaredNorm() < found[best].rows.squaredNorm();
    if (found[i].rows.size() == now.rows.size() && found[i].fits() && better) best = i;
  }
  return best < variants.size() ? orders[best].cause : "";
}

}  // namespace
}  // namespace detail

std::string capture_cause(const AnyProblem& problem, ParameterValues values,
                          const std::vector<BlockNoise>& noise, const Sample& sample) {
  const detail::CaptureTrials trials(problem, values, noise);
  detail::TrialRows now = trials({sample}).front();
  if (!now.defined || now.fits()) return {};
  const std::optional<Sample> in_order = problem.paired(sample);
  if (in_order) now = trials({*in_order}).front();  // the same, numbered as in it
  std::string cause = detail::wrong_order(trials, problem, in_order.value_or(sample), now);
  if (!cause.empty()) return cause;
  constexpr double kBetter = 25.0;  // by five parameters more: once in 10000 by chance
  detail::JointCause one = detail::wrong_reading(trials, problem.robot(), sample, now);
  detail::JointCause all = detail::motion(trials, problem.robot(), sample, now);
  const bool is_one = all.text.empty() || one.chi2 < all.chi2 + kBetter;
  return !one.text.empty() && is_one ? one.text : all.text;
}

}  // namespace kinecal
