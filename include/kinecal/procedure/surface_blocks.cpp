// Definitions of surface_blocks.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/procedure/surface_blocks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "kinecal/errors/point_to_outline.hpp"
#include "kinecal/files/urdf/visuals.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/sensors/depth/depth_camera.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

namespace detail {
namespace {

template <class Step>
[[nodiscard]] auto& find_block(Step& step, const std::string& name) {
  return *std::find_if(step.error_blocks.begin(), step.error_blocks.end(),
                       [&](const BlockConfig& block) { return block.name == name; });
}

/// Reads the surfaces that the blocks of a configuration need, and names their links in it.
class SurfaceResolver {
 public:
  SurfaceResolver(const SurfaceInput& input, Config& config, Diagnostics& diagnostics)
      : input_(input), config_(config), diagnostics_(diagnostics) {}

  /// The blocks of each step.
  [[nodiscard]] std::vector<std::vector<SurfaceBlock>> read() {
    std::vector<std::vector<SurfaceBlock>> all;
    for (StepConfig& step : config_.steps) {
      std::vector<SurfaceBlock>& blocks = all.emplace_back();
      for (BlockConfig& block : step.error_blocks) {
        if (block.surface) blocks.push_back(resolved(step, block));
      }
    }
    return all;
  }

 private:
  [[nodiscard]] SurfaceBlock resolved(StepConfig& step, BlockConfig& block) {
    SurfaceConfig& of = *block.surface;
    const bool is_outline = block.type == PointToOutline::kType;
    const std::size_t camera = is_outline ? 1 : 0;
    SurfaceBlock resolved{
        block.name, {block.models.at(camera), block.models.at(1 - camera)}, {}, true, is_outline};
    const auto model = [&](const std::string& name) -> ModelConfig& {
      return *std::find_if(step.models.begin(), step.models.end(),
                           [&](const ModelConfig& one) { return one.name == name; });
    };
    resolved.is_view = is_outline || model(resolved.pair.camera).type == DepthCamera::kType;
    if (!are_links(block, of.links)) return resolved;
    const std::pair key(of.geometry, of.links);
    if (const auto known = surfaces_.find(key); known != surfaces_.end()) {
      resolved.surface = known->second;
    } else {
      resolved.surface = read_surface(input_.urdf_text,
                                      {input_.urdf, mesh_places(input_.urdf, input_.mesh_paths),
                                       of.geometry == "visual"      ? SurfaceGeometry::visual
                                       : of.geometry == "collision" ? SurfaceGeometry::collision
                                                                    : SurfaceGeometry::automatic,
                                       of.links, block.place},
                                      diagnostics_);
      surfaces_.emplace(key, resolved.surface);
    }
    if (of.links.empty()) {
      resolved.surface = without_camera(std::move(resolved.surface), step, block,
                                        model(resolved.pair.camera).frame);
    }
    if (!of.links.empty()) {
      Diagnostics ignored;
      std::set<std::string> all, with_shapes;
      for (const Visual& visual : visuals(input_.urdf_text, input_.urdf, ignored)) {
        (visual.shape == VisualShape::mesh ? all : with_shapes).insert(visual.link);
      }
      if (all.empty()) all = std::move(with_shapes);
      resolved.is_whole = all.size() <= resolved.surface.links().size();
    }
    std::vector<std::string> links;
    for (const SurfaceLink& link : resolved.surface.links()) links.push_back(link.name);
    model(resolved.pair.robot).links = links;
    return resolved;
  }

  /// False, with errors, if some link does not exist.
  [[nodiscard]] bool are_links(const BlockConfig& block, const std::vector<std::string>& links) {
    const std::size_t before = diagnostics_.errors.size();
    for (const std::string& link : links) {
      if (input_.robot.has_link(link)) continue;
      diagnostics_.error(block.place, fmt::format("error block '{}': no link '{}' in robot '{}'{}",
                                                  block.name, link, input_.robot.name(),
                                                  did_you_mean(link, input_.robot.link_names())));
    }
    return diagnostics_.errors.size() == before;
  }

  /// Leaves out what the camera is fixed to: it sees past that, and its pose there is not measured by it.
  [[nodiscard]] RobotSurface without_camera(RobotSurface surface, const StepConfig& step,
                                            const BlockConfig& block, const std::string& frame) {
    std::vector<SurfaceLink> others;
    std::vector<std::string> left_out;
    const std::string rig = carrier(step, frame);
    for (const SurfaceLink& link : surface.links()) {
      const bool is_carrier = carrier(step, link.name) == rig;
      if (is_carrier) left_out.push_back(link.name);
      if (!is_carrier) others.push_back(link);
    }
    if (!left_out.empty()) {
      diagnostics_.note(
          block.place, fmt::format("error block '{}' leaves out the links that the camera is fixed "
                                   "to: {}; list them under 'links' to use them",
                                   block.name, fmt::join(left_out, ", ")));
    }
    return RobotSurface(std::move(others));
  }

  /// The first link up to which a link is fixed by joints that nothing moves or corrects.
  [[nodiscard]] std::string carrier(const StepConfig& step, std::string link) const {
    while (input_.robot.has_link(link)) {
      const Joint* joint = input_.robot.parent_joint(link);
      if (joint == nullptr || joint->type != JointType::fixed) break;
      const auto frees = [&](const FreeFrameConfig& frame) { return frame.name == joint->name; };
      if (std::any_of(step.free_frames.begin(), step.free_frames.end(), frees)) break;
      link = joint->parent;
    }
    return link;
  }

