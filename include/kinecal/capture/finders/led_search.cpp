// Definitions of led_search.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/led_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kinecal/capture/finders/surface_point.hpp"
#include "kinecal/capture/finders/view_checks.hpp"
#include "kinecal/text/reading.hpp"

namespace kinecal {
namespace detail {
namespace {

/// The pixel of a point in front of a camera, using P.
PixelCircle led_circle(const CameraInfo& camera, const Vector3<double>& p, double radius) {
  const double z = p.z();
  return {camera.p[0] * p.x() / z + camera.p[2], camera.p[5] * p.y() / z + camera.p[6],
          camera.p[0] * radius / z};
}

/// True if a part of the circle is in the image.
bool is_in_part(const PixelCircle& circle, const GrayImage& image) {
  const double u = std::clamp(circle.u, 0.0, image.width - 1.0);
  const double v = std::clamp(circle.v, 0.0, image.height - 1.0);
  return std::hypot(circle.u - u, circle.v - v) <= circle.radius;
}

}  // namespace
}  // namespace detail

LedSearch::LedSearch(const LedFinder& finder, View first, const View& second)
    : finder_(finder), dark_(std::move(first)), leds_(finder.leds.size()) {
  if (finder.leds.empty()) refusal_ = "no LED is given";
  for (std::size_t i = 0; i < leds_.size() && refusal_.empty(); ++i) {
    if (finder.leds[i].code == 0) refusal_ = finder.called(i) + " has code 0, which means all off";
  }
  if (refusal_.empty()) refusal_ = view_problem(dark_);
  if (refusal_.empty()) refusal_ = view_problem(second);
  if (!refusal_.empty()) return;
  motion_.add(dark_.image, second.image);
  dark_ = second;
  if (!finder.frame_T_camera) return;
  frame_T_camera_ = pose_in({finder.frame, finder.frame_T_camera}, dark_, refusal_);
  for (std::size_t i = 0; frame_T_camera_ && i < leds_.size(); ++i) expect(i);
}

/// The expected position of an LED from the robot model.
void LedSearch::expect(std::size_t led) {
  const Vector3<double> p = frame_T_camera_->inverse() * finder_.leds[led].position;
  Tracked& tracked = leds_[led];
  if (p.norm() <= finder_.max_error) return;  // anywhere
  if (p.z() + finder_.max_error <= 0.0) {
    tracked.hopeless = "it is expected behind the camera";
  } else if (p.z() > finder_.max_error) {
    tracked.where = detail::led_circle(*dark_.camera, p, finder_.max_error);
    if (!detail::is_in_part(*tracked.where, dark_.image)) {
      tracked.hopeless = "it is expected outside of the image";
    }
  }
}

std::string LedSearch::view_problem(const View& view) const {
  std::string problem = image_and_depth_problem(view);
  if (!problem.empty()) return problem;
  if (view.image.width == dark_.image.width && view.image.height == dark_.image.height) return "";
  return "views differ in size: " + std::to_string(dark_.image.width) + " x " +
         std::to_string(dark_.image.height) + " pixels, then " + std::to_string(view.image.width) +
         " x " + std::to_string(view.image.height);
}

std::optional<std::size_t> LedSearch::next() const {
  if (!refusal_.empty() || switches_ + 2 > finder_.max_iterations) return std::nullopt;
  std::optional<std::size_t> least;
  for (std::size_t i = 0; i < leds_.size(); ++i) {
    const Tracked& led = leds_[i];
    const int pulses = led.difference.pulses();
    if (!led.hopeless.empty() || (pulses > 0 && led.spot.problem.empty())) continue;
    if (!least || pulses < leds_[*least].difference.pulses()) least = i;
  }
  return least;
}

void LedSearch::pulse(std::size_t led, const View& lit, View dark) {
  refusal_ = image_problem(lit);
  if (refusal_.empty() &&
      (lit.image.width != dark_.image.width || lit.image.height != dark_.image.height)) {
    refusal_ = "views differ in size";
  }
  if (refusal_.empty()) refusal_ = view_problem(dark);
  if (!refusal_.empty()) return;
  Tracked& tracked = leds_[led];
  tracked.difference.add(dark_.image, lit.image, dark.image);
  tracked.spot = tracked.difference.spot(finder_.threshold, tracked.where);
  motion_.add(dark_.image, dark.image);
  dark_ = std::move(dark);
  switches_ += 2;
}

/// Why a light is doubtful: the image changes around it while nothing is switched.
std::string LedSearch::motion_at(const LedSpot& spot) const {
  constexpr int kAround = 20, kOwnLight = 2;  // pixels
  constexpr double kMostMoved = 0.05;
  const double moved = motion_.share(spot.box.grown(kAround), spot.box.grown(kOwnLight));
  if (moved <= kMostMoved) return "";
  return "the image around it moves: " + std::to_string(static_cast<int>(100.0 * moved)) +
         " % of the pixels change while nothing is switched";
}

/// Why an LED is not clear, as far as the rest of the image explains it.
std::string LedSearch::weak(std::size_t led) const {
  constexpr double kMostMoved = 0.02;
  const Tracked& tracked = leds_[led];
  const double moved = motion_.share({0, 0, dark_.image.width - 1, dark_.image.height - 1});
  if (moved > kMostMoved) {
    return tracked.spot.problem +
           "; the image moves: " + std::to_string(static_cast<int>(100.0 * moved)) +
           " % of the pixels change while nothing is switched";
  }
  if (!tracked.where) return tracked.spot.problem;
  const LedSpot other = tracked.difference.spot(finder_.threshold);
  if (!other.problem.empty()) return tracked.spot.problem;
  const double away = std::hypot(other.u - tracked.where->u, other.v - tracked.where->v);
  return "it lights " + std::to_string(std::lround(away)) + " pixels from where the robot's model" +
         " has it; at most " + std::to_string(std::lround(tracked.where->radius)) + " are " +
         reading(finder_.max_error, "m");
}

/// The point of an LED, or why it is missing.
std::string LedSearch::place(std::size_t led, Vector3<double>& p_camera) const {
  const Tracked& tracked = leds_[led];
  if (!tracked.hopeless.empty()) return tracked.hopeless;
  if (tracked.difference.pulses() < 2) {
    return "it was not switched on twice within max_iterations " +
           std::to_string(finder_.max_iterations);
  }
  if (!tracked.spot.problem.empty()) return weak(led);
  std::string moves = motion_at(tracked.spot);
  if (!moves.empty()) return moves;
  const auto p = surface_point(dark_, tracked.spot.u, tracked.spot.v);
  if (!p) return "there is no depth near it";
  p_camera = *p;
  if (!frame_T_camera_) return "";
  const double error = (*frame_T_camera_ * p_camera - finder_.leds[led].position).norm();
  if (error <= finder_.max_error) return "";
  return "it is " + reading(error, "m") + " from where the robot's model has it; max_error is " +
         reading(finder_.max_error, "m");
}

Found LedSearch::found() const {
  if (!refusal_.empty()) return refused(refusal_);
  Found result;
  std::vector<std::string> problems;
  std::vector<PlacedLed> placed;
  for (std::size_t i = 0; i < leds_.size(); ++i) {
    Vector3<double> p;
    const std::string problem = place(i, p);
    if (problem.empty()) placed.push_back({i, p});
    if (!problem.empty()) problems.push_back(finder_.called(i) + ": " + problem);
  }
  for (std::string& why : drop_inconsistent(finder_, placed)) problems.push_back(std::move(why));
  for (const std::string& why : problems)
    result.refusal += (result.refusal.empty() ? "" : "; ") + why;
  if (placed.empty()) return result;
  Observation camera{finder_.camera_sensor, {}, dark_.camera}, chain{finder_.chain_sensor, {}, {}};
  for (const auto& [led, p] : placed) {
    const auto id = static_cast<int>(led);
    camera.features.push_back({dark_.frame, p, {}, {}, id});
    chain.features.push_back({finder_.frame, finder_.leds[led].position, {}, {}, id});
    result.marks.push_back({leds_[led].spot.u, leds_[led].spot.v, std::to_string(led)});
  }
  result.observations = {camera, chain};
  return result;
}

}  // namespace kinecal
