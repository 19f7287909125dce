// Definitions of outline_rounds.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/procedure/outline_rounds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "kinecal/config/loss_names.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/procedure/matched_step.hpp"
#include "kinecal/surface/mask_search.hpp"
#include "kinecal/surface/outline_match.hpp"
#include "kinecal/text/counted.hpp"

namespace kinecal {

namespace detail {
namespace {

constexpr double kNarrowestGate = 3.0;  ///< pixels, of a gate without a loss
constexpr double kOnOutline = 0.04;     ///< of the size of masks: an edge within is on the outline
constexpr double kLeastShare = 0.5;     ///< of edges on the outline, and of the outline on edges
constexpr int kFewEdges = 300;          ///< of a sample, in coarse rounds
constexpr std::size_t kSimpleTriangles = 600;  ///< of a link, in coarse rounds

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
  double tolerance = 1e-7;           ///< relative fall of the cost at which rounds end
  bool is_simple = false;            ///< with simple meshes
};

/// A state of the rounds.
struct OutlineState : MatchedSums {
  std::vector<OutlineHits> hits = {};  ///< by block
};

/// The rounds of one step.
class OutlineRounds {
 public:
  OutlineRounds(const MatchedStep& step, std::span<const SurfaceBlock> blocks,
                std::span<const Sample> samples)
      : step_(step), of_step_(blocks) {
    for (const SurfaceBlock& block : blocks) {
      blocks_.push_back({&block, Outliner(block.surface), Outliner(block.surface, kSimpleTriangles),
                         size_of_masks(samples, block.pair.camera)});
    }
  }

  [[nodiscard]] const std::vector<OutlineBlock>& blocks() const { return blocks_; }

  /// Goes downhill from values; returns the state in which it ended.
  [[nodiscard]] OutlineState run(const OutlineManner& manner, std::span<const Sample> samples,
                                 const Eigen::VectorXd& values) const {
    const std::unique_ptr<AnyProblem> problem = step_.problem(of_step_, manner.huber);
    const auto match = [&](Eigen::VectorXd at, const OutlineState&) {
      return evaluated(*problem, manner, samples, std::move(at));
    };
    OutlineState start = evaluated(*problem, manner, samples, values);
    return go_downhill(problem->table(), std::move(start), manner.rounds, manner.tolerance, match);
  }

  /// What belongs together in all samples.
  /// @param problem  of the step
  [[nodiscard]] std::vector<OutlineHits> associated(const AnyProblem& problem,
                                                    std::span<const Sample> samples,
                                                    const Eigen::VectorXd& values, double bound,
                                                    bool is_simple) const {
    std::vector<OutlineHits> hits;
    for (const OutlineBlock& block : blocks_) {
      hits.push_back(kinecal::match_outlines(is_simple ? block.simple : block.fine,
                                             block.of->surface, block.of->pair, problem, values,
                                             samples, bound, step_.input().threads));
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
    std::vector<OutlineHits> hits =
        associated(empty, samples, values, manner.gate, manner.is_simple);
    std::vector<BeyondGate> beyond;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      BeyondGate& of_block = beyond.emplace_back(BeyondGate{blocks_[b].of->name, 0, manner.gate});
      for (const OutlineMatch& of_sample : hits[b]) {
        of_sample.for_each([&](const OutlineHit& hit) { of_block.count += hit.edge < 0 ? 1 : 0; });
      }
    }
    const std::vector<Sample> with_points = matched(samples, hits, manner.gate);
    return {step_.sums(empty, with_points, std::move(values), beyond), std::move(hits)};
  }

