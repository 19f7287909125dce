// Definitions of upstream.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "upstream.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <optional>
#include <utility>

#include "commands.hpp"
#include "kinecal/files/launch/launch_nodes.hpp"
#include "kinecal/files/meshes/find_mesh.hpp"
#include "kinecal/files/yaml/config_scalar.hpp"
#include "kinecal/files/yaml/yaml_document.hpp"
#include "kinecal/program.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/text/shell_command.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

using Words = std::vector<std::string>;
using Values = std::map<std::string, std::string>;

/// Where foxglove_bridge is by default.
constexpr const char* kBridge = "ws://localhost:8765";
/// Where robot_calibration puts its results.
constexpr const char* kResults = "/tmp";

/// What a word of the command line is followed by.
enum class Follows { nothing, a_value, maybe_a_value };

/// Words that a program takes.
using Known = std::map<std::string, Follows>;

/// A program that kinecal stands for.
struct Program {
  std::string_view name;
  std::string_view usage;  ///< its arguments
  Known options;           ///< all that it takes
  Words parameters;        ///< that it has in ROS and kinecal uses or leaves out
  std::size_t most_words;  ///< beside options
};

/// The options of a program: its own, those of kinecal that it uses, and those that all have.
Known with_common(Known own, std::initializer_list<const char*> of_kinecal) {
  for (const char* option : of_kinecal) {
    const bool is_flag = std::string_view(option) == "--force";
    own.emplace(option, is_flag ? Follows::nothing : Follows::a_value);
  }
  for (const char* option : {"--show", "--help", "-h"}) own.emplace(option, Follows::nothing);
  return own;
}

const std::vector<Program>& programs() {
  const Known recorded = with_common({{"--from-bag", Follows::a_value}},
                                     {"--launch", "--urdf", "--output", "--force"});
  const Known of_base_programs = with_common(recorded, {"--robot"});
  const Words of_base = {"verbose",
                         "min_angle",
                         "max_angle",
                         "accel_limit",
                         "linear_accel_limit",
                         "align_velocity",
                         "align_gain",
                         "align_tolerance",
                         "r2_tolerance",
                         "base_controller/track_width",
                         "imu_gyro_scale"};
  static const std::vector<Program> all = {
      {"calibrate",
       "[POSES | --manual | --from-bag [BAG]]",
       with_common({{"--manual", Follows::nothing}, {"--from-bag", Follows::maybe_a_value}},
                   {"--launch", "--robot", "--urdf", "--output", "--force"}),
       {"verbose", "velocity_factor", "output_directory", "settle_duration_secs"},
       1},
      {"capture_poses",
       "[FILE] [--config CAPTURE_YAML]",
       with_common({{"--config", Follows::a_value}}, {"--launch", "--robot", "--urdf", "--force"}),
       {},
       1},
      {"viz", "BAG [OFFSETS]", with_common({}, {"--launch", "--urdf", "--output"}), {"verbose"}, 2},
      {"to_rpy", "A B C", with_common({}, {}), {}, 3},
      {"base_calibration", "[--from-bag BAG]", of_base_programs, of_base, 0},
      {"base_calibration_node", "[--from-bag BAG]", of_base_programs, of_base, 0},
      {"calibrate_base", "[--from-bag BAG]", of_base_programs, of_base, 0},
      {"magnetometer_calibration",
       "[--from-bag BAG]",
       recorded,
       {"bag_file_name", "rotation_manual", "rotation_velocity", "rotation_duration", "soft_iron"},
       0},
      {"calibrate_robot",
       "[--arm] [--base] [--install] [--reset] [--restore] [--date] [--directory DIR] "
       "[--from-bag BAG] [--to DIR]",
       with_common({{"--arm", Follows::nothing},
                    {"--base", Follows::nothing},
                    {"--install", Follows::nothing},
                    {"--reset", Follows::nothing},
                    {"--restore", Follows::nothing},
                    {"--date", Follows::nothing},
                    {"--directory", Follows::a_value},
                    {"--from-bag", Follows::a_value},
                    {"--to", Follows::a_value}},
                   {"--launch", "--robot", "--urdf", "--force"}),
       {},
       0}};
  return all;
}

const Program* program_named(std::string_view name) {
  const auto& all = programs();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const Program& program) { return program.name == name; });
  return found == all.end() ? nullptr : &*found;
}

