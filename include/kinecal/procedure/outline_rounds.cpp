// Definitions of outline_rounds.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/procedure/outline_rounds.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/loss_names.hpp"
#include "kinecal/errors/point_to_outline.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/surface/mask_search.hpp"
#include "kinecal/surface/outline_match.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/trust/plain_equations.hpp"

namespace kinecal {

namespace detail {
namespace {

constexpr double kNarrowestGate = 3.0;  ///< pixels, of a gate without a loss
constexpr double kLossScales = 20.0;    ///< scales of a loss, of the gate with one
constexpr double kOnOutline = 0.04;     ///< of the size of masks: an edge within is on the outline
constexpr double kLeastShare = 0.5;     ///< of edges on the outline, and of the outline on edges
constexpr int kFewEdges = 300;          ///< of a sample, in coarse rounds
constexpr std::size_t kSimpleTriangles = 600;  ///< of a link, in coarse rounds

[[nodiscard]] ParameterValues values_of_all(const Eigen::VectorXd& values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
}

/// The size of masks, pixels: median distance of their edges from the middle.
[[nodiscard]] double size_of_masks(std::span<const Sample> samples, const std::string& camera) {
  std::vector<double> sizes;
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(camera);
    if (seen == nullptr || seen->features.empty()) continue;
    std::vector<double> u, v, away;
    for (const Feature& edge : seen->features) {
      if (!edge.point.allFinite()) continue;
      u.push_back(edge.point.x());
      v.push_back(edge.point.y());
    }
    if (u.empty()) continue;
    const Eigen::Vector2d middle(median_of(u), median_of(v));
    for (std::size_t i = 0; i < u.size(); ++i)
      away.push_back((Eigen::Vector2d(u[i], v[i]) - middle).norm());
    sizes.push_back(median_of(std::move(away)));
  }
  return sizes.empty() ? 100.0 : std::max(10.0, median_of(std::move(sizes)));
}

/// A block of masks, with what finds its outlines.
struct OutlineBlock {
  const SurfaceBlock* of = nullptr;
  Outliner fine, simple;
  double size = 100.0;  ///< of its masks, pixels

  /// An edge within is on the outline, pixels.
  [[nodiscard]] double near() const { return std::max(1.5, kOnOutline * size); }
};

/// How edges count in a round.
struct OutlineManner {
  double gate = 100.0;               ///< pixels
  std::optional<double> huber = {};  ///< pixels, of a loss in place of the configured one
  int rounds = 1;                    ///< at most
  bool is_simple = false;            ///< with simple meshes
};

/// A state of the rounds: what fits the values.
struct OutlineState {
  Eigen::VectorXd values;
  std::vector<OutlineHits> hits = {};  ///< by block
  std::vector<int> free = {};          ///< table indices of the columns of the sums
  Eigen::VectorXd gradient = {};       ///< (free) of the cost
  Eigen::MatrixXd hessian = {};        ///< (free x free)
  double cost = std::numeric_limits<double>::infinity();  ///< with what is beyond the gate
};

/// The rounds of one step.
class OutlineRounds {
 public:
  OutlineRounds(const SurfaceInput& input, const Config& config, std::size_t step,
                std::span<const SurfaceBlock> blocks, std::span<const Sample> samples)
      : input_(input), config_(config), step_(step) {
    for (const SurfaceBlock& block : blocks) {
      blocks_.push_back({&block, Outliner(block.surface), Outliner(block.surface, kSimpleTriangles),
                         size_of_masks(samples, block.pair.camera)});
    }
  }

  [[nodiscard]] const std::vector<OutlineBlock>& blocks() const { return blocks_; }

