// kinecal compare: what differs between two results.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "commands.hpp"
#include "kinecal/config/assemble.hpp"
#include "kinecal/config/doubts/rising.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/files/json/json_text.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/report/charts/parameters.hpp"
#include "kinecal/report/html.hpp"
#include "kinecal/report/text.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/tools/install/stored_result.hpp"
#include "kinecal/trust/verify/pose_change.hpp"
#include "output_file.hpp"
#include "report.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

constexpr double kMoved = 3.0;  // standard deviations of the difference

/// A parameter of both results.
struct Difference {
  std::string name, unit;
  double a = 0.0, b = 0.0;
  double deviation = 0.0;  ///< of the difference

  [[nodiscard]] double times() const { return std::abs(b - a) / deviation; }
};

/// A parameter that cannot be compared.
struct NotCompared {
  std::string name, why;
};

struct Comparison {
  std::vector<Difference> moved, equal;
  std::vector<NotCompared> others;
  std::optional<PoseInQuestion> pose;  ///< that of the first result
  double position_b = 0.0;             ///< standard deviation in the second one
  PoseChange change;
};

/// A result with its problem, without samples.
struct Assembled {
  StoredResult result;
  Calibration calibration;
  std::vector<double> values;
  std::map<std::string, double> rising;

  explicit Assembled(const std::string& folder) : result(read_result(folder)) {
    Diagnostics diagnostics;
    calibration = assemble(result.config, result.robot, {}, diagnostics);
    diagnostics.throw_if_errors();
    (void)result.state(problem().table());  // the configuration has all parameters
    values = result.values_of(problem().table());
    rising = rising_of(result.urdf_text, result.urdf);
  }
  [[nodiscard]] const AnyProblem& problem() const { return *calibration.steps.back().problem; }
  /// The joint, frame or sensor of a parameter.
  [[nodiscard]] const std::string& owner(const std::string& parameter) const {
    return problem().owners()[static_cast<std::size_t>(problem().table().index(parameter))];
  }
  [[nodiscard]] double rising_of_joint(const std::string& joint) const {
    const auto found = rising.find(joint);
    return found == rising.end() ? 0.0 : found->second;
  }
};

void check_same_robot(const Assembled& a, const Assembled& b) {
  const auto names = [](const Robot& robot) {
    std::vector<std::string> all;
    for (const Joint& joint : robot.joints()) all.push_back(joint.name);
    std::sort(all.begin(), all.end());
    return all;
  };
  if (names(a.result.robot) == names(b.result.robot)) return;
  throw InputError(
      fmt::format("{} is of robot '{}' and {} of robot '{}', whose joints differ; compare "
                  "two results of one robot",
                  a.result.folder, a.result.robot.name(), b.result.folder, b.result.robot.name()));
}

/// The lens of the camera that has a parameter; empty if it is of no camera.
std::string lens_of_parameter(const Assembled& of, const std::string& name) {
  for (const ModelConfig& model : detail::models_of(of.result.config)) {
    const SensorEntry* entry = entry_of(model);
    const bool has_lens = entry != nullptr && !entry->lenses.empty();
    if (has_lens && of.owner(name) == model.param_name) return model.lens;
  }
  return "";
}

/// Cameras alone begin where their photographs say, so their parameters are compared as camera files have them.
std::string why_not_cameras(const Assembled& a, const Assembled& b, const std::string& name) {
  if (a.result.config.per_sample.empty() && b.result.config.per_sample.empty()) return "";
  const std::string of_a = lens_of_parameter(a, name), of_b = lens_of_parameter(b, name);
  if (of_a.empty() && of_b.empty()) return "";
  if (of_a != of_b) return fmt::format("is of lens {} in one, {} in the other", of_a, of_b);
  const bool are_known =
      a.result.camera_numbers.contains(name) && b.result.camera_numbers.contains(name);
  return are_known ? "" : "begins at other intrinsics; compare the camera files";
}

/// Why the numbers of a parameter do not mean the same in both; empty if they do.
std::string why_not(const Assembled& a, const Assembled& b, const std::string& name) {
  for (const Assembled* one : {&a, &b}) {
    const auto deviation = one->result.deviations.find(name);
    if (deviation == one->result.deviations.end())
      return "is not calibrated in " + one->result.folder;
    if (!std::isfinite(deviation->second)) {
      return "is not determined in " + one->result.folder + ", or at its bound";
    }
  }
  if (const std::string why = why_not_cameras(a, b, name); !why.empty()) return why;
  if (a.result.urdf_text == b.result.urdf_text) return "";
  const std::string& owner = a.owner(name);
  if (a.result.robot.has_joint(owner)) {
    const Pose<double>&of_a = a.result.robot.joint(owner).origin,
          &of_b = b.result.robot.joint(owner).origin;
    constexpr double kSame = 1e-12;
    const bool same = (of_a.translation - of_b.translation).norm() < kSame &&
                      (of_a.rotation - of_b.rotation).norm() < kSame;
    return same ? "" : "begins at another origin of joint '" + owner + "': the URDFs differ";
  }
  const bool is_frame = a.problem().frames().contains(owner);
  return is_frame ? "" : "may begin at other settings: the URDFs differ";
}