/// A call, taken apart.
struct Call {
  const Program* program = nullptr;
  Values options;     ///< by their names; flags are empty
  Words words;        ///< others, such as POSES
  Values parameters;  ///< of the node
  Values remaps;      ///< from and to; with --launch, values of its arguments
  Words files;        ///< of parameters, in their order
  std::string samples = "/tmp/calibration_data";  ///< how the name of recorded samples begins

  [[nodiscard]] bool has(const std::string& option) const { return options.contains(option); }
  [[nodiscard]] std::string option(const std::string& name, const std::string& otherwise) const {
    const auto found = options.find(name);
    return found == options.end() ? otherwise : found->second;
  }
  [[nodiscard]] std::string parameter(const std::string& name, const std::string& otherwise) const {
    const auto found = parameters.find(name);
    return found == parameters.end() ? otherwise : found->second;
  }
  [[nodiscard]] bool is_set(const std::string& flag) const {
    const std::string value = parameter(flag, "false");
    return value == "true" || value == "True" || value == "1";
  }
  /// The folder of results.
  [[nodiscard]] std::string output() const {
    return option("--output", parameter("output_directory", kResults));
  }
};

std::string in_quotes(const std::string& text) {
  return "'" + text + "'";
}

[[noreturn]] void refuse(const Call& call, const std::string& message) {
  throw InputError(std::string(call.program->name) + ": " + message);
}

/// Refuses a word that is not known, with the nearest.
[[noreturn]] void refuse_word(const Call& call, const std::string& word, const std::string& kind,
                              const Words& known) {
  const std::string meant = did_you_mean(word, known);
  refuse(call,
         in_quotes(word) + " is not " + kind +
             (meant.empty() ? "; it takes " + fmt::format("{}", fmt::join(known, ", ")) : meant));
}

/// Takes "name:=value" apart; nullopt if the word is not of this form.
std::optional<std::pair<std::string, std::string>> assignment(const std::string& word) {
  const std::size_t at = word.find(":=");
  if (at == std::string::npos || at == 0) return std::nullopt;
  return std::pair(word.substr(0, at), word.substr(at + 2));
}

/// Sets a parameter that the program has.
/// @param name  "verbose", or "node:verbose"
void set_parameter(Call& call, const std::string& name, const std::string& value) {
  const std::string own = name.substr(name.find(':') + 1);
  const Words& known = call.program->parameters;
  if (std::find(known.begin(), known.end(), own) == known.end()) {
    if (known.empty()) refuse(call, "has no parameters: leave out " + in_quotes(own));
    refuse_word(call, own,
                "a parameter that can be set on the command line; those of a capture and of a "
                "calibration come from --params-file",
                known);
  }
  call.parameters[own] = value;
}

/// Takes a call apart: the words of ROS, then those of the program.
class Parser {
 public:
  Parser(const Program& program, const Words& arguments) : arguments_(arguments) {
    call_.program = &program;
  }

  [[nodiscard]] Call parse() {
    for (; at_ < arguments_.size(); ++at_) {
      const std::string& word = arguments_[at_];
      if (word == "--ros-args") {
        in_ros_ = true;
      } else if (in_ros_ && word == "--") {
        in_ros_ = false;
      } else if (in_ros_) {
        take_of_ros2(word);
      } else if (const auto pair = assignment(word)) {
        take_of_ros1(pair->first, pair->second);
      } else if (call_.program->name == "to_rpy" && !word.starts_with("--")) {
        call_.words.push_back(word);  // -0.1 is a number
      } else {
        take_own(word);
      }
    }
    if (call_.words.size() > call_.program->most_words) {
      refuse(call_, in_quotes(call_.words[call_.program->most_words]) + " is one word too many; " +
                        std::string(call_.program->name) + " " + std::string(call_.program->usage));
    }
    return std::move(call_);
  }

 private:
  std::string value_after(const std::string& word) {
    if (++at_ == arguments_.size()) refuse(call_, word + " has no value");
    return arguments_[at_];
  }

  void take_of_ros2(const std::string& word) {
    const auto pair_after = [&] {
      const auto pair = assignment(value_after(word));
      if (!pair) refuse(call_, word + " " + arguments_[at_] + ": is not NAME:=VALUE");
      return *pair;
    };
    if (word == "--params-file") {
      call_.files.push_back(value_after(word));
    } else if (word == "-p" || word == "--param") {
      const auto [name, value] = pair_after();
      set_parameter(call_, name, value);
    } else if (word == "-r" || word == "--remap") {
      const auto [from, to] = pair_after();
      if (!from.starts_with("__")) call_.remaps[from] = to;
    } else if (word == "--log-level" || word == "--log-config-file" || word == "-e" ||
               word == "--enclave") {
      (void)value_after(word);
    } else if (!word.starts_with("--enable-") && !word.starts_with("--disable-")) {
      refuse_word(call_, word, "an argument of ROS 2",
                  {"--params-file", "--param", "--remap", "--log-level"});
    }
  }