  /// Goes downhill from values; returns the state in which it ended.
  [[nodiscard]] OutlineState run(const OutlineManner& manner, std::span<const Sample> samples,
                                 const Eigen::VectorXd& values) const {
    constexpr double kSettled = 1e-7;  // of the cost
    constexpr int kKinks = 3;          // the cost has some, where the nearest point changes
    const std::unique_ptr<AnyProblem> problem = problem_for(manner.huber);
    OutlineState state = evaluated(*problem, manner, samples, values);
    double damping = 1e-3;
    int rejected = 0;
    for (int round = 0; round < manner.rounds && rejected < kKinks; ++round) {
      OutlineState next = evaluated(*problem, manner, samples, stepped(*problem, state, damping));
      const double fall = state.cost - next.cost;
      damping = fall > 0.0 ? std::max(1e-9, 0.1 * damping) : 30.0 * damping;
      rejected = fall > 0.0 ? 0 : rejected + 1;
      if (!(fall > 0.0)) continue;
      const bool is_settled = fall <= kSettled * state.cost;
      state = std::move(next);
      if (is_settled) break;
    }
    return state;
  }

  /// The problem of the step without samples.
  /// @param huber  pixels, of a loss in place of the configured ones
  [[nodiscard]] std::unique_ptr<AnyProblem> problem_for(const std::optional<double>& huber) const {
    Config config = config_;
    for (BlockConfig& block : config.steps[step_].error_blocks) {
      if (huber && block.type == PointToOutline::kType) {
        block.loss = {"huber", *huber / block.sigma.value_or(1.0)};
      }
    }
    Diagnostics quiet;
    Calibration calibration = kinecal::assemble(config, input_.robot, {}, quiet);
    quiet.throw_if_errors();
    return std::move(calibration.steps.at(step_).problem);
  }

  /// What belongs together in all samples.
  [[nodiscard]] std::vector<OutlineHits> associated(const AnyProblem& problem,
                                                    std::span<const Sample> samples,
                                                    const Eigen::VectorXd& values, double bound,
                                                    bool is_simple) const {
    std::vector<OutlineHits> hits;
    for (const OutlineBlock& block : blocks_) {
      hits.push_back(kinecal::match_outlines(
          is_simple ? block.simple : block.fine, block.of->surface, block.of->pair, problem,
          values_of_all(values), samples, bound, input_.threads));
    }
    return hits;
  }

  [[nodiscard]] std::vector<Sample> matched(std::span<const Sample> samples,
                                            const std::vector<OutlineHits>& hits,
                                            double gate) const {
    std::vector<Sample> all(samples.begin(), samples.end());
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      all = with_outline(blocks_[b].of->surface, blocks_[b].of->pair, all, hits[b], gate);
    }
    return all;
  }

 private:
  [[nodiscard]] OutlineState evaluated(const AnyProblem& empty, const OutlineManner& manner,
                                       std::span<const Sample> samples,
                                       Eigen::VectorXd values) const {
    OutlineState state{.values = std::move(values)};
    state.hits = associated(empty, samples, state.values, manner.gate, manner.is_simple);
    const std::unique_ptr<AnyProblem> problem = empty.without_samples();
    for (const Sample& sample : matched(samples, state.hits, manner.gate)) {
      problem->add_sample(sample);
    }
    const std::vector<int> touched = problem->touched_parameters();
    for (const FreeParamConfig& parameter : free_parameters(config_.steps[step_])) {
      const int index = problem->table().find(parameter.name);
      if (std::binary_search(touched.begin(), touched.end(), index)) state.free.push_back(index);
    }
    if (state.free.empty()) return state;
    const FreeSet free(state.free, problem->table().size());
    state.free = free.parameters();
    const PlainEquations sums =
        plain_equations(*problem, free, values_of_all(state.values), input_.threads);
    state.gradient = sums.gradient.matrix();
    state.hessian = sums.hessian.matrix();
    state.cost = sums.cost + cost_beyond(*problem, manner.gate, state.hits);
    if (!std::isfinite(state.cost)) state.cost = std::numeric_limits<double>::infinity();
    return state;
  }