  const MatchedStep& step_;
  std::span<const SurfaceBlock> of_step_;
  std::vector<OutlineBlock> blocks_;
};

/// Distances in all samples; infinite where nothing is near.
/// @param which  of the edges of masks, or of the points of outlines
[[nodiscard]] std::vector<double> distances_of(const OutlineHits& hits,
                                               std::vector<OutlineHit> OutlineMatch::*which) {
  std::vector<double> distances;
  for (const OutlineMatch& of_sample : hits) {
    for (const OutlineHit& hit : of_sample.*which) distances.push_back(hit.distance);
  }
  return distances;
}

/// The same of both.
[[nodiscard]] std::vector<double> distances_of(const OutlineHits& hits) {
  std::vector<double> distances;
  for (const OutlineMatch& of_sample : hits) {
    of_sample.for_each([&](const OutlineHit& hit) { distances.push_back(hit.distance); });
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
  const std::vector<double> own = camera.own_values(zero);
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
                     chain.tip(sample, corrections_for(chain.parameters(), ParameterValues(zero)));
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
  OutlineFit(const MatchedStep& step, std::span<const SurfaceBlock> blocks,
             std::span<const Sample> samples)
      : step_(step), of_step_(blocks), rounds_(step, blocks, samples) {
    for (const OutlineBlock& block : rounds_.blocks()) size_ = std::max(size_, block.size);
  }

  [[nodiscard]] const OutlineRounds& rounds() const { return rounds_; }
  /// The gate beyond which nothing counts in the end, pixels.
  [[nodiscard]] double gate() const { return gate_; }
  /// What look_alike() says of a search.
  [[nodiscard]] const std::optional<std::string>& alike() const { return alike_; }

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
      const std::unique_ptr<AnyProblem> problem = step_.problem();
      bool is_found = false;
      for (const OutlineBlock& block : rounds_.blocks()) {
        for (const UnknownFrame& frame : unknown) {
          std::vector<SearchEnd> ends;
          for (const Eigen::VectorXd& values : searched(block, frame, *problem, few, start)) {
            OutlineState end = coarse(few, values, 0.25);
            ends.push_back({end.values, end.cost});
            if (best && on_robot(few, end) <= on_robot(few, *best)) continue;
            best = std::move(end);
            is_found = true;
          }
          alike_ = look_alike(frame, ends);
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

  /// The gate where nothing moves the robot: that which rounds have found before, or the one that goes with the distances.
  void hold(std::span<const Sample> samples, const Eigen::VectorXd& values,
            const std::optional<double>& found) {
    OutlineState state{{.values = values}, {}};
    if (found) {
      gate_ = *found;
    } else {
      set_gate(samples, 0, state);
    }
  }

 private:
  /// Rounds with a narrowing gate.
  /// @param part  of the widest gate
  [[nodiscard]] OutlineState coarse(std::span<const Sample> few, const Eigen::VectorXd& values,
                                    double part) const {
    OutlineState state{{.values = values}, {}};
    for (const double of_size : {1.4, 0.7, 0.35, 0.17, 0.1}) {
      const double gate = of_size * size_;
      if (of_size > 1.4 * part) continue;
      state = rounds_.run(
          {.gate = gate, .huber = 0.2 * gate, .rounds = 6, .tolerance = 1e-2, .is_simple = true},
          few, state.values);
    }
    return state;
  }

  /// The least share of the edges of a block that are on the robot, and of its outline on the edges.
  [[nodiscard]] double on_robot(std::span<const Sample> few, const OutlineState& state) const {
    double least = 1.0;
    const auto hits =
        rounds_.associated(*step_.problem(), few, state.values, 2.0 * kOnOutline * size_, true);
    for (std::size_t b = 0; b < hits.size(); ++b) {
      const double near = rounds_.blocks()[b].near();
      for (const auto which : {&OutlineMatch::edges, &OutlineMatch::outline}) {
        least = std::min(least, share_within(distances_of(hits[b], which), near));
      }
    }
    return least;
  }

  /// Sets the gate: that of the losses; else it narrows with the distances.
  /// @param rounds  with each gate, at most
  /// @param state   in: values
  void set_gate(std::span<const Sample> samples, int rounds, OutlineState& state) {
    const std::optional<double> of_losses = step_.gate_of_losses(of_step_);
    gate_ = of_losses.value_or(0.1 * size_);
    if (of_losses) return;
    narrow(
        gate_, kNarrowestGate, rounds, state,
        [&](double gate, const Eigen::VectorXd& from, int most) {
          return rounds_.run({.gate = gate, .rounds = most}, samples, from);
        },
        [](const OutlineState& at) {
          std::vector<double> distances;
          for (const OutlineHits& of_block : at.hits) {
            const std::vector<double> more = distances_of(of_block);
            distances.insert(distances.end(), more.begin(), more.end());
          }
          return distances;
        });
  }

  [[nodiscard]] OutlineState fine(std::span<const Sample> samples, const Eigen::VectorXd& values) {
    constexpr int kMost = 30;
    OutlineState state{{.values = values}, {}};
    set_gate(samples, kGateRounds, state);
    return rounds_.run({.gate = gate_, .rounds = kMost}, samples, state.values);
  }

  const MatchedStep& step_;
  std::span<const SurfaceBlock> of_step_;
  OutlineRounds rounds_;
  double gate_ = 0.0;
  double size_ = 0.0;  ///< of the largest masks, pixels
  std::optional<std::string> alike_;
};

/// Distances of the outline of each link in all samples.
[[nodiscard]] std::vector<std::vector<double>> distances_of_links(const OutlineHits& hits,
                                                                  std::size_t links) {
  std::vector<std::vector<double>> of_links(links);
  for (const OutlineMatch& of_sample : hits) {
    for (const OutlineHit& hit : of_sample.outline) {
      of_links[static_cast<std::size_t>(hit.on.link)].push_back(hit.distance);
    }
  }
  return of_links;
}

/// Names links whose outline is off in most samples where it is seen.
[[nodiscard]] std::string links_off(const SurfaceBlock& block, const OutlineHits& hits,
                                    double within) {
  constexpr std::size_t kFewest = 50;
  constexpr double kOften = 0.6;
  const std::vector<std::vector<double>> of_links =
      distances_of_links(hits, block.surface.links().size());
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

/// True for each link of a surface that moves before its camera from sample to sample.
[[nodiscard]] std::vector<bool> moving_links(const SurfaceBlock& block, const AnyProblem& problem,
                                             std::span<const Sample> samples,
                                             const Eigen::VectorXd& values) {
  constexpr double kTurn = 0.02, kShift = 5e-3;  // rad, metres
  const auto camera = std::ranges::find_if(problem.sensors(), [&](const MountedSensor& one) {
    return one.mount().name == block.pair.camera;
  });
  const SampledChain& chain = camera->chains().front();
  const Corrections<double> corrections =
      corrections_for(chain.parameters(), ParameterValues(values));
  std::vector<bool> moves(block.surface.links().size(), false);
  std::vector<Pose<double>> first;
  for (const Sample& sample : samples) {
    if (sample.observation(block.pair.camera) == nullptr) continue;
    const Pose<double> camera_T_base = chain.tip(sample, corrections).inverse();
    std::vector<Pose<double>> links =
        link_poses(block.surface, block.pair, problem, values, sample);
    for (Pose<double>& link : links) link = camera_T_base * link;
    if (first.empty()) first = links;
    for (std::size_t l = 0; l < links.size(); ++l) {
      const Pose<double> apart = first[l].inverse() * links[l];
      if (log(apart.rotation).norm() > kTurn || apart.translation.norm() > kShift) moves[l] = true;
    }
  }
  return moves;
}

/// The share of the outline of links that move which has an edge near, in the mean of the links: a base may look right
/// while the arm does not.
[[nodiscard]] double share_of_moving(const OutlineHits& hits, const std::vector<bool>& moves,
                                     double within) {
  constexpr std::size_t kFewest = 50;
  const std::vector<std::vector<double>> of_links = distances_of_links(hits, moves.size());
  double sum = 0.0;
  int count = 0;
  for (std::size_t l = 0; l < moves.size(); ++l) {
    if (!moves[l] || of_links[l].size() < kFewest) continue;
    sum += share_within(of_links[l], within);
    ++count;
  }
  return count == 0 ? 1.0 : sum / count;
}

/// Says how the masks lie on the robot; an error if they do not, or a doubt if nothing was fitted.
/// @param moves  see moving_links()
void report_fit(const OutlineBlock& of_masks, const BlockConfig& of, double gate,
                const OutlineHits& hits, const std::vector<bool>& moves, bool is_fitted,
                Diagnostics& diagnostics) {
  const SurfaceBlock& block = *of_masks.of;
  const double near = of_masks.near();
  const std::vector<double> edges = distances_of(hits, &OutlineMatch::edges),
                            outline = distances_of(hits, &OutlineMatch::outline);
  if (edges.empty()) return;  // assemble() says so
  const double on_edges = share_within(edges, near), on_outline = share_within(outline, near);
  const std::string masks =
      fmt::format("{} of masks of sensor '{}' in {}", counted(edges.size(), "edge"),
                  block.pair.camera, counted(hits.size(), "sample"));
  const double on_moving = share_of_moving(hits, moves, near);
  if (on_edges < kLeastShare || on_outline < kLeastShare || on_moving < kLeastShare) {
    const std::string why = fmt::format(
        "error block '{}': the masks do not show the robot.  Of {}, {:.0f} % are within "
        "{:.3g} px of its outline {}, and {:.0f} % of its outline, {:.0f} % of that "
        "of links that move, within {:.3g} px of them.  Are these masks of this robot (255: "
        "robot), of this camera, with the joints of the same images?{}",
        of.name, masks, 100.0 * on_edges, near,
        is_fitted ? "after the best fit" : "where the result puts it", 100.0 * on_outline,
        100.0 * on_moving, near,
        is_fitted ? "  If the camera's pose is far off, leave its initial values out: then it is "
                    "searched for"
                  : "");
    is_fitted ? diagnostics.error(of.place, why) : diagnostics.doubt(of.place, why);
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
  diagnostics.note(of.place, text + links_off(block, hits, near));
}

}  // namespace
}  // namespace detail

void match_outlines(const SurfaceInput& input, Config& config, std::size_t number,
                    std::span<const SurfaceBlock> blocks, bool is_held,
                    std::vector<Sample>& samples, Eigen::VectorXd& values,
                    std::span<const UnknownFrame> unknown, Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.errors.size();
  StepConfig& of_step = config.steps[number];
  const MatchedStep step(input, config, number);
  detail::OutlineFit fit(step, blocks, samples);
  const std::vector<Sample> heard = heard_samples(samples, input.exclude);
  if (is_held) {
    fit.hold(heard, values, block_of(of_step, blocks.front().name).surface->gate);
  } else {
    values = fit.run(heard, values, unknown, diagnostics).values;
  }
  constexpr double kFar = 1e3;  // pixels
  const std::unique_ptr<AnyProblem> problem = step.problem();
  const std::vector<OutlineHits> hits =
      fit.rounds().associated(*problem, samples, values, kFar, false);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    detail::report_fit(fit.rounds().blocks()[b], block_of(of_step, blocks[b].name), fit.gate(),
                       hits[b], detail::moving_links(blocks[b], *problem, samples, values),
                       !is_held, diagnostics);
  }
  if (diagnostics.errors.size() > before) return;
  if (fit.alike()) diagnostics.doubt(of_step.place, *fit.alike());
  samples = fit.rounds().matched(samples, hits, fit.gate());
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    constexpr double kLeast = 1e-3;  // pixels
    BlockConfig& of = block_of(of_step, blocks[b].name);
    of.surface->gate = fit.gate();
    keep_loss(of, detail::distances_of(hits[b]), fit.gate(), kLeast);
  }
}

}  // namespace kinecal