  const SurfaceInput& input_;
  Config& config_;
  Diagnostics& diagnostics_;
  std::map<std::pair<std::string, std::vector<std::string>>, RobotSurface> surfaces_;
};

}  // namespace
}  // namespace detail

std::vector<std::vector<SurfaceBlock>> read_surface_blocks(const SurfaceInput& input,
                                                           Config& config,
                                                           Diagnostics& diagnostics) {
  return detail::SurfaceResolver(input, config, diagnostics).read();
}

bool are_whole(const std::vector<std::vector<SurfaceBlock>>& blocks) {
  return std::ranges::all_of(blocks, [](const std::vector<SurfaceBlock>& of_step) {
    return std::ranges::all_of(of_step, &SurfaceBlock::is_whole);
  });
}

const BlockConfig& block_of(const StepConfig& step, const std::string& name) {
  return detail::find_block(step, name);
}

BlockConfig& block_of(StepConfig& step, const std::string& name) {
  return detail::find_block(step, name);
}

std::vector<Sample> heard_samples(std::span<const Sample> samples,
                                  const std::vector<int>& exclude) {
  const std::set<int> numbers(exclude.begin(), exclude.end());
  std::vector<Sample> others;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!numbers.contains(static_cast<int>(i) + 1)) others.push_back(samples[i]);
  }
  return others;
}

SearchedFrame::SearchedFrame(const UnknownFrame& frame, const AnyProblem& problem,
                             const std::string& camera)
    : frame_(frame), problem_(problem) {
  for (std::size_t s = 0; s < problem.sensors().size(); ++s) {
    if (problem.sensors()[s].mount().name == camera) camera_ = static_cast<int>(s);
  }
  const RuntimeChain& chain = this->camera().chains().front().chain();
  const auto joint =
      std::find_if(chain.joints.begin(), chain.joints.end(), [&](const ChainJoint& one) {
        return one.name == frame.name && one.corrected && !one.reversed;
      });
  const bool turns =
      std::all_of(frame.axes.begin(), frame.axes.end(), [](int p) { return p >= 0; });
  if (joint == chain.joints.end() || !turns) return;
  RuntimeChain up_to = chain;
  up_to.joints.assign(chain.joints.begin(), joint + 1);
  up_to.tail = {};
  before_.emplace(problem.robot(), std::move(up_to), problem.table());
}

const MountedSensor& SearchedFrame::camera() const {
  return problem_.sensors()[static_cast<std::size_t>(camera_)];
}

Eigen::VectorXd SearchedFrame::zeroed(Eigen::VectorXd values) const {
  for (const int p : frame_.axes) values[p] = 0.0;
  return values;
}

Eigen::VectorXd SearchedFrame::with(const Pose<double>& pose, Eigen::VectorXd values) const {
  const Vector3<double> turn = log(pose.rotation);
  for (std::size_t k = 0; k < 3; ++k) {
    values[frame_.axes[k]] = pose.translation[static_cast<Eigen::Index>(k)];
    values[frame_.axes[k + 3]] = turn[static_cast<Eigen::Index>(k)];
  }
  return values;
}

Pose<double> SearchedFrame::before(const Sample& sample, const Eigen::VectorXd& values) const {
  return before_->tip(sample, corrections_for(before_->parameters(), ParameterValues(values)));
}

std::vector<Pose<double>> SearchedFrame::links(const SurfaceBlock& block, const Sample& sample,
                                               const Eigen::VectorXd& values) const {
  const Pose<double> frame_T_base = before(sample, values).inverse();
  std::vector<Pose<double>> links = link_poses(block.surface, block.pair, problem_, values, sample);
  for (Pose<double>& link : links) link = frame_T_base * link;
  return links;
}

std::optional<std::string> look_alike(const UnknownFrame& frame, std::span<const SearchEnd> ends) {
  constexpr double kNearly = 1.15;                  // of the least cost
  constexpr double kTurned = 0.17, kShifted = 0.1;  // rad and metres: another pose
  const auto best = std::ranges::min_element(ends, {}, &SearchEnd::cost);
  if (best == ends.end()) return std::nullopt;
  const auto pose_of = [&](const SearchEnd& end) {
    const auto at = [&](std::size_t k) { return end.values[frame.axes[k]]; };
    return Pose<double>{exp(Vector3<double>(at(3), at(4), at(5))), {at(0), at(1), at(2)}};
  };
  const Pose<double> of_best = pose_of(*best);
  for (const SearchEnd& end : ends) {
    const Pose<double> pose = pose_of(end);
    const double turn = log(Matrix3<double>(of_best.rotation.transpose() * pose.rotation)).norm(),
                 shift = (pose.translation - of_best.translation).norm();
    if (!(end.cost < kNearly * best->cost) || (turn < kTurned && shift < kShifted)) continue;
    return fmt::format(
        "'{}' may stand elsewhere: turned by {:.0f} deg and shifted by {:.0f} mm, it fits nearly "
        "as "
        "well (cost {:.4g}, the best {:.4g}), because what is seen of the robot looks alike from "
        "both. "
        " Record poses in which other links are seen, or give its pose as initial values",
        frame.name, turn * 180.0 / std::numbers::pi, 1e3 * shift, end.cost, best->cost);
  }
  return std::nullopt;
}

}  // namespace kinecal
