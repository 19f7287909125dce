// Definitions of pipe_robot.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/robots/pipe_robot.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/checksum.hpp"
#include "kinecal/files/images/read_image.hpp"
#include "kinecal/files/json/json_text.hpp"
#include "kinecal/files/json/json_value.hpp"
#include "kinecal/files/messages/message_fields.hpp"
#include "kinecal/robots/child_process.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal {

namespace detail {

// Images and camera settings sent by a program over a pipe (pipe_robot.hpp).

/// The image of a file name or of {"base64": "..."}.
/// @param decode  decode_image or decode_depth
/// @throws JsonError   if a file cannot be read
/// @throws InputError  if it is not a valid image
template <class Decode>
[[nodiscard]] auto pipe_image(const JsonValue& image, Decode&& decode) {
  if (!image.is_text()) {
    const auto bytes = from_base64(image.text("base64"));
    if (!bytes) throw JsonError("the base64 has a character outside its alphabet");
    return decode(*bytes, "the image");
  }
  const std::string name = image.as_text();
  std::ifstream file(name, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (bytes.empty()) throw JsonError("'" + printable(name) + "' cannot be read");
  return decode(bytes, name);
}

template <std::size_t N>
void copy_numbers(const JsonValue& json, const std::string& field, std::array<double, N>& to) {
  const std::vector<double> numbers = json.numbers(field);
  if (numbers.size() != N) {
    throw JsonError("field '" + field + "' has " + std::to_string(numbers.size()) +
                    " numbers; expected " + std::to_string(N));
  }
  std::copy(numbers.begin(), numbers.end(), to.begin());
}

/// P defaults to K.
[[nodiscard]] inline CameraInfo pipe_camera(const JsonValue& json) {
  CameraInfo camera;
  camera.width = static_cast<int>(json.id("width"));
  camera.height = static_cast<int>(json.id("height"));
  camera.distortion_model = json.text_or("distortion_model", "plumb_bob");
  camera.d = json.find("d") ? json.numbers("d") : std::vector<double>(5, 0.0);
  camera.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  if (json.find("r")) copy_numbers(json, "r", camera.r);
  if (json.find("k")) copy_numbers(json, "k", camera.k);
  if (json.find("p")) {
    copy_numbers(json, "p", camera.p);
    return camera;
  }
  copy_numbers(json, "k", camera.k);  // one of the two is required
  const auto& k = camera.k;
  camera.p = {k[0], k[1], k[2], 0, k[3], k[4], k[5], 0, k[6], k[7], k[8], 0};
  return camera;
}

}  // namespace detail

class PipeRobot::Pipe {
 public:
  explicit Pipe(const PipeOptions& options)
      : process_(options.command, options.interrupted), options_(options) {}

  /// Sends a request and parses the answer.
  /// @param what  name of the request in messages: "view"
  template <class Read>
  auto ask(const std::string& what, const detail::Json& request, Read&& read) {
    const std::string who = "'" + process_.command() + "': " + what + ": ";
    // Lines before the request are not its answer: a greeting, a log line, or a late answer to the
    // last request.
    constexpr int kMost = 1000;  // lines; more counts as a late answer
    for (int i = 0; i < kMost && process_.read_line(std::chrono::milliseconds(0)); ++i) {
      late_ = std::max(0, late_ - 1);
    }
    if (late_ > 0) {
      throw SilenceError(
          who + "it still has not answered to the last request, '" + unanswered_ + "'",
          process_.command() + ": " + unanswered_, answered_[unanswered_]);
    }
    process_.write_line(detail::json_text({{what, request}}), options_.time_limit);
    const auto line = next_line(who);
    if (!line) {
      ++late_;
      unanswered_ = what;
      throw SilenceError(who + "no answer within " + limit_text(options_.time_limit),
                         process_.command() + ": " + what, answered_[what]);
    }
    try {
      const detail::JsonValue answer = detail::JsonValue::parse(*line);
      if (answer.find("stamp")) newest_ = Stamp(answer.integer("stamp"));
      answered_[what] = newest_;
      const std::string error = answer.text_or("error", {});
      if (error.empty()) {
        auto value = read(answer);
        unreadable_ = 0;
        return value;
      }
      unreadable_ = 0;
      throw PoseError(who + printable(error));
    } catch (const PoseError&) {
      throw;
    } catch (const std::runtime_error& error) {
      fail_unreadable(who, error.what());
    }
  }