  /// _param:=value, __name:=node, from:=to.
  void take_of_ros1(const std::string& name, const std::string& value) {
    if (name.starts_with("__")) return;
    if (name.starts_with("_")) return set_parameter(call_, name.substr(1), value);
    call_.remaps[name] = value;
  }

  void take_own(const std::string& word) {
    if (!word.starts_with("-")) {
      call_.words.push_back(word);
      return;
    }
    const std::string name = word.substr(0, word.find('='));
    const Known& known = call_.program->options;
    const auto found = known.find(name);
    if (found == known.end()) {
      Words names;
      for (const auto& option : known) names.push_back(option.first);
      refuse_word(call_, name, "an argument", names);
    }
    std::string value;
    const bool has_next = at_ + 1 < arguments_.size() && !arguments_[at_ + 1].starts_with("-") &&
                          !assignment(arguments_[at_ + 1]);
    if (name.size() < word.size()) {
      value = word.substr(name.size() + 1);
    } else if (found->second == Follows::a_value ||
               (found->second == Follows::maybe_a_value && has_next)) {
      value = value_after(word);
    }
    call_.options[name] = value;
  }

  const Words& arguments_;
  Call call_;
  std::size_t at_ = 0;
  bool in_ros_ = false;
};

/// Which of several nodes of a launch file the program is.
const LaunchNode& node_of(const Call& call, const LaunchNodes& launch, const std::string& file) {
  const LaunchNode* found = nullptr;
  Words others;
  for (const LaunchNode& node : launch.nodes) {
    const bool is_other = node.package != "robot_calibration" ||
                          (node.type != call.program->name && call.program->name != "viz");
    if (is_other) {
      others.push_back(node.package + "/" + node.type);
    } else if (found != nullptr) {
      throw InputError(node.place.str() + ": is a second node '" + node.type +
                       "', the first is in line " + std::to_string(found->place.line) +
                       "; keep one");
    } else {
      found = &node;
    }
  }
  if (found != nullptr) return *found;
  others.insert(others.end(), launch.included.begin(), launch.included.end());
  throw InputError(file + ": starts no node '" + std::string(call.program->name) +
                   "' of robot_calibration" +
                   (others.empty() ? "" : fmt::format("; it has {}", fmt::join(others, ", "))));
}

/// Adds what a launch file gives to its node.  What is on the command line comes first.
void add_launch(Call& call) {
  const std::string file = call.option("--launch", "");
  Diagnostics diagnostics;
  const LaunchNodes launch =
      read_launch_nodes(file, call.remaps, {"robot_calibration", "rosbag"}, diagnostics);
  diagnostics.throw_if_errors();
  const LaunchNode& node = node_of(call, launch, file);
  call.remaps = node.remaps;
  call.files.insert(call.files.begin(), node.parameter_files.begin(), node.parameter_files.end());
  const Words& known = call.program->parameters;
  for (const auto& [name, value] : node.parameters) {
    if (std::find(known.begin(), known.end(), name) != known.end()) {
      call.parameters.emplace(name, value);
    }
  }
  if (!launch.robot_description.empty()) call.options.emplace("--urdf", launch.robot_description);
  for (const LaunchNode& other : launch.nodes) {
    if (other.package != "rosbag" || other.type != "record") continue;
    const auto name = std::find_if(
        other.arguments.begin(), other.arguments.end(),
        [](const std::string& word) { return word == "-o" || word == "--output-prefix"; });
    if (name != other.arguments.end() && name + 1 != other.arguments.end()) {
      call.samples = *(name + 1);
    }
  }
  if (!call.words.empty() || call.has("--manual") || call.has("--from-bag")) return;
  const Call own = Parser(*call.program, node.arguments).parse();
  call.words = own.words;
  call.options.insert(own.options.begin(), own.options.end());
}

/// The maps of parameters in a file: those of nodes of ROS 2, or the file.
void add_parameters(const detail::YamlNode& map, std::vector<const detail::YamlNode*>& found,
                    int depth) {
  for (std::size_t i = 0; i < map.keys.size() && depth < 5; ++i) {
    if (map.keys[i].text == "ros__parameters") {
      found.push_back(&map.items[i]);
    } else if (map.items[i].is_map()) {
      add_parameters(map.items[i], found, depth + 1);
    }
  }
}