  /// What edges and points of the outline cost that have nothing within the gate.
  [[nodiscard]] double cost_beyond(const AnyProblem& problem, double gate,
                                   const std::vector<OutlineHits>& hits) const {
    double cost = 0.0;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      for (int t = 0; t < problem.num_terms(); ++t) {
        const Term& term = problem.term(t);
        if (term.name != blocks_[b].of->name) continue;
        const double most = term.options.loss(std::pow(term.weight * gate, 2)).rho;
        for (const auto& of_sample : hits[b]) {
          for (const OutlineHit& hit : of_sample) cost += hit.edge < 0 ? 0.5 * most : 0.0;
        }
      }
    }
    return cost;
  }

  /// Values after a damped step, inside of bounds.
  [[nodiscard]] static Eigen::VectorXd stepped(const AnyProblem& problem, const OutlineState& state,
                                               double damping) {
    Eigen::VectorXd values = state.values;
    const Eigen::Index n = state.gradient.size();
    if (n == 0 || state.free.empty()) return values;
    Eigen::MatrixXd hessian = state.hessian;
    const double mean = hessian.trace() / static_cast<double>(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      hessian(i, i) += damping * hessian(i, i) + 1e-9 * mean + 1e-30;
    }
    const Eigen::VectorXd step = hessian.ldlt().solve(-state.gradient);
    for (Eigen::Index i = 0; i < n; ++i) {
      const int p = state.free[static_cast<std::size_t>(i)];
      const Parameter& parameter = problem.table()[p];
      values[p] = std::clamp(values[p] + step[i], parameter.lower, parameter.upper);
    }
    return values;
  }

  const SurfaceInput& input_;
  const Config& config_;
  std::size_t step_;
  std::vector<OutlineBlock> blocks_;
};

/// Distances of the edges of masks, or of the points of outlines; infinite where nothing is near.
/// @param of_edges  of edges
[[nodiscard]] std::vector<double> distances_of(const OutlineHits& hits,
                                               std::span<const Sample> samples,
                                               const std::string& camera, bool of_edges) {
  std::vector<double> distances;
  for (std::size_t s = 0; s < hits.size(); ++s) {
    const Observation* seen = samples[s].observation(camera);
    const std::size_t edges = seen == nullptr ? 0 : seen->features.size();
    for (std::size_t i = 0; i < hits[s].size(); ++i) {
      if ((i < edges) == of_edges) distances.push_back(hits[s][i].distance);
    }
  }
  return distances;
}

[[nodiscard]] double share_within(const std::vector<double>& distances, double within) {
  if (distances.empty()) return 0.0;
  const auto near =
      std::count_if(distances.begin(), distances.end(), [&](double d) { return d <= within; });
  return static_cast<double>(near) / static_cast<double>(distances.size());
}

/// Poses of a camera that its masks suggest, as values of a frame.
[[nodiscard]] std::vector<Eigen::VectorXd> searched(const OutlineBlock& block,
                                                    const UnknownFrame& frame,
                                                    const AnyProblem& problem,
                                                    std::span<const Sample> samples,
                                                    const Eigen::VectorXd& start) {
  const std::string& name = block.of->pair.camera;
  const SearchedFrame in_chain(frame, problem, name);
  if (!in_chain.is_usable()) return {};
  const MountedSensor& camera = in_chain.camera();
  const SampledChain& chain = camera.chains().front();
  const Eigen::VectorXd zero = in_chain.zeroed(start);
  const std::vector<double> own = camera.own_values(values_of_all(zero));
  std::vector<PosedMask> masks;
  std::optional<Pose<double>> frame_T_camera;
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(name);
    if (seen == nullptr || seen->features.empty() || !seen->camera) continue;
    const std::vector<double> settings = camera.sensor().settings(*seen);
    const auto ideal = [&](double u, double v) {
      const Vector3<double> ray = camera.sensor().place({u, v, 0.0}, settings, own);
      return Eigen::Vector2d(ray.x() / ray.z(), ray.y() / ray.z());
    };
    frame_T_camera = in_chain.before(sample, zero).inverse() *
                     chain.tip(sample, corrections_for(chain.parameters(), values_of_all(zero)));
    PosedMask& mask = masks.emplace_back();
    mask.low = ideal(0.0, 0.0);
    mask.high = ideal(seen->camera->width - 1.0, seen->camera->height - 1.0);
    for (const Feature& edge : seen->features) {
      const auto u = edge.conditions.find("nu"), v = edge.conditions.find("nv");
      const Eigen::Vector2d pixel = ideal(edge.point.x(), edge.point.y());
      if (!pixel.allFinite() || u == edge.conditions.end() || v == edge.conditions.end()) continue;
      mask.edges.push_back({pixel, {u->second, v->second}});
    }
    mask.links = in_chain.links(*block.of, sample, zero);
  }
  std::vector<Eigen::VectorXd> found;
  if (!frame_T_camera) return found;
  for (const Pose<double>& pose : find_camera_poses(block.of->surface, masks)) {
    found.push_back(in_chain.with(pose * frame_T_camera->inverse(), start));
  }
  return found;
}