 private:
  /// The next line; says if it takes long.
  [[nodiscard]] std::optional<std::string> next_line(const std::string& who) {
    const auto first = std::min(options_.patience, options_.time_limit);
    auto line = process_.read_line(first);
    if (line || first == options_.time_limit) return line;
    if (options_.slow) {
      options_.slow(who + "no answer for " + limit_text(first) + "; waiting until " +
                    limit_text(options_.time_limit));
    }
    return process_.read_line(options_.time_limit - first);
  }

  /// Skips a pose after an unreadable answer; a program that sends nothing else is not a robot.
  [[noreturn]] void fail_unreadable(const std::string& who, const std::string& why) {
    constexpr int kMost = 3;
    if (++unreadable_ < kMost) throw PoseError(who + "the answer cannot be read: " + why);
    throw ConnectionError(who + std::to_string(kMost) +
                          " answers in a row cannot be read; the last one: " + why);
  }

  [[nodiscard]] static std::string limit_text(std::chrono::milliseconds time) {
    return detail::stamp_text(std::chrono::duration_cast<Stamp>(time));
  }

  detail::ChildProcess process_;
  PipeOptions options_;
  int late_ = 0;                                          ///< answers given up
  int unreadable_ = 0;                                    ///< answers in a row
  std::string unanswered_;                                ///< the request of the last of them
  Stamp newest_{};                                        ///< of all answers
  std::map<std::string, std::optional<Stamp>> answered_;  ///< newest stamp at that time, by request
};

namespace detail {

[[nodiscard]] inline Stamp stamp_of(const JsonValue& answer) {
  return Stamp(answer.integer("stamp"));
}

/// @throws JsonError  if it is not later than a given time
[[nodiscard]] inline Stamp stamp_after(const JsonValue& answer, Stamp after) {
  const Stamp stamp = stamp_of(answer);
  if (stamp > after) return stamp;
  throw JsonError("its stamp, " + std::to_string(stamp.count()) + ", is not after " +
                  std::to_string(after.count()) + " ns");
}

[[nodiscard]] inline Json after_json(Stamp after) {
  return {{"after", after.count()}};
}

}  // namespace detail

PipeRobot::PipeRobot(const PipeOptions& options) : pipe_(std::make_unique<Pipe>(options)) {}
PipeRobot::PipeRobot(PipeRobot&&) noexcept = default;
PipeRobot& PipeRobot::operator=(PipeRobot&&) noexcept = default;
PipeRobot::~PipeRobot() = default;

void PipeRobot::move(const JointTarget& target) {
  const detail::Json request = {{"names", target.names},
                                {"positions", target.positions},
                                {"velocity_factor", target.velocity_factor}};
  (void)pipe_->ask("move", request, [](const detail::JsonValue&) { return true; });
}

MeasuredJoints PipeRobot::next_joints(Stamp after) {
  return pipe_->ask("joints", detail::after_json(after), [after](const detail::JsonValue& answer) {
    MeasuredJoints joints;
    joints.stamp = detail::stamp_after(answer, after);
    joints.names = answer.texts("names");
    joints.positions = answer.numbers("positions");
    if (joints.names.size() != joints.positions.size()) {
      throw detail::JsonError("there are " + std::to_string(joints.names.size()) + " names and " +
                              std::to_string(joints.positions.size()) + " positions");
    }
    return joints;
  });
}

View PipeRobot::next_view(Stamp after) {
  return pipe_->ask("view", detail::after_json(after), [after](const detail::JsonValue& answer) {
    View view;
    view.stamp = detail::stamp_after(answer, after);
    view.frame = answer.text("frame");
    if (const auto camera = answer.find("camera")) view.camera = detail::pipe_camera(*camera);
    if (const auto image = answer.find("image"))
      view.image = detail::pipe_image(*image, decode_image);
    if (const auto depth = answer.find("depth")) {
      if (!view.camera) throw detail::JsonError("depth needs the field 'camera'");
      view.points = points_of(detail::pipe_image(*depth, decode_depth), *view.camera);
    }
    if (view.image.empty() && view.points.empty()) {
      throw detail::JsonError("it has neither 'image' nor 'depth'");
    }
    return view;
  });
}

Stamp PipeRobot::light(int code) {
  return pipe_->ask("light", code,
                    [](const detail::JsonValue& answer) { return detail::stamp_of(answer); });
}

}  // namespace kinecal