/// Which of the files of parameters are which; empty: none.
struct Configurations {
  std::string capture, calibrate;
};

bool has_any(const detail::YamlNode& map, std::initializer_list<const char*> keys) {
  return std::any_of(keys.begin(), keys.end(),
                     [&](const char* key) { return map.find(key) != nullptr; });
}

/// Sorts the files of parameters, and takes the program's own parameters out of them.
Configurations configurations(Call& call) {
  Configurations sorted;
  const Words& known = call.program->parameters;
  Values own;
  for (const std::string& file : call.files) {
    Diagnostics diagnostics;
    const detail::YamlNode content = detail::load_config(file, diagnostics);
    diagnostics.throw_if_errors();
    std::vector<const detail::YamlNode*> maps;
    add_parameters(content, maps, 0);
    if (maps.empty()) maps = {&content};
    bool is_used = false;
    for (const detail::YamlNode* map : maps) {
      const auto take = [&](std::string& as, const char* kind) {
        if (!as.empty() && as != file) {
          refuse(call, file + " has parameters of " + kind + ", as has " + as +
                           "; put them into one file");
        }
        as = file;
        is_used = true;
      };
      if (has_any(*map, {"chains", "features"})) take(sorted.capture, "the capture");
      if (has_any(*map, {"models", "error_blocks", "free_params", "free_frames", "cal_steps",
                         "calibration_steps"})) {
        take(sorted.calibrate, "the calibration");
      }
      for (std::size_t i = 0; i < map->keys.size(); ++i) {
        const std::string& name = map->keys[i].text;
        if (std::find(known.begin(), known.end(), name) == known.end()) continue;
        is_used = true;
        if (const auto value = detail::config_text(map->items[i])) own[name] = *value;
      }
    }
    if (!is_used) {
      refuse(call, file +
                       " has none of the parameters of a capture (chains, features) or a "
                       "calibration (models, error_blocks, calibration_steps)");
    }
  }
  call.parameters.insert(own.begin(), own.end());  // those of the command line come first
  return sorted;
}

Words& add(Words& line, const std::string& option, const std::string& value) {
  if (value.empty()) return line;
  // A value that looks like an option is joined to it.
  if (value.starts_with("-")) {
    line.push_back(option + "=" + value);
  } else {
    line.insert(line.end(), {option, value});
  }
  return line;
}

/// The line that calibrates, with upstream's names of results.
Words calibration(const Call& call, const std::string& config, const std::string& samples,
                  const std::string& output) {
  Words line = {"calibrate"};
  add(line, "--urdf", call.option("--urdf", ""));
  add(line, "--config", config);
  add(line, "--samples", samples);
  add(line, "--output", output);
  line.emplace_back("--upstream-names");
  // Files without a date, such as report.json, are those of the last result.
  const bool has_result = std::filesystem::exists(std::filesystem::path(output) / "report.json");
  if (has_result || call.has("--force")) line.emplace_back("--force");
  if (call.is_set("verbose")) line.emplace_back("--verbose");
  return line;
}

/// How to give a program of ROS its configuration.
std::string how_configured(const Call& call, const std::string& file) {
  const std::string name(call.program->name);
  return "give it with '" + name + " … --ros-args --params-file " + file + "' or '" + name +
         " --launch FILE.launch'";
}

std::string topic_of(const Call& call, const std::string& topic) {
  for (const std::string& from : {topic, "/" + topic}) {
    const auto found = call.remaps.find(from);
    if (found != call.remaps.end()) return found->second;
  }
  return {};
}

/// Launch files are of ROS 1.
bool is_ros1(const Call& call, const UpstreamPlace& place) {
  return place.is_ros1 || call.has("--launch");
}

/// The poses of a capture: as given, or upstream's default of either ROS.
std::string poses_of(const Call& call, const UpstreamPlace& place) {
  if (!call.words.empty()) return call.words.front();
  const Words names = is_ros1(call, place)
                          ? Words{"calibration_poses.bag", "calibration_poses.yaml"}
                          : Words{"calibration_poses.yaml", "calibration_poses.bag"};
  const auto found = std::find_if(names.begin(), names.end(), [](const std::string& name) {
    return std::filesystem::exists(name);
  });
  return found == names.end() ? names.front() : *found;
}

