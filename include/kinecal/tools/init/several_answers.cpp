// Definitions of several_answers.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/init/several_answers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/tools/init/answers_from_samples.hpp"
#include "kinecal/tools/init/possible_targets.hpp"
#include "kinecal/tools/init/robot_parts.hpp"

namespace kinecal {

namespace detail {
namespace {

/// @throws InputError  if a link occurs twice
void check_once(const std::vector<std::string>& links, const char* option) {
  std::set<std::string> before;
  for (const std::string& link : links) {
    if (!before.insert(link).second)
      throw InputError(fmt::format("{}: '{}' occurs twice", option, link));
  }
}

/// @throws InputError  if an arm or a camera is in no answer
void check_each_goes(const std::vector<InitAnswers>& all, const std::vector<std::string>& links,
                     std::string InitAnswers::*of, const char* option, const char* other) {
  for (const std::string& link : links) {
    const auto has_it = [&](const InitAnswers& answers) { return answers.*of == link; };
    if (link.empty() || std::any_of(all.begin(), all.end(), has_it)) continue;
    throw InputError(
        fmt::format("{}: '{}' moves with each {} that is given and sees the same in every pose; "
                    "give another one",
                    option, link, other));
  }
}

/// Samples with the observations of a camera and of a sensor whose points it sees, and those in which the camera observes
/// alone.
[[nodiscard]] std::vector<Sample> samples_of_pair(std::span<const Sample> samples,
                                                  const std::string& camera,
                                                  const std::string& chain) {
  std::vector<Sample> some;
  for (const Sample& sample : samples) {
    if (sample.observation(camera) == nullptr) continue;
    const bool is_alone = sample.observations.size() == 1;
    if (!is_alone && !chain.empty() && sample.observation(chain) == nullptr) continue;
    some.push_back(sample);
    std::erase_if(some.back().observations, [&](const Observation& seen) {
      return seen.sensor != camera && seen.sensor != chain;
    });
  }
  return some;
}

/// The cameras of samples, and the sensors that are none, in the order of their first observations.
struct NamedSensors {
  std::vector<std::string> cameras, chains;
};
[[nodiscard]] NamedSensors sensors_of_samples(std::span<const Sample> samples) {
  std::vector<std::string> names;
  std::set<std::string> cameras;
  for (const Sample& sample : samples) {
    for (const Observation& seen : sample.observations) {
      if (seen.features.empty()) continue;
      if (std::find(names.begin(), names.end(), seen.sensor) == names.end())
        names.push_back(seen.sensor);
      if (seen.camera) cameras.insert(seen.sensor);
    }
  }
  NamedSensors found;
  for (std::string& name : names)
    (cameras.contains(name) ? found.cameras : found.chains).push_back(std::move(name));
  return found;
}

/// @throws InputError  if a sensor holds a target and no link has its name, where those of others are links
void check_holders(const Robot& robot, const std::vector<std::string>& chains) {
  const auto link = std::find_if(chains.begin(), chains.end(),
                                 [&](const std::string& name) { return robot.has_link(name); });
  if (link == chains.end()) return;
  for (const std::string& name : chains) {
    if (robot.has_link(name) || name == "arm" || name == "board") continue;
    throw InputError(fmt::format(
        "--from: '{}' holds a target, as '{}' does, and is no link of the URDF of '{}'{}", name,
        *link, robot.name(), did_you_mean(name, robot.link_names())));
  }
}

/// @throws InputError  if two sensors hold targets whose points are in one frame
void check_frames_of(const std::vector<InitAnswers>& all) {
  std::map<std::string, std::string> holder;
  for (const InitAnswers& answers : all) {
    if (answers.target_frame.empty()) continue;
    const auto [known, is_new] = holder.emplace(answers.target_frame, holder_of(answers));
    if (is_new || known->second == holder_of(answers)) continue;
    throw InputError(
        fmt::format("--from: the points of '{}' and of '{}' are both in frame '{}', but are two "
                    "targets: record them with a "
                    "frame_id each",
                    known->second, holder_of(answers), answers.target_frame));
  }
}

/// Several arms that touch the same points or sockets.
/// @throws InputError  if the target is of one arm
[[nodiscard]] InitAnswers together(const Robot& robot, InitAnswers answers,
                                   const std::vector<std::string>& arms) {
  if (answers.target != InitTarget::point && answers.target != InitTarget::sockets) {
    throw InputError(fmt::format(
        "--arm: '{}' is of one arm; make a configuration for each.  What relates two arms: points "
        "or sockets that both touch (--target point, --target sockets), a thing that both hold "
        "(--target grip), or a cone in one hand for the tip of the other (--target point --arm {} "
        "--touched-link {})",
        to_string(answers.target, answers.board), arms[0], arms[1]));
  }
  answers.arm = answers.holder = arms.front();
  answers.target_frame.clear();
  const std::string tip = with_proposals(robot, answers).target_frame;
  answers.target_frame = arms.front() + "_" + tip;
  for (std::size_t i = 1; i < arms.size(); ++i)
    answers.more_arms.push_back({arms[i], arms[i] + "_" + tip});
  return answers;
}

}  // namespace
}  // namespace detail

std::vector<InitAnswers> answers_of_all(const Robot& robot, const InitAnswers& given,
                                        const std::vector<std::string>& arms,
                                        const std::vector<std::string>& cameras) {
  detail::check_once(arms, "--arm");
  detail::check_once(cameras, "--camera");
  if (arms.size() > 1 && is_touched(given.target)) {
    return {detail::together(robot, given, arms)};
  }
  const std::vector<std::string> none = {""};
  const auto &of_arms = arms.empty() ? none : arms, &of_cameras = cameras.empty() ? none : cameras;
  std::vector<InitAnswers> all;
  for (const std::string& arm : of_arms) {
    for (const std::string& camera : of_cameras) {
      InitAnswers answers = given;
      answers.arm = arm;
      answers.camera = camera;
      if (of_arms.size() * of_cameras.size() == 1) return {answers};
      if (!why_no_target(robot, given.target, arm, camera).empty()) continue;
      if (of_cameras.size() > 1) answers.camera_name = camera;
      if (of_arms.size() > 1) {
        answers.holder = arm;
        answers.target_frame.clear();
        if (needs_target_frame(given.target)) {
          answers.target_frame = arm + "_" + with_proposals(robot, answers).target_frame;
        }
      }
      all.push_back(std::move(answers));
    }
  }
  detail::check_each_goes(all, of_arms, &InitAnswers::arm, "--arm", "camera");
  detail::check_each_goes(all, of_cameras, &InitAnswers::camera, "--camera", "arm");
  const std::string base = with_proposals(robot, all.front()).base;
  for (InitAnswers& answers : all) {
    if (answers.base.empty()) answers.base = base;
  }
  return all;
}

std::vector<InitAnswers> all_answers_from_samples(const Robot& robot,
                                                  std::span<const Sample> samples,
                                                  const InitAnswers& given) {
  const detail::NamedSensors sensors = detail::sensors_of_samples(samples);
  const bool is_one = sensors.cameras.size() < 2 && sensors.chains.size() < 2;
  if (is_one || sensors.cameras.empty() || is_touched(given.target))
    return {answers_from_samples(robot, samples, given)};
  for (const auto& [option, value] :
       {std::pair("--arm", given.arm), std::pair("--camera", given.camera),
        std::pair("--target-frame", given.target_frame)}) {
    if (value.empty() || sensors.cameras.size() + sensors.chains.size() < 3) continue;
    throw InputError(
        fmt::format("{} is of one camera and what it sees, and the samples have more: name the "
                    "sensors that hold targets and "
                    "the frames of cameras as the links of the URDF are named",
                    option));
  }
  detail::check_holders(robot, sensors.chains);
  std::vector<InitAnswers> all;
  for (const std::string& camera : sensors.cameras) {
    const std::size_t before = all.size();
    for (const std::string& chain : sensors.chains) {
      const std::vector<Sample> seen = detail::samples_of_pair(samples, camera, chain);
      if (std::none_of(seen.begin(), seen.end(), [&](const Sample& sample) {
            return sample.observation(chain) != nullptr;
          })) {
        continue;
      }
      InitAnswers answers = given;
      if (robot.has_link(chain)) answers.arm = chain;
      all.push_back(answers_from_samples(robot, seen, answers));
    }
    if (all.size() > before) continue;
    all.push_back(answers_from_samples(robot, detail::samples_of_pair(samples, camera, ""), given));
  }
  detail::check_frames_of(all);
  for (InitAnswers& answers : all) {
    if (answers.base.empty()) answers.base = with_proposals(robot, all.front()).base;
  }
  return all;
}

void relate_stands(const Robot& robot, const std::vector<std::string>& stands,
                   std::vector<InitAnswers>& all) {
  if (stands.size() < 2) return;
  std::map<std::string, std::string> groups = {{"", ""}};  // of stands; "" is the world
  for (const std::string& stand : stands) groups[stand] = stand;
  for (InitAnswers& answers : all) {
    const auto group = [&](const std::string& link) {
      return groups.at(joint_above(robot, link.empty() ? answers.base : link, stands));
    };
    const std::string from = group(answers.arm), to = group(answers.camera);
    for (auto& [stand, of] : groups) {
      if (of == from) of = to;
    }
    answers.stands.assign(stands.begin() + 1, stands.end());
  }
  for (const std::string& stand : stands) {
    if (groups.at(stand) == groups.at(stands.front())) continue;
    throw InputError(fmt::format(
        "--urdf: nothing says where the robot on '{}' stands: no --camera and --arm, or board in "
        "the world, relates it to the others; let a camera of one robot see the arm of the other",
        stand));
  }
}

std::string pairs_text(const std::vector<InitAnswers>& all) {
  std::string text;
  for (const InitAnswers& answers : all) {
    const std::string seen = answers.target == InitTarget::ground  ? "the floor"
                             : answers.target == InitTarget::robot ? "the robot"
                             : needs_arm(answers.target)           ? answers.arm
                                                                   : "the board";
    text += text.empty() ? "" : "; ";
    text += needs_camera(answers.target) ? answers.camera + " sees " + seen : seen;
  }
  return text;
}

}  // namespace kinecal