/// The whole of the rounds.
class OutlineFit {
 public:
  OutlineFit(const SurfaceInput& input, const Config& config, std::size_t step,
             std::span<const SurfaceBlock> blocks, std::span<const Sample> samples)
      : config_(config.steps[step]), rounds_(input, config, step, blocks, samples) {
    for (const OutlineBlock& block : rounds_.blocks()) size_ = std::max(size_, block.size);
  }

  [[nodiscard]] const OutlineRounds& rounds() const { return rounds_; }
  /// The gate beyond which nothing counts in the end, pixels.
  [[nodiscard]] double gate() const { return gate_; }

  /// Where the rounds end.
  [[nodiscard]] OutlineState run(std::span<const Sample> samples, const Eigen::VectorXd& start,
                                 std::span<const UnknownFrame> unknown, Diagnostics& diagnostics) {
    std::vector<Sample> few(samples.begin(), samples.end());
    for (const OutlineBlock& block : rounds_.blocks()) {
      few = with_fewer_points(few, block.of->pair.camera, kFewEdges);
    }
    const bool is_lost = std::any_of(unknown.begin(), unknown.end(),
                                     [](const UnknownFrame& frame) { return !frame.has_guess; });
    std::optional<OutlineState> best;
    if (!is_lost) best = coarse(few, start, 1.0);
    if (!best || on_robot(few, *best) < kLeastShare) {
      const std::unique_ptr<AnyProblem> problem = rounds_.problem_for({});
      bool is_found = false;
      for (const OutlineBlock& block : rounds_.blocks()) {
        for (const UnknownFrame& frame : unknown) {
          for (const Eigen::VectorXd& values : searched(block, frame, *problem, few, start)) {
            OutlineState end = coarse(few, values, 0.25);
            if (best && on_robot(few, end) <= on_robot(few, *best)) continue;
            best = std::move(end);
            is_found = true;
          }
        }
      }
      if (is_found) {
        diagnostics.notes.push_back("the pose of '" + unknown.front().name +
                                    "' was searched for: the outline of the robot in the masks "
                                    "gives it");
      }
    }
    if (!best) best = coarse(few, start, 1.0);
    return fine(samples, best->values);
  }

 private:
  /// Rounds with a narrowing gate.
  /// @param part  of the widest gate
  [[nodiscard]] OutlineState coarse(std::span<const Sample> few, const Eigen::VectorXd& values,
                                    double part) const {
    OutlineState state{.values = values};
    for (const double of_size : {1.4, 0.7, 0.35, 0.17, 0.1}) {
      const double gate = of_size * size_;
      if (of_size > 1.4 * part) continue;
      state = rounds_.run({.gate = gate, .huber = 0.2 * gate, .rounds = 6, .is_simple = true}, few,
                          state.values);
    }
    return state;
  }