UpstreamCall calibrate_call(Call call, const UpstreamPlace& place) {
  const Configurations files = configurations(call);
  if (files.calibrate.empty()) {
    refuse(call, "the configuration of the calibration is missing; " +
                     how_configured(call, "calibrate.yaml"));
  }
  UpstreamCall done;
  if (call.has("--from-bag")) {
    std::string bag = call.option("--from-bag", "");
    if (bag.empty()) bag = "/tmp/calibration_data.bag";
    if (call.has("--manual") || !call.words.empty()) {
      refuse(call, "--from-bag takes recorded samples, so there is nothing to capture");
    }
    done.lines = {calibration(call, files.calibrate, bag, call.output())};
    return done;
  }
  if (files.capture.empty()) {
    refuse(call,
           "the configuration of the capture is missing; " + how_configured(call, "capture.yaml"));
  }
  const std::string samples =
      call.samples + "_" + place.date + (is_ros1(call, place) ? ".bag" : ".mcap");
  Words capture = {"capture", shell_file(files.capture)};
  add(capture, "--robot", call.option("--robot", kBridge));
  add(capture, "--urdf", call.option("--urdf", ""));
  add(capture, "--joint-states", topic_of(call, "joint_states"));
  if (call.has("--manual")) {
    if (!call.words.empty()) refuse(call, "--manual needs no poses: you move the robot");
    capture.emplace_back("--manual");
  } else {
    add(capture, "--poses", poses_of(call, place));
  }
  const std::string velocity = call.parameter("velocity_factor", "1.0");
  if (velocity != "1.0" && velocity != "1") add(capture, "--velocity", velocity);
  add(capture, "--output", samples);
  done.lines = {capture, calibration(call, files.calibrate, samples, call.output())};
  return done;
}

/// A call that is one line.
UpstreamCall of_line(const Words& line) {
  UpstreamCall call;
  call.lines = {line};
  return call;
}

UpstreamCall capture_poses_call(Call call, const UpstreamPlace& place) {
  Words line = {"capture_poses"};
  std::string config = call.option("--config", "");
  if (config.empty() && !call.files.empty()) config = configurations(call).capture;
  if (!config.empty()) line.push_back(shell_file(config));
  add(line, "--robot", call.option("--robot", kBridge));
  add(line, "--urdf", call.option("--urdf", ""));
  add(line, "--joint-states", topic_of(call, "joint_states"));
  const std::string name =
      is_ros1(call, place) ? "calibration_poses.bag" : "calibration_poses.yaml";
  add(line, "--output", call.words.empty() ? name : call.words.front());
  if (call.has("--force")) line.emplace_back("--force");
  return of_line(line);
}

UpstreamCall viz_call(Call call, const UpstreamPlace& place) {
  if (call.words.empty()) refuse(call, "the samples are missing: viz BAG [OFFSETS]");
  if (call.words.size() == 2) {
    const std::filesystem::path folder = std::filesystem::path(call.words[1]).parent_path();
    UpstreamCall evaluated =
        of_line({"evaluate", folder.empty() ? "." : folder.string(), call.words[0]});
    evaluated.notes = {"the newest result in the folder of " + call.words[1] + " is evaluated"};
    return evaluated;
  }
  const Configurations files = configurations(call);
  if (files.calibrate.empty()) {
    refuse(call, "the configuration is missing; " + how_configured(call, "calibrate.yaml"));
  }
  const std::string stem = (std::filesystem::path(call.output()) / ("viz_" + place.date)).string();
  Words line = {"calibrate"};
  add(line, "--urdf", call.option("--urdf", ""));
  add(line, "--config", files.calibrate);
  add(line, "--samples", call.words[0]);
  line.insert(line.end(), {"--dry-run", "--quiet"});
  add(line, "--report", stem + ".html");
  add(line, "--scene", stem + ".mcap");
  UpstreamCall done = of_line(line);
  done.end = "look at " + stem + ".html in a browser, and at " + stem +
             ".mcap with Foxglove or Lichtblick: the robot and what was measured, before and after";
  return done;
}

UpstreamCall to_rpy_call(const Call& call) {
  if (call.words.size() != 3) refuse(call, "takes three numbers: to_rpy A B C");
  Words line = {"rpy"};
  line.insert(line.end(), call.words.begin(), call.words.end());
  line.emplace_back("--comma");
  return of_line(line);
}

