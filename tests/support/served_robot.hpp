// A simulated robot of this process behind the Foxglove bridge of bridge_server.hpp, which asks it for
// joint states and views (tests/robots/server/remote.mjs).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>

#include "kinecal/robots/child_process.hpp"
#include "kinecal/robots/json_value.hpp"
#include "kinecal/study/simulated_robot.hpp"
#include "support/bridge_server.hpp"

namespace kinecal::test {

/// Bytes as text.
inline std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t at = i + k;
      three = three << 8 | (at < bytes.size() ? static_cast<unsigned char>(bytes[at]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : kDigits[three >> (18 - 6 * k) & 63U];
    }
  }
  return text;
}

/// Points and gray colours of a view as four floats each, as PointCloud2 has them.
inline std::string cloud_bytes(const View& view) {
  std::string bytes;
  for (std::size_t i = 0; i < view.points.pixels.size(); ++i) {
    const Vector3<float>& p = view.points.pixels[i];
    const std::uint32_t gray = view.image.pixels[i] * 0x010101U;
    char point[16];
    std::memcpy(point, p.data(), 12);
    std::memcpy(point + 12, &gray, 4);
    bytes.append(point, 16);
  }
  return bytes;
}

template <class Numbers>
std::string json_numbers(const Numbers& numbers) {
  std::ostringstream text;
  text.precision(17);
  for (const double number : numbers) text << (text.tellp() > 0 ? ", " : "[") << number;
  return text.str() + "]";
}

/// A bridge and the robot behind it; both end with this object.
class ServedRobot {
 public:
  /// @param robot    must outlive this, and is used by no one else
  /// @param options  more JSON for server.mjs: {"encoding": "cdr", "camera": "/head_camera"}
  ServedRobot(SimulatedRobot& robot, const std::string& options)
      : robot_(robot), process_(server_command(R"({"remote": true, )" + options.substr(1))) {
    url_ = url_of(process_);
    thread_ = std::thread([this] { serve(); });
  }
  ~ServedRobot() {
    ended_ = true;
    thread_.join();
  }

  [[nodiscard]] const std::string& url() const { return url_; }

 private:
  void serve() {
    constexpr std::chrono::milliseconds kStep{50};
    constexpr std::chrono::seconds kLimit{20};
    try {
      while (!ended_) {
        const auto line = process_.read_line(kStep);
        if (line) process_.write_line(answer(detail::JsonValue::parse(*line)), kLimit);
      }
    } catch (const std::exception& error) {
      ADD_FAILURE() << "the robot behind the bridge: " << error.what();
    }
  }

  [[nodiscard]] std::string answer(const detail::JsonValue& request) {
    if (const auto joints = request.find("joints")) {
      const MeasuredJoints now = robot_.next_joints(Stamp(joints->integer("after")));
      std::string names;
      for (const std::string& name : now.names) {
        names += (names.empty() ? "" : ", ") + detail::json_text(name);
      }
      return stamped(now.stamp) + R"(, "names": [)" + names + R"(], "positions": )" +
             json_numbers(now.positions) + "}";
    }
    if (const auto view = request.find("view")) {
      const View seen = robot_.next_view(Stamp(view->integer("after")));
      const CameraInfo& camera = seen.camera.value();
      return stamped(seen.stamp) + R"(, "frame": )" + detail::json_text(seen.frame) +
             R"(, "width": )" + std::to_string(seen.points.width) + R"(, "height": )" +
             std::to_string(seen.points.height) + R"(, "points": ")" + base64(cloud_bytes(seen)) +
             R"(", "k": )" + json_numbers(camera.k) + R"(, "p": )" + json_numbers(camera.p) + "}";
    }
    if (request.find("light")) {
      return stamped(robot_.light(static_cast<int>(request.integer("light")))) + "}";
    }
    move(request.find("move").value());
    return "{}";
  }

  /// Controllers move their joints at the same time; the robot is given the goals of all.
  void move(const detail::JsonValue& goal) {
    const std::vector<std::string> names = goal.texts("names");
    const std::vector<double> positions = goal.numbers("positions");
    for (std::size_t i = 0; i < names.size(); ++i) goals_[names[i]] = positions[i];
    JointTarget target;
    for (const auto& [name, position] : goals_) {
      target.names.push_back(name);
      target.positions.push_back(position);
    }
    robot_.move(target);
  }

  [[nodiscard]] static std::string stamped(Stamp stamp) {
    return R"({"stamp": )" + std::to_string(stamp.count());
  }

  SimulatedRobot& robot_;
  detail::ChildProcess process_;
  std::string url_;
  Positions goals_;
  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

}  // namespace kinecal::test