  /// The least share of the edges of a block that are on the robot, and of its outline on the edges.
  [[nodiscard]] double on_robot(std::span<const Sample> few, const OutlineState& state) const {
    double least = 1.0;
    const auto hits = rounds_.associated(*rounds_.problem_for({}), few, state.values,
                                         2.0 * kOnOutline * size_, true);
    for (std::size_t b = 0; b < hits.size(); ++b) {
      const OutlineBlock& block = rounds_.blocks()[b];
      const std::string& camera = block.of->pair.camera;
      least = std::min({least, share_within(distances_of(hits[b], few, camera, true), block.near()),
                        share_within(distances_of(hits[b], few, camera, false), block.near())});
    }
    return least;
  }

  [[nodiscard]] OutlineState fine(std::span<const Sample> samples, const Eigen::VectorXd& values) {
    constexpr int kMost = 30;
    double scale = 0.0;  // pixels, the widest of the losses
    for (const BlockConfig& block : config_.error_blocks) {
      if (block.type != PointToOutline::kType || block.loss.type == "none") continue;
      scale = std::max(scale, block.loss.scale * block.sigma.value_or(1.0));
    }
    if (scale > 0.0) {
      gate_ = kLossScales * scale;
      return rounds_.run({.gate = gate_, .rounds = kMost}, samples, values);
    }
    gate_ = 0.1 * size_;
    OutlineState state{.values = values};
    for (int round = 0; round < 8; ++round) {
      state = rounds_.run({.gate = gate_, .rounds = 4}, samples, state.values);
      std::vector<double> near;
      for (const OutlineHits& of_block : state.hits) {
        for (const auto& of_sample : of_block) {
          for (const OutlineHit& hit : of_sample) {
            if (hit.distance <= gate_) near.push_back(hit.distance);
          }
        }
      }
      if (near.empty()) break;
      constexpr double kRobust = 4.0 * 1.4826;
      const double next = std::clamp(kRobust * median_of(std::move(near)), kNarrowestGate, gate_);
      const bool is_settled = next > 0.99 * gate_;
      gate_ = next;
      if (is_settled) break;
    }
    return rounds_.run({.gate = gate_, .rounds = kMost}, samples, state.values);
  }

  const StepConfig& config_;
  OutlineRounds rounds_;
  double gate_ = 0.0;
  double size_ = 0.0;  ///< of the largest masks, pixels
};

/// Names links whose outline is off in most samples where it is seen.
[[nodiscard]] std::string links_off(const SurfaceBlock& block, const OutlineHits& hits,
                                    std::span<const Sample> samples, double within) {
  constexpr std::size_t kFewest = 50;
  constexpr double kOften = 0.6;
  std::vector<std::vector<double>> of_links(block.surface.links().size());
  for (std::size_t s = 0; s < hits.size(); ++s) {
    const Observation* seen = samples[s].observation(block.pair.camera);
    for (std::size_t i = seen == nullptr ? 0 : seen->features.size(); i < hits[s].size(); ++i) {
      of_links[static_cast<std::size_t>(hits[s][i].on.link)].push_back(hits[s][i].distance);
    }
  }
  std::string text;
  for (std::size_t l = 0; l < of_links.size(); ++l) {
    if (of_links[l].size() < kFewest || share_within(of_links[l], within) > kOften) continue;
    const double median = median_of(of_links[l]);
    text += fmt::format("{} link '{}' ({:.0f} % of its outline within {:.3g} px, {})",
                        text.empty() ? "; off in most masks:" : ",", block.surface.links()[l].name,
                        100.0 * share_within(of_links[l], within), within,
                        std::isfinite(median) ? fmt::format("median {:.1f} px", median)
                                              : std::string("most of it has no edge near"));
  }
  return text.empty() ? text : text + ": covered, or not as its mesh";
}