/// A calibration from a recording of topics, with the configuration that `init` writes for it into a folder.
/// @param init    of `init`, such as the target
/// @param urdf    which `init` writes if there is none, in its folder
UpstreamCall recording_call(const Call& call, const Words& init, const std::string& bag,
                            const std::string& folder, const std::string& urdf,
                            const std::string& output) {
  const std::filesystem::path written(folder);
  Words line = {"init"};
  line.insert(line.end(), init.begin(), init.end());
  add(line, "--urdf", call.option("--urdf", ""));
  add(line, "--from", bag);
  add(line, "--output", (written / "calibrate.yaml").string());
  UpstreamCall done;
  done.lines = {line, calibration(call, (written / "calibrate.yaml").string(), bag, output)};
  if (!call.has("--urdf")) done.urdf = (written / urdf).string();
  return done;
}

/// Wheels as the odometry reports them, in front of a wall, as upstream has it.
UpstreamCall base_call(Call call, const std::string& output, const UpstreamPlace& place) {
  (void)configurations(call);
  const std::string folder = (std::filesystem::path(output) / ("base_" + place.date)).string();
  Words init = {"--target", "base", "--drive", "odometry", "--seen", "wall"};
  // What Fetch's driver has; its installer sets both.
  const bool is_fetch = call.program->name == "calibrate_robot";
  add(init, "--track-width",
      call.parameter("base_controller/track_width", is_fetch ? "0.37476" : ""));
  add(init, "--gyro-scale", call.parameter("imu_gyro_scale", is_fetch ? "0.001221729" : ""));
  if (call.has("--from-bag")) {
    return recording_call(call, init, call.option("--from-bag", ""), folder, "base.urdf", output);
  }
  const std::string bag = output + "/base_calibration_" + place.date + ".bag";
  const std::string config = (std::filesystem::path(folder) / "drive/base.yaml").string();
  Words topics = {"init", "--target", "base", "--drive", "odometry", "--seen", "wall"};
  Words drive = {"capture", config};
  add(drive, "--robot", call.option("--robot", kBridge));
  for (Words* line : {&topics, &drive}) add(*line, "--urdf", call.option("--urdf", ""));
  add(topics, "--output", config);
  const std::array<std::array<const char*, 2>, 4> names = {
      {{"odom", "odom"}, {"base_scan", "scan"}, {"imu", "imu"}, {"cmd_vel", "commands"}}};
  for (const auto& [topic, key] : names) {
    const std::string name = topic_of(call, topic);
    if (!name.empty()) add(drive, "--topic", std::string(key) + "=" + name);
  }
  drive.emplace_back("--drive");
  add(drive, "--output", bag);
  UpstreamCall done = recording_call(call, init, bag, folder, "base.urdf", output);
  done.lines.insert(done.lines.begin(), {topics, drive});
  return done;
}

UpstreamCall magnetometer_call(Call call, const UpstreamPlace& place) {
  (void)configurations(call);
  const bool turns = call.parameter("rotation_velocity", "0.2") != "0.0" &&
                     call.parameter("rotation_duration", "60.0") != "0.0";
  std::string bag = call.option("--from-bag", "");
  if (bag.empty()) bag = call.parameter("bag_file_name", "/tmp/magnetometer_calibration.bag");
  const std::string folder =
      (std::filesystem::path(call.output()) / ("magnetometer_" + place.date)).string();
  UpstreamCall done = recording_call(call, {"--target", "magnetometer"}, bag, folder,
                                     "magnetometer.urdf", call.output());
  if (call.is_set("soft_iron")) {
    done.notes.push_back(
        "soft_iron: has no effect: soft iron is calibrated as far as the readings show it, of a "
        "turn "
        "about one axis in its plane only; for all of it, turn the sensor all ways by hand");
  }
  if (!call.has("--from-bag") && (turns || call.is_set("rotation_manual"))) {
    done.notes.push_back("the robot is not turned: " + bag +
                         " is read, a recording of /imu/mag while somebody turns it");
  }
  return done;
}

/// A file of a package of ROS.
std::string in_package(const Call& call, const std::string& package, const std::string& file) {
  try {
    return (find_package(package, mesh_places("")) / file).string();
  } catch (const MeshError& e) {
    refuse(call, e.what());
  }
}

void append(UpstreamCall& all, const UpstreamCall& more) {
  all.lines.insert(all.lines.end(), more.lines.begin(), more.lines.end());
  all.notes.insert(all.notes.end(), more.notes.begin(), more.notes.end());
  if (!more.urdf.empty()) all.urdf = more.urdf;
}

