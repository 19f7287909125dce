// A simulated robot of this process behind the Foxglove bridge of bridge_server.hpp, which asks it for
// joint states and views (tests/robots/server/remote.mjs).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <thread>

#include "kinecal/files/checksum.hpp"
#include "kinecal/files/json/json_text.hpp"
#include "kinecal/files/json/json_value.hpp"
#include "kinecal/robots/child_process.hpp"
#include "kinecal/study/simulated_robot.hpp"
#include "support/bridge_server.hpp"

namespace kinecal::test {

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
        if (line)
          process_.write_line(detail::json_text(answer(detail::JsonValue::parse(*line))), kLimit);
      }
    } catch (const std::exception& error) {
      ADD_FAILURE() << "the robot behind the bridge: " << error.what();
    }
  }

  [[nodiscard]] detail::Json answer(const detail::JsonValue& request) {
    if (const auto joints = request.find("joints")) {
      const MeasuredJoints now = robot_.next_joints(Stamp(joints->integer("after")));
      return {{"stamp", now.stamp.count()}, {"names", now.names}, {"positions", now.positions}};
    }
    if (const auto view = request.find("view")) {
      const View seen = robot_.next_view(Stamp(view->integer("after")));
      const CameraInfo& camera = seen.camera.value();
      return {{"stamp", seen.stamp.count()},
              {"frame", seen.frame},
              {"width", seen.points.width},
              {"height", seen.points.height},
              {"points", base64(cloud_bytes(seen))},
              {"k", camera.k},
              {"p", camera.p}};
    }
    if (request.find("light")) {
      return {{"stamp", robot_.light(static_cast<int>(request.integer("light"))).count()}};
    }
    move(request.at("move"));
    return detail::Json::object();
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

  SimulatedRobot& robot_;
  detail::ChildProcess process_;
  std::string url_;
  Positions goals_;
  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

}  // namespace kinecal::test