bool is_intrinsic(const std::string& name) {
  return name.ends_with("_fx") || name.ends_with("_fy") || name.ends_with("_cx") ||
         name.ends_with("_cy");
}

Comparison compared(const Assembled& a, const Assembled& b) {
  Comparison all;
  const auto add = [&](const Difference& difference) {
    (difference.times() > kMoved ? all.moved : all.equal).push_back(difference);
  };
  std::vector<std::string> names;
  for (const Assembled* one : {&a, &b}) {
    for (const auto& [name, deviation] : one->result.deviations) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  for (const std::string& name : names) {
    if (const std::string why = why_not(a, b, name); !why.empty()) {
      all.others.push_back({name, why});
      continue;
    }
    if (!a.result.config.per_sample.empty() && a.result.camera_numbers.contains(name)) {
      const StoredNumber &of_a = a.result.camera_numbers.at(name),
                         &of_b = b.result.camera_numbers.at(name);
      add({name, is_intrinsic(name) ? "px" : "1", of_a.value, of_b.value,
           std::hypot(of_a.deviation, of_b.deviation)});
      continue;
    }
    const bool is_offset = a.owner(name) == name;
    const auto value = [&](const Assembled& of) {
      return of.result.values.at(name) + (is_offset ? of.rising_of_joint(name) : 0.0);
    };
    add({name, a.result.units.at(name), value(a), value(b),
         std::hypot(a.result.deviations.at(name), b.result.deviations.at(name))});
  }
  std::stable_sort(all.moved.begin(), all.moved.end(),
                   [](const auto& x, const auto& y) { return x.times() > y.times(); });
  return all;
}

/// The pose in question of the first result, at its poses.  Encoders read the same in both.
void compare_poses(const Assembled& a, const Assembled& b, Comparison& all) {
  all.pose = a.result.pose;
  if (!all.pose) return;
  if (b.result.pose) all.position_b = b.result.pose->position;
  const auto known = [](const Assembled& one, const FrameOnRobot& frame) {
    return one.result.robot.has_link(frame.link) &&
           (frame.frame.empty() || one.problem().frames().contains(frame.frame));
  };
  if (!known(b, all.pose->frame) || !known(b, all.pose->in)) return all.pose.reset();
  std::map<std::string, double> to_b = b.rising;
  for (const auto& [joint, rising] : a.rising) to_b[joint] -= rising;
  // Both at the readings of a; in b they are larger by the difference of <calibration rising>.
  std::vector<double> values = b.values;
  const ParameterTable& table = b.problem().table();
  std::vector<Sample> samples = a.result.pose_samples();
  for (const auto& [joint, rising] : to_b) {
    if (const int index = table.find(joint); index >= 0) {
      values[static_cast<std::size_t>(index)] += rising;
    } else if (rising != 0.0) {
      return all.pose.reset();  // without a parameter for it, the joint cannot be moved
    }
  }
  all.change = pose_change({a.problem(), a.values}, {b.problem(), values}, samples, all.pose->frame,
                           all.pose->in);
}

/// How the judged pose moved; empty if it is not known.
std::string pose_text(const Assembled& a, const Comparison& all) {
  if (!all.pose || all.change.poses <= 0) return "";
  const std::string first = reading(all.pose->position, "m"), second = reading(all.position_b, "m");
  return fmt::format(
      "'{}' in '{}' moved by {} and {}, {} at the worst of {} of {}; +- {}\n",
      all.pose->frame.name(), all.pose->in.name(), reading(all.change.position, "m"),
      reading(all.change.rotation, "rad"), reading(all.change.worst_position, "m"),
      counted(static_cast<std::size_t>(all.change.poses), "pose"), a.result.folder,
      first == second ? first + " in both" : first + " in the first, " + second + " in the second");
}

/// What was not compared, and why: a line each.
std::string others_text(const Comparison& all) {
  std::string text;
  for (const NotCompared& of : all.others) text += fmt::format("  {} {}\n", of.name, of.why);
  return text;
}

std::string text_of(const Assembled& a, const Assembled& b, const Comparison& all) {
  std::string text = fmt::format(
      "{} of {} moved by more than {} standard deviations of the difference\n", all.moved.size(),
      counted(all.moved.size() + all.equal.size(), "parameter"), kMoved);
  if (!all.moved.empty()) {
    TextTable table(
        {"parameter", a.result.folder, b.result.folder, "difference", "+-", "unit", "times"});
    for (const Difference& of : all.moved) {
      const auto shown = [&](double value) { return detail::for_people(value, of.unit).first; };
      table.add({of.name, shown(of.a), shown(of.b), shown(of.b - of.a), shown(of.deviation),
                 detail::for_people(0.0, of.unit).second, fmt::format("{:.1f}", of.times())});
    }
    text += table.str();
  }
  if (const std::string pose = pose_text(a, all); !pose.empty()) text += "\n" + pose;
  if (!all.others.empty()) text += "\nNot compared\n" + others_text(all);
  return text;
}

std::string json_of(const Assembled& a, const Assembled& b, const Comparison& all) {
  using detail::Json;
  Json parameters = Json::array(), others = Json::array(), pose;
  for (const auto* list : {&all.moved, &all.equal}) {
    for (const Difference& of : *list) {
      parameters.push_back({{"name", of.name},
                            {"unit", of.unit},
                            {"a", of.a},
                            {"b", of.b},
                            {"sigma", of.deviation},
                            {"moved", list == &all.moved}});
    }
  }
  for (const NotCompared& of : all.others) {
    others.push_back({{"name", of.name}, {"why", of.why}});
  }
  if (all.pose && all.change.poses > 0) {
    pose = {{"frame", all.pose->frame.name()},
            {"in", all.pose->in.name()},
            {"poses", all.change.poses},
            {"position", all.change.position},
            {"rotation", all.change.rotation},
            {"worst_position", all.change.worst_position},
            {"worst_rotation", all.change.worst_rotation}};
  }
  return detail::json_lines({{"a", a.result.folder},
                             {"b", b.result.folder},
                             {"limit", kMoved},
                             {"parameters", parameters},
                             {"not_compared", others},
                             {"pose", pose}});
}

/// The same as a page, with the chart of a report's parameters.
std::string page_of(const Assembled& a, const Assembled& b, const Comparison& all) {
  ReportData data;
  std::vector<std::vector<std::string>> rows = {
      {"parameter", "unit", a.result.folder, b.result.folder, "difference", "±", "times"}};
  for (const auto* list : {&all.moved, &all.equal}) {
    for (const Difference& of : *list) {
      const auto shown = [&](double value) { return detail::for_people(value, of.unit).first; };
      rows.push_back({of.name, detail::for_people(0.0, of.unit).second, shown(of.a), shown(of.b),
                      shown(of.b - of.a), shown(of.deviation), fmt::format("{:.1f}", of.times())});
      data.parameters.push_back({of.name, a.owner(of.name), of.unit, of.b - of.a, 0.0, of.deviation,
                                 list == &all.moved ? "" : "not significant"});
    }
  }
  const std::string title = a.result.folder + " and " + b.result.folder;
  std::string body = fmt::format(
      "<header class=\"verdict {}\">\n"
      "<h1>{}: <strong>{} of {} moved</strong></h1>\n<p class=\"note\">{}: "
      "{}</p>\n<div>{}</div>\n</header>\n"
      "<main>\n<section id=\"parameters\"><h2>Differences</h2>\n",
      all.moved.empty() ? "good" : "care", detail::html_name(a.result.robot.name()),
      all.moved.size(), counted(all.moved.size() + all.equal.size(), "parameter"),
      detail::html_text(title),
      fmt::format("by more than {} standard deviations of the difference", kMoved),
      detail::html_paragraphs(pose_text(a, all)));
  body += detail::html_figures(parameter_charts(data, "How much more the second result has")) +
          detail::html_table(rows, "ttnnnnn") + "</section>\n";
  if (!all.others.empty()) {
    std::vector<std::vector<std::string>> others = {{"parameter", "why"}};
    for (const NotCompared& of : all.others) others.push_back({of.name, of.why});
    body += "<section id=\"others\"><h2>Not compared</h2>\n" + detail::html_table(others, "tl") +
            "</section>\n";
  }
  body += "<section id=\"text\"><details><summary>As text</summary><pre>" +
          detail::html_lines(text_of(a, b, all)) + "</pre></details></section>\n</main>\n";
  return html_file({title, version(), body, ""});
}

}  // namespace

int compare(const CompareOptions& options) {
  if (!options.report.empty()) check_report(options.report, {}, false);
  const Assembled a(options.a), b(options.b);
  check_same_robot(a, b);
  Comparison all = compared(a, b);
  compare_poses(a, b, all);
  say("{}", text_of(a, b, all));
  if (!options.report.empty()) {
    write_output(options.report, is_page(options.report) ? page_of(a, b, all) : json_of(a, b, all));
  }
  return kDone;
}

}  // namespace kinecal::cli