/// Captures and calibrates arm and head of a Fetch.
UpstreamCall arm_call(const Call& call, const UpstreamPlace& place) {
  Call arm = call;
  arm.program = program_named("calibrate");
  arm.options["--output"] = call.option("--directory", kResults);
  arm.options.emplace("--launch", in_package(call, "fetch_calibration", "launch/capture.launch"));
  add_launch(arm);
  return calibrate_call(arm, place);
}

UpstreamCall calibrate_robot_call(const Call& call, const UpstreamPlace& place) {
  const std::string distro = place.ros_distro.empty() ? "indigo" : place.ros_distro;
  const std::string robot = call.option("--to", "/etc/ros/" + distro);
  const std::string directory = call.option("--directory", kResults);
  if (call.has("--date")) return of_line({"install", "--date", "--to", robot});
  if (call.has("--arm") && call.has("--base") && call.has("--from-bag")) {
    refuse(call, "--from-bag is a recording of the arm or of the base; call it once for each");
  }
  UpstreamCall all;
  if (call.has("--restore")) all.lines.push_back({"install", "--restore", "--to", robot});
  if (call.has("--reset")) {
    const std::string factory = in_package(call, "fetch_bringup", "launch/fetch.launch");
    all.lines.push_back({"install", "--reset", factory, "--to", robot});
  }
  // The base first: its result has the URDF of the arm that is not yet calibrated.
  const std::string base = (std::filesystem::path(directory) / "base_calibration").string();
  const auto has_result = [](const std::string& folder) {
    return std::filesystem::exists(std::filesystem::path(folder) / "report.json");
  };
  const bool installs_base = call.has("--base") || (call.has("--install") && has_result(base));
  const bool installs_arm =
      call.has("--arm") || (call.has("--install") && (has_result(directory) || !installs_base));
  if (call.has("--base")) append(all, base_call(call, base, place));
  if (call.has("--arm")) append(all, arm_call(call, place));
  if (installs_base) all.lines.push_back({"install", base, "--to", robot});
  if (installs_arm) all.lines.push_back({"install", directory, "--to", robot});
  if (all.lines.empty()) {
    refuse(call, "nothing to do; it takes " + std::string(call.program->usage));
  }
  all.end =
      "restart the robot's drivers, which read this when they start: sudo service robot "
      "restart";
  return all;
}

void print_usage(const Program& program) {
  const auto if_known = [&](const char* option, const char* text) {
    return program.options.contains(option) ? std::string(" ") + text : "";
  };
  const std::string of_ros =
      if_known("--launch", "[--launch FILE.launch [NAME:=VALUE ...]]") +
      (program.name == "to_rpy" ? "" : " [--ros-args --params-file FILE ...]");
  const std::string of_kinecal =
      if_known("--robot", "[--robot ADDRESS]") + if_known("--urdf", "[--urdf FILE]") +
      if_known("--output", "[--output DIR]") + if_known("--force", "[--force]");
  say("usage: {} {}\n", program.name, program.usage);
  for (const std::string& line : {of_ros, of_kinecal}) {
    if (!line.empty()) say("      {}\n", line);
  }
  say("       [--show: print the commands of kinecal instead of running them]\n");
}

}  // namespace

bool is_upstream(std::string_view name) {
  return program_named(name) != nullptr;
}

UpstreamCall translated(const std::string& name, const std::vector<std::string>& arguments,
                        const UpstreamPlace& place) {
  const Program* const program = program_named(name);
  if (program == nullptr) throw InputError("'" + name + "' is not a program of robot_calibration");
  Call call = Parser(*program, arguments).parse();
  if (call.has("--launch") && name != "calibrate_robot") {
    add_launch(call);
  }
  const auto call_of = [&]() -> UpstreamCall {
    if (name == "calibrate") return calibrate_call(call, place);
    if (name == "capture_poses") return capture_poses_call(call, place);
    if (name == "viz") return viz_call(call, place);
    if (name == "to_rpy") return to_rpy_call(call);
    if (name == "magnetometer_calibration") return magnetometer_call(call, place);
    if (name == "calibrate_robot") return calibrate_robot_call(call, place);
    return base_call(call, call.output(), place);
  };
  UpstreamCall done = call_of();
  done.is_shown = call.has("--show");
  return done;
}

