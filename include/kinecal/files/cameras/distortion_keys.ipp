// Keys that people use for a lens distortion.
//
// OpenCV's own samples call it distortion_coefficients, tutorials dist_coeffs, distCoeff,
// distortion, D and so on.  A matrix that looks like a distortion under any other key must not be
// ignored silently:  the calibration of raw images would be wrong by all of the distortion.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/yaml/config_map.ipp"

namespace kinecal::detail {

/// A key in small letters and digits only: "distCoeffs" and "dist_coeffs" are the same.
[[nodiscard]] inline std::string plain_key(const std::string& key) {
  std::string plain;
  for (const char c : key) {
    if (c >= 'A' && c <= 'Z') plain += static_cast<char>(c + 32);
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) plain += c;
  }
  return plain;
}

/// True for a well-known key of a distortion: "D", or "distortion" and its short forms with or
/// without "camera" or "lens" before it and "coefficients" or the like after it.
[[nodiscard]] inline bool is_distortion_key(const std::string& key) {
  const std::string plain = plain_key(key);
  if (plain == "d") return true;
  std::string_view rest = plain;
  for (const std::string_view before : {"camera", "lens", "cam", "cv"}) {
    if (!rest.starts_with(before)) continue;
    rest.remove_prefix(before.size());
    break;
  }
  for (const std::string_view word : {"distortions", "distortion", "distort", "dist"}) {
    if (!rest.starts_with(word)) continue;
    rest.remove_prefix(word.size());
    static constexpr std::string_view kEnds[] = {
        "",     "coefficients", "coefficient", "coeffs",    "coeff", "coefs",
        "coef", "parameters",   "params",      "parameter", "param", "vector",
        "vec",  "matrix",       "mat",         "array",     "values"};
    return std::find(std::begin(kEnds), std::end(kEnds), rest) != std::end(kEnds);
  }
  return false;
}

/// The numbers of a list or a matrix, row after row; empty for anything else.
[[nodiscard]] inline std::vector<double> numbers_in(const YamlNode& value) {
  const YamlNode* list = value.is_map() ? value.find("data") : &value;
  std::vector<double> numbers;
  if (list == nullptr || !list->is_list()) return numbers;
  for (const YamlNode& item : list->items) {
    const std::vector<double> inside = numbers_in(item);
    numbers.insert(numbers.end(), inside.begin(), inside.end());
    if (const auto number = config_number(item)) numbers.push_back(*number);
  }
  return numbers;
}

/// True for one coefficient by its usual name, k1 to k6, p1, p2, also as Camera.k1; or for a map with
/// one.
[[nodiscard]] inline bool is_coefficient(const std::string& key, const YamlNode& value) {
  for (std::size_t i = 0; i < value.keys.size(); ++i) {
    if (is_coefficient(value.keys[i].text, value.items[i])) return true;
  }
  const std::string plain = plain_key(key.substr(key.find_last_of("._-/") + 1));
  const bool named =
      plain.size() == 2 &&
      ((plain[0] == 'k' && plain[1] >= '1' && plain[1] <= '6') || plain == "p1" || plain == "p2");
  const auto number = config_number(value);
  return named && number && *number != 0.0;
}

/// True for a key that sounds like a distortion: "distorsion", "kc", "radial".
[[nodiscard]] inline bool sounds_like_distortion(const std::string& key) {
  const std::string plain = plain_key(key);
  if (plain.find("distan") != std::string::npos || plain.starts_with("undist")) return false;
  for (const char* word : {"dist", "radial", "tangential", "coef"}) {
    if (plain.find(word) != std::string::npos) return true;
  }
  static const std::vector<std::string> known = {"distortion_coefficients", "distortion"};
  return plain == "kc" || nearest_name(key, known).has_value();
}

/// True for a key about a board or a sensor beside the camera: square_size, pixel_size.
[[nodiscard]] inline bool is_beside_camera(const std::string& key) {
  return has_word(key_words(key),
                  {"board", "chessboard", "checkerboard", "square",  "squares",    "pattern",
                   "grid",  "marker",     "markers",      "tag",     "charuco",    "aruco",
                   "pixel", "sensor",     "squaresize",   "tagsize", "markersize", "roi",
                   "focal", "aspect",     "baseline",     "circle",  "target"});
}

/// Ignores keys of what calibrated the camera: they decide nothing here.
inline void ignore_beside_camera(ConfigMap& file) {
  for (const ConfigEntry& entry : file.entries()) {
    if (is_beside_camera(entry.key)) (void)file.use(entry.key);
  }
}

/// If the size of the image is missing: an error for each entry that could be it.
/// @param intended  what the format calls it
inline void refuse_lost_size(const ConfigMap& file, const std::string& intended) {
  for (const ConfigEntry& entry : file.entries()) {
    if (file.is_used(entry.key) || is_beside_camera(entry.key)) continue;
    if (meaning_of_key(entry.key) != KeyMeaning::size) continue;
    file.error(entry.place, "unknown key '" + entry.key +
                                "' looks like the size of the image, which would be lost; write " +
                                intended);
  }
}

/// True for numbers that could be a distortion: 4, 5, 8, 12 or 14, not all integers.
[[nodiscard]] inline bool could_be_distortion(const std::vector<double>& numbers) {
  constexpr std::array<std::size_t, 5> kSizes = {4, 5, 8, 12, 14};
  return std::find(kSizes.begin(), kSizes.end(), numbers.size()) != kSizes.end() &&
         std::any_of(numbers.begin(), numbers.end(),
                     [](double v) { return v != std::floor(v) && std::abs(v) < 1e3; });
}

/// True for keys of other numbers that OpenCV's programs write: view errors, poses, quaternions.
[[nodiscard]] inline bool is_of_something_else(const std::string& key) {
  const std::string plain = plain_key(key);
  for (const char* word :
       {"err", "rms", "rotation", "translation", "rvec", "tvec", "quat", "orient", "pose",
        "extrinsic", "point", "roi", "size", "stddev", "deviation"}) {
    if (plain.find(word) != std::string::npos) return true;
  }
  return false;
}

/// If there is no distortion: an error for each entry that could be one.
/// @param known     keys that were read, in any spelling
/// @param intended  the key of the distortion in this format
/// @param any_name  a matrix of the right size counts under any key
/// @returns         true if there is such an entry
inline bool refuse_lost_distortion(ConfigMap& file, const std::vector<std::string>& known,
                                   const std::string& intended, bool any_name) {
  bool found = false;
  for (const ConfigEntry& entry : file.entries()) {
    if (std::find(known.begin(), known.end(), entry.key) != known.end()) continue;
    const std::vector<double> numbers = numbers_in(entry.value);
    const bool sounds = sounds_like_distortion(entry.key) && !numbers.empty();
    const bool fits = any_name && could_be_distortion(numbers) && !is_of_something_else(entry.key);
    if (!sounds && !fits && !is_coefficient(entry.key, entry.value)) continue;
    found = true;
    (void)file.use(entry.key);  // reported below
    file.error(entry.place,
               "unknown key '" + entry.key +
                   "': is it the distortion of the lens, which would be lost?  Then " +
                   (is_coefficient(entry.key, entry.value) ? "list the coefficients under '"
                                                           : "call it '") +
                   intended + "', else remove it or give the distortion as well");
  }
  return found;
}

}  // namespace kinecal::detail