/// Says how the masks lie on the robot; an error if they do not.
void report_fit(const OutlineBlock& of_masks, const BlockConfig& of, double gate,
                const OutlineHits& hits, std::span<const Sample> samples,
                Diagnostics& diagnostics) {
  const SurfaceBlock& block = *of_masks.of;
  const double near = of_masks.near();
  const std::vector<double> edges = distances_of(hits, samples, block.pair.camera, true),
                            outline = distances_of(hits, samples, block.pair.camera, false);
  if (edges.empty()) return;  // assemble() says so
  const double on_edges = share_within(edges, near), on_outline = share_within(outline, near);
  const std::string masks =
      fmt::format("{} of masks of sensor '{}' in {}", counted(edges.size(), "edge"),
                  block.pair.camera, counted(samples.size(), "sample"));
  if (on_edges < kLeastShare || on_outline < kLeastShare) {
    diagnostics.error(
        of.place,
        fmt::format(
            "error block '{}': the masks do not show the robot.  Of {}, {:.0f} % are within "
            "{:.3g} px of its outline after the best fit, and {:.0f} % of its outline within "
            "{:.3g} px of them.  Are these masks of this robot (255: robot), of this camera, "
            "with the joints of the same images?  If the camera's pose is far off, leave its "
            "initial values out: then it is searched for",
            of.name, masks, 100.0 * on_edges, near, 100.0 * on_outline, near));
    return;
  }
  const LossType type = loss_type(of.loss.type);
  double cost = 0.0;
  for (const auto* all : {&edges, &outline}) {
    for (const double d : *all) {
      cost += 0.5 *
              Loss{type, of.loss.scale}(std::pow(std::min(d, 1e3) / of.sigma.value_or(1.0), 2)).rho;
    }
  }
  std::string text = fmt::format(
      "error block '{}': {}: {:.1f} % are within {:.3g} px of the robot's outline, median {:.3f} "
      "px; "
      "{:.1f} % of the outline within {:.3g} px of an edge, median {:.3f} px; what is within "
      "{:.4g} "
      "px counts",
      of.name, masks, 100.0 * on_edges, near, median_of(edges), 100.0 * on_outline, near,
      median_of(outline), gate);
  if (type != LossType::none) text += fmt::format(", cost {:.1f}", cost);
  diagnostics.note(of.place, text + links_off(block, hits, samples, near));
}

/// Gives a block whose loss is in pixels the noise that its edges show, and the same loss in sigmas.
void keep_loss(const OutlineHits& hits, double gate, BlockConfig& block) {
  if (block.loss.type == "none" || block.sigma) return;
  std::vector<double> near;
  for (const auto& of_sample : hits) {
    for (const OutlineHit& hit : of_sample) {
      if (hit.distance <= gate) near.push_back(hit.distance);
    }
  }
  if (near.empty()) return;
  constexpr double kOfMedian = 1.4826;
  block.sigma = std::max(1e-3, kOfMedian * median_of(std::move(near)));
  block.loss.scale /= *block.sigma;
}

}  // namespace
}  // namespace detail

void match_outlines(const SurfaceInput& input, Config& config, std::size_t step,
                    std::span<const SurfaceBlock> blocks, std::vector<Sample>& samples,
                    Eigen::VectorXd& values, std::span<const UnknownFrame> unknown,
                    Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.errors.size();
  detail::OutlineFit fit(input, config, step, blocks, samples);
  const std::vector<Sample> heard = heard_samples(samples, input.exclude);
  values = fit.run(heard, values, unknown, diagnostics).values;
  const std::vector<OutlineHits> hits =
      fit.rounds().associated(*fit.rounds().problem_for({}), samples, values, 1e3, false);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    detail::report_fit(fit.rounds().blocks()[b], block_of(config.steps[step], blocks[b].name),
                       fit.gate(), hits[b], samples, diagnostics);
  }
  if (diagnostics.errors.size() > before) return;
  samples = fit.rounds().matched(samples, hits, fit.gate());
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const auto block =
        std::find_if(config.steps[step].error_blocks.begin(), config.steps[step].error_blocks.end(),
                     [&](const BlockConfig& one) { return one.name == blocks[b].name; });
    detail::keep_loss(hits[b], fit.gate(), *block);
  }
}

}  // namespace kinecal