namespace {

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// A line of kinecal as it is typed.
std::string typed(const Words& line) {
  ShellCommand command{"kinecal"};
  for (const std::string& word : line) command.add({word});
  return command.str();
}

/// A folder of one's own for a file of parameters, removed at the end unless it is kept.
class ParameterFolder {
 public:
  ParameterFolder() = default;
  ParameterFolder(const ParameterFolder&) = delete;
  ParameterFolder& operator=(const ParameterFolder&) = delete;
  ~ParameterFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }

  /// A file in it; the folder is made first.
  /// @throws InputError  if it cannot be made
  [[nodiscard]] std::string file(const std::string& name) {
    std::string path = (std::filesystem::temp_directory_path() / "kinecal_XXXXXX").string();
    if (::mkdtemp(path.data()) == nullptr) {
      throw InputError(path + ": a folder for the parameters cannot be made there");
    }
    path_ = path;
    return (std::filesystem::path(path_) / name).string();
  }
  /// Leaves it there, for commands that are printed and not run.
  void keep() { path_.clear(); }

 private:
  std::string path_;
};

/// Adds what roslaunch has put on the parameter server of ROS 1 for the node that it starts.
/// @throws InputError  if it cannot be had
void add_parameter_server(Words& arguments, ParameterFolder& folder) {
  std::string node, space;
  for (const std::string& word : arguments) {
    if (word == "--launch" || word == "--ros-args") return;
    if (word.starts_with("__name:=")) node = word.substr(word.find('=') + 1);
    if (word.starts_with("__ns:=")) space = word.substr(word.find('=') + 1);
  }
  if (node.empty()) return;
  std::replace(node.begin(), node.end(), '/', '_');  // a name has none
  while (space.ends_with('/')) space.pop_back();
  const std::string name =
      (space.starts_with('/') || space.empty() ? space : "/" + space) + "/" + node;
  const std::string file = folder.file(node + ".yaml");
  const std::string command = ShellCommand{"rosparam", "dump", file, name}.str();
  if (std::system((command + " 1>&2").c_str()) != 0) {
    throw InputError("'" + command + "' fails, so the parameters of node '" + name +
                     "' are not known; give their files with --launch or --ros-args --params-file");
  }
  arguments.insert(arguments.end(), {"--ros-args", "--params-file", file, "--"});
}

/// True for the calibration beside whose configuration `init` has written this URDF.
bool is_of(const std::filesystem::path& urdf, const Words& line) {
  const auto config = std::find(line.begin(), line.end(), "--config");
  return line.front() == "calibrate" && config != line.end() && std::filesystem::exists(urdf) &&
         std::filesystem::path(*(config + 1)).parent_path() == urdf.parent_path();
}

int run_line(const Words& line) {
  Words words = {"kinecal"};
  words.insert(words.end(), line.begin(), line.end());
  // Folders of recordings and results, as upstream's launch files and nodes make them.
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    if (words[i] != "--output") continue;
    const std::filesystem::path output = words[i + 1];
    std::error_code ignored;  // the command says it better
    if (output.has_parent_path()) {
      std::filesystem::create_directories(output.parent_path(), ignored);
    }
  }
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  return run_program(static_cast<int>(words.size()), argv.data());
}

}  // namespace

int run_as_upstream(const std::string& name, std::vector<std::string> arguments) {
  const auto asks = [](const std::string& word) { return word == "--help" || word == "-h"; };
  if (std::any_of(arguments.begin(), arguments.end(), asks)) {
    print_usage(*program_named(name));
    return kDone;
  }
  const std::string date = fmt::format("{:%Y_%m_%d_%H_%M_%S}", fmt::localtime(std::time(nullptr)));
  ParameterFolder folder;
  UpstreamCall call;
  try {
    if (!program_named(name)->parameters.empty()) add_parameter_server(arguments, folder);
    call = translated(name, arguments,
                      {date, environment("ROS_DISTRO"), environment("ROS_VERSION") == "1"});
  } catch (const std::exception& e) {
    say(stderr, "error: {}\n", with_hanging_lines(e.what()));
    return kBadInput;
  }
  if (call.is_shown) folder.keep();
  for (const std::string& note : call.notes) say(stderr, "note: {}\n", note);
  for (Words& line : call.lines) {
    if (is_of(call.urdf, line)) add(line, "--urdf", call.urdf);
    if (call.is_shown) {
      say("{}\n", typed(line));
      continue;
    }
    if (name != "to_rpy") say(stderr, "+ {}\n", typed(line));
    if (const int code = run_line(line); code != kDone) return code;
  }
  if (!call.is_shown && !call.end.empty()) say("{}\n", call.end);
  return kDone;
}

}  // namespace kinecal::cli
