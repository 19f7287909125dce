// Definitions of read_camera_file.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/cameras/read_camera_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/cameras/camera_fields.ipp"
#include "kinecal/files/cameras/image_part.hpp"
#include "kinecal/files/xml/xml_text.ipp"
#include "kinecal/files/yaml/config_map.hpp"
#include "kinecal/files/yaml/yaml_node.hpp"
#include "kinecal/sensors/lens_camera.hpp"

namespace kinecal {

namespace detail {
namespace {

// Keys that people use for a lens distortion.
//
// OpenCV's own samples call it distortion_coefficients, tutorials dist_coeffs, distCoeff,
// distortion, D and so on.  A matrix that looks like a distortion under any other key must not be
// ignored silently:  the calibration of raw images would be wrong by all of the distortion.

/// A key in small letters and digits only: "distCoeffs" and "dist_coeffs" are the same.
[[nodiscard]] std::string plain_key(const std::string& key) {
  std::string plain;
  for (const char c : key) {
    if (c >= 'A' && c <= 'Z') plain += static_cast<char>(c + 32);
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) plain += c;
  }
  return plain;
}

/// True for a well-known key of a distortion: "D", or "distortion" and its short forms with or
/// without "camera" or "lens" before it and "coefficients" or the like after it.
[[nodiscard]] bool is_distortion_key(const std::string& key) {
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
[[nodiscard]] std::vector<double> numbers_in(const YamlNode& value) {
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
[[nodiscard]] bool is_coefficient(const std::string& key, const YamlNode& value) {
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
[[nodiscard]] bool sounds_like_distortion(const std::string& key) {
  const std::string plain = plain_key(key);
  if (plain.find("distan") != std::string::npos || plain.starts_with("undist")) return false;
  for (const char* word : {"dist", "radial", "tangential", "coef"}) {
    if (plain.find(word) != std::string::npos) return true;
  }
  static const std::vector<std::string> known = {"distortion_coefficients", "distortion"};
  return plain == "kc" || nearest_name(key, known).has_value();
}

/// True for a key about a board or a sensor beside the camera: square_size, pixel_size.
[[nodiscard]] bool is_beside_camera(const std::string& key) {
  return has_word(key_words(key),
                  {"board", "chessboard", "checkerboard", "square",  "squares",    "pattern",
                   "grid",  "marker",     "markers",      "tag",     "charuco",    "aruco",
                   "pixel", "sensor",     "squaresize",   "tagsize", "markersize", "roi",
                   "focal", "aspect",     "baseline",     "circle",  "target"});
}

/// Ignores keys of what calibrated the camera: they decide nothing here.
void ignore_beside_camera(ConfigMap& file) {
  for (const ConfigEntry& entry : file.entries()) {
    if (is_beside_camera(entry.key)) (void)file.use(entry.key);
  }
}

/// If the size of the image is missing: an error for each entry that could be it.
/// @param intended  what the format calls it
void refuse_lost_size(const ConfigMap& file, const std::string& intended) {
  for (const ConfigEntry& entry : file.entries()) {
    if (file.is_used(entry.key) || is_beside_camera(entry.key)) continue;
    if (meaning_of_key(entry.key) != KeyMeaning::size) continue;
    file.error(entry.place, "unknown key '" + entry.key +
                                "' looks like the size of the image, which would be lost; write " +
                                intended);
  }
}

/// True for numbers that could be a distortion: 4, 5, 8, 12 or 14, not all integers.
[[nodiscard]] bool could_be_distortion(const std::vector<double>& numbers) {
  constexpr std::array<std::size_t, 5> kSizes = {4, 5, 8, 12, 14};
  return std::find(kSizes.begin(), kSizes.end(), numbers.size()) != kSizes.end() &&
         std::any_of(numbers.begin(), numbers.end(),
                     [](double v) { return v != std::floor(v) && std::abs(v) < 1e3; });
}

/// True for keys of other numbers that OpenCV's programs write: view errors, poses, quaternions.
[[nodiscard]] bool is_of_something_else(const std::string& key) {
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
bool refuse_lost_distortion(ConfigMap& file, const std::vector<std::string>& known,
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

// The formats of camera files.
//
// camera_info   image_width, image_height, camera_name, distortion_model, and matrices
//               {rows, cols, data}: camera_matrix, distortion_coefficients, rectification_matrix,
//               projection_matrix.  The message: width, height, distortion_model and the lists
//               K D R P (ROS 1) or k d r p (ROS 2).
//               Source: ROS wiki, camera_calibration_parsers; sensor_msgs/CameraInfo.
// Kalibr        A map of cameras, cam0, cam1 and so on: camera_model: pinhole,
//               intrinsics: [fu, fv, pu, pv], distortion_model: radtan, equidistant or none,
//               distortion_coeffs: [k1, k2, p1, p2] or [k1, k2, k3, k4], resolution: [width, height].
//               radtan is plumb_bob with k3 = 0.  Or camera_model: ds, the double sphere, with
//               intrinsics: [xi, alpha, fu, fv, pu, pv] and no distortion.
//               Source: Kalibr wiki, YAML formats and supported models.
// OpenCV        %YAML:1.0, image_width, image_height, and !!opencv-matrix {rows, cols, dt, data}:
//               camera_matrix, distortion_coefficients.  Case and underscores of keys vary, and so does
//               the name of the distortion: see read_camera_file.cpp.  Four coefficients are plumb_bob
//               with k3 = 0, five plumb_bob, eight, twelve or fourteen rational_polynomial; with
//               fisheye_model: 1, four are equidistant.  The same in XML, <opencv_storage>.  Stereo files have
//               M1 D1 M2 D2 (sample stereo_calib), also cameraMatrix1, K_left and so on: one is chosen by its name.
//               Source: OpenCV documentation, FileStorage; calib3d, distortion coefficients.

/// Warns if a camera_info describes only a part of the image.
void doubt_image_part(ConfigMap& file, const CameraInfo& camera) {
  ImagePart part{file.number("binning_x", 0.0), file.number("binning_y", 0.0)};
  if (const ConfigEntry* entry = file.find("roi"); entry != nullptr && entry->value.is_map()) {
    ConfigMap roi(entry->value, entry->place, "roi", file.diagnostics());
    part.x = roi.number("x_offset", 0.0), part.y = roi.number("y_offset", 0.0);
    part.width = roi.number("width", 0.0), part.height = roi.number("height", 0.0);
  }
  const std::string doubt = doubt_image_part(part, camera);
  if (!doubt.empty()) file.diagnostics().warning(file.place(), doubt);
}

/// Warns of a camera without distortion; rejects one with the distortion under another key.
/// @param known  keys that were read
void doubt_no_distortion(ConfigMap& file, const CameraKeys& known, const std::string& intended,
                         bool any_name) {
  if (refuse_lost_distortion(file, known, intended, any_name)) return;
  file.warning(file.place(),
               "there is no " + intended + "; the lens is taken to be free of distortion");
}

/// Reads a camera_info file or message.
/// @param file  the top-level map
[[nodiscard]] CameraInfo read_camera_info(ConfigMap& file) {
  CameraInfo camera;
  camera.width = read_camera_size(file, {"image_width", "width"});
  camera.height = read_camera_size(file, {"image_height", "height"});
  const ConfigEntry* model = file.find("distortion_model");
  const bool is_empty = model != nullptr && model->value.is_scalar() && model->value.text.empty();
  if (!is_empty) camera.distortion_model = file.text("distortion_model").value_or("plumb_bob");
  if (const ConfigEntry* d = find_camera_key(file, {"distortion_coefficients", "D", "d"})) {
    camera.d = camera_numbers(file, *d).value_or(std::vector<double>());
  } else if (!is_empty) {
    const std::string intended = file.peek("K")   ? "D"
                                 : file.peek("k") ? "d"
                                                  : "distortion_coefficients";
    doubt_no_distortion(file, {"distortion_model"}, intended, false);
  }
  if (!read_camera_matrix(file, {"camera_matrix", "K", "k"}, camera.k)) {
    file.error(file.place(), "camera_matrix is missing");
  }
  const bool has_r = read_camera_matrix(file, {"rectification_matrix", "R", "r"}, camera.r);
  const bool has_p = read_camera_matrix(file, {"projection_matrix", "P", "p"}, camera.p);
  doubt_image_part(file, camera);
  file.ignore({"camera_name", "header"});
  ignore_beside_camera(file);
  file.report_unknown();  // or camera_matrix would replace a misspelt projection_matrix
  complete_camera(camera, has_r, has_p, file.place(), file.diagnostics());
  return camera;
}

/// True for a camera of Kalibr's camchain: a map with a camera model.
[[nodiscard]] bool is_kalibr_camera(const ConfigEntry& entry) {
  return entry.value.find("camera_model") != nullptr;
}

/// `count` numbers; zeros, and an error, if they are missing or their number differs.
[[nodiscard]] std::vector<double> kalibr_numbers(ConfigMap& camera, const std::string& key,
                                                 std::size_t count) {
  const ConfigEntry* entry = camera.find(key);
  if (entry == nullptr) {
    const CameraKeys wanted = {key};
    for (const ConfigEntry& other : camera.entries()) {
      if (camera.is_used(other.key) || meant_by_key(other.key, wanted).empty()) continue;
      camera.error(other.place,
                   "unknown key '" + other.key + "'" + meant_by_key(other.key, wanted));
      (void)camera.use(other.key);
      return std::vector<double>(count, 0.0);
    }
    camera.error(camera.place(), key + " is missing");
    return std::vector<double>(count, 0.0);
  }
  auto numbers = camera_numbers(camera, *entry);
  if (!numbers) return std::vector<double>(count, 0.0);
  if (numbers->size() != count) {
    camera.error(entry->place, fmt::format("{}, not {}", has_numbers(key, numbers->size()), count));
    numbers->resize(count);
  }
  return *numbers;
}

/// Reports any other than the expected models.
/// @return  the model
[[nodiscard]] std::string expect_kalibr_model(ConfigMap& camera, const std::string& key,
                                              const std::vector<std::string>& expected) {
  const std::string model = camera.required_text(key).value_or("");
  if (!model.empty() && std::find(expected.begin(), expected.end(), model) == expected.end()) {
    camera.error(camera.find(key)->place, fmt::format("{} '{}' is not supported; it must be {}",
                                                      key, model, fmt::join(expected, " or ")));
  }
  return model;
}

/// Reads one camera of Kalibr's camchain.
/// @param camera  its map
[[nodiscard]] CameraInfo read_kalibr_camera(ConfigMap& camera) {
  const std::size_t errors = camera.diagnostics().errors.size();
  const bool is_sphere = expect_kalibr_model(camera, "camera_model", {"pinhole", "ds"}) == "ds";
  const std::string distortion =
      is_sphere
          ? expect_kalibr_model(camera, "distortion_model", {"none"})
          : expect_kalibr_model(camera, "distortion_model", {"radtan", "equidistant", "none"});
  CameraInfo info;
  if (camera.diagnostics().errors.size() > errors) return info;  // numbers of another model
  std::vector<double> f = kalibr_numbers(camera, "intrinsics", is_sphere ? 6 : 4);
  info.d = kalibr_numbers(camera, "distortion_coeffs", distortion == "none" ? 0 : 4);
  info.distortion_model = "plumb_bob";
  if (is_sphere) {
    info.distortion_model = DoubleSphere::kName;
    info.d.assign(f.begin(), f.begin() + 2);
    f.erase(f.begin(), f.begin() + 2);
  } else if (distortion == "equidistant") {
    info.distortion_model = Equidistant::kName;
  } else {
    info.d.resize(5, 0.0);
  }
  info.k = {f[0], 0, f[2], 0, f[1], f[3], 0, 0, 1};
  const std::vector<double> size = kalibr_numbers(camera, "resolution", 2);
  for (const double pixels : size) {
    if (pixels >= 0.0 && pixels <= 1e6 && pixels == std::floor(pixels)) continue;
    camera.error(camera.place(), fmt::format("resolution: {} is not a number of pixels", pixels));
    return info;
  }
  camera.ignore({"rostopic", "T_cn_cnm1", "T_cam_imu", "T_imu_cam", "timeshift_cam_imu",
                 "cam_overlaps", "line_delay"});
  ignore_beside_camera(camera);
  camera.report_unknown();
  info.width = static_cast<int>(size[0]);
  info.height = static_cast<int>(size[1]);
  complete_camera(info, false, false, camera.place(), camera.diagnostics());
  return info;
}

// Cameras in files of OpenCV's FileStorage.

/// The text without OpenCV's first line %YAML:1.0, which is not YAML; keeps line numbers.
[[nodiscard]] std::string without_opencv_header(std::string text) {
  const std::size_t begin = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  const std::string_view line = std::string_view(text).substr(begin);
  if (!line.starts_with("%YAML:") && !line.starts_with("%YAML 1.0")) return text;
  const std::size_t end = std::min(text.find_first_of("\r\n", begin), text.size());
  return text.replace(begin, end - begin, "");
}

[[nodiscard]] bool is_opencv_matrix(const ConfigEntry& entry) {
  return entry.value.is_map() && entry.value.tag.ends_with("opencv-matrix");
}

/// The same of OpenCV's XML: elements are keys, type_id is the tag, a text of several numbers is a list.
[[nodiscard]] YamlNode node_of_xml(const XmlText& file, pugi::xml_node element) {
  YamlNode node;
  node.line = file.place(element).line;
  if (const std::string type = element.attribute("type_id").value(); !type.empty()) {
    node.tag = "!!" + type;
  }
  for (const pugi::xml_node child : element.children()) {
    if (child.type() != pugi::node_element) continue;
    YamlNode& key = node.keys.emplace_back();
    key.kind = YamlNode::Kind::scalar;
    key.line = file.place(child).line;
    key.text = child.name();
    node.items.push_back(node_of_xml(file, child));
  }
  if (!node.keys.empty()) {
    node.kind = YamlNode::Kind::map;
    return node;
  }
  std::istringstream words(element.text().get());
  for (std::string word; words >> word;) {
    YamlNode& item = node.items.emplace_back();
    item.kind = YamlNode::Kind::scalar;
    item.line = node.line;
    item.text = word;
  }
  if (node.items.size() == 1 && std::string_view(element.name()) != "data") {
    return std::move(node.items.front());
  }
  node.kind = node.items.empty() ? YamlNode::Kind::null : YamlNode::Kind::list;
  return node;
}

// Stereo files of OpenCV: M1 D1 M2 D2 of its sample stereo_calib, cameraMatrix1, K_left and so on.

/// A key of one of several cameras.
struct CameraOfKey {
  std::string camera;  ///< "1", "left"; empty: of none
  std::string key;     ///< "camera_matrix": what it is, as a file of one camera calls it
};

[[nodiscard]] CameraOfKey camera_of_key(const std::string& key) {
  const std::string plain = plain_key(key);
  for (const std::string_view camera : {"1", "2", "3", "4", "left", "right", "l", "r"}) {
    for (const bool is_last : {true, false}) {
      if (plain.size() <= camera.size()) continue;
      if (!(is_last ? plain.ends_with(camera) : plain.starts_with(camera))) continue;
      const std::string base =
          is_last ? plain.substr(0, plain.size() - camera.size()) : plain.substr(camera.size());
      static constexpr std::array<std::string_view, 6> kMatrices = {
          "m", "k", "cameramatrix", "mtx", "intrinsics", "intrinsicmatrix"};
      const std::string name(camera);
      if (std::find(kMatrices.begin(), kMatrices.end(), base) != kMatrices.end()) {
        return {name, "camera_matrix"};
      }
      if (is_distortion_key(base)) return {name, "distortion_coefficients"};
      if (base == "p" || base == "projectionmatrix") return {name, "projection_matrix"};
      if (base == "r" || base == "rectificationmatrix") return {name, "rectification_matrix"};
    }
  }
  return {};
}

/// Names of the cameras of a stereo file; empty: it has one camera.
[[nodiscard]] std::vector<std::string> stereo_cameras(const YamlNode& document) {
  std::vector<std::string> cameras;
  for (std::size_t i = 0; i < document.keys.size(); ++i) {
    const auto [camera, key] = camera_of_key(document.keys[i].text);
    const bool is_matrix = document.items[i].tag.ends_with("opencv-matrix");
    const bool is_new = std::find(cameras.begin(), cameras.end(), camera) == cameras.end();
    if (is_matrix && key == "camera_matrix" && is_new) cameras.push_back(camera);
  }
  return cameras;
}

/// One of the cameras of a stereo file, under the keys of a file of one camera.
[[nodiscard]] YamlNode one_of_stereo(const YamlNode& document, const std::string& camera) {
  YamlNode one = document;
  one.keys.clear();
  one.items.clear();
  for (std::size_t i = 0; i < document.keys.size(); ++i) {
    const CameraOfKey of = camera_of_key(document.keys[i].text);
    if (!of.camera.empty() && of.camera != camera) continue;
    one.keys.push_back(document.keys[i]);
    one.items.push_back(document.items[i]);
    if (!of.camera.empty()) one.keys.back().text = of.key;
  }
  return one;
}

/// All keys of a file that equal a wanted one except for case and underscores.
[[nodiscard]] CameraKeys opencv_keys(const ConfigMap& file, const CameraKeys& wanted) {
  CameraKeys keys;
  for (const std::string& key : wanted) {
    for (const ConfigEntry& entry : file.entries()) {
      if (plain_key(entry.key) == plain_key(key)) keys.push_back(entry.key);
    }
  }
  return keys;
}

/// All keys of a file that are well-known for a distortion and have numbers.
[[nodiscard]] CameraKeys opencv_distortion_keys(const ConfigMap& file) {
  CameraKeys keys;
  for (const ConfigEntry& entry : file.entries()) {
    const bool numbers = entry.value.is_map() || entry.value.is_list();
    if (numbers && is_distortion_key(entry.key)) keys.push_back(entry.key);
  }
  return keys;
}

/// Reads a file of OpenCV's FileStorage.
/// @param file  the top-level map
[[nodiscard]] CameraInfo read_opencv_camera(ConfigMap& file) {
  const auto keys = [&](const CameraKeys& wanted) { return opencv_keys(file, wanted); };
  CameraInfo camera;
  camera.width = read_camera_size(file, keys({"image_width"}));
  camera.height = read_camera_size(file, keys({"image_height"}));
  const ConfigEntry* fisheye = find_camera_key(file, keys({"fisheye_model"}));
  const bool is_fisheye = fisheye != nullptr && file.number(fisheye->key, 0.0) != 0.0;
  if (!read_camera_matrix(file, keys({"camera_matrix", "K"}), camera.k)) {
    file.error(file.place(), "camera_matrix is missing");
  }
  const ConfigEntry* d = find_camera_key(file, opencv_distortion_keys(file));
  if (d != nullptr) {
    camera.d = camera_numbers(file, *d).value_or(std::vector<double>());
  } else {
    doubt_no_distortion(file,
                        keys({"camera_matrix", "K", "rectification_matrix", "projection_matrix"}),
                        "distortion_coefficients", true);
  }
  const std::size_t n = camera.d.size();
  const bool is_known =
      is_fisheye ? n == 4 : n == 0 || n == 4 || n == 5 || n == 8 || n == 12 || n == 14;
  if (!is_known) {
    file.error(d != nullptr ? d->place : file.place(),
               has_numbers(d != nullptr ? d->key : "distortion_coefficients", n) +
                   (is_fisheye ? "; a fisheye_model has 4" : "; OpenCV has 4, 5, 8, 12 or 14"));
  }
  if (n < 5 && !is_fisheye) camera.d.resize(5, 0.0);
  camera.distortion_model = is_fisheye ? "equidistant"
                            : n >= 8   ? "rational_polynomial"
                                       : "plumb_bob";
  if (camera.width == 0 || camera.height == 0) {
    refuse_lost_size(file, "image_width and image_height");
  }
  const bool has_r = read_camera_matrix(file, keys({"rectification_matrix"}), camera.r);
  const bool has_p = read_camera_matrix(file, keys({"projection_matrix"}), camera.p);
  complete_camera(camera, has_r, has_p, file.place(), file.diagnostics());
  return camera;
}

/// One of the cameras of a camchain, by name; without a name, the only one.
[[nodiscard]] CameraInfo read_camchain(const ConfigMap& file, const std::string& which) {
  std::vector<std::string> names;
  const ConfigEntry* chosen = nullptr;
  for (const ConfigEntry& entry : file.entries()) {
    if (!is_kalibr_camera(entry)) continue;
    names.push_back(entry.key);
    if (which.empty() || entry.key == which) chosen = &entry;
  }
  if (which.empty() && names.size() > 1) {
    file.error(file.place(), "there are several cameras, " + names.front() + " to " + names.back() +
                                 "; choose one: " + file.place().file + ":" + names.front());
    return {};
  }
  if (chosen == nullptr) {
    file.error(file.place(), "there is no camera '" + which + "'" + did_you_mean(which, names));
    return {};
  }
  auto camera = file.map(*chosen, chosen->key);
  return camera ? read_kalibr_camera(*camera) : CameraInfo{};
}

/// The map of a camera file; of several messages, the first.
[[nodiscard]] YamlNode camera_document(const std::string& path) {
  std::string text = read_yaml_text(path);
  const std::size_t first = text.find_first_not_of("\xEF\xBB\xBF \t\r\n");
  if (first != std::string::npos && text[first] == '<') {
    const XmlText xml(std::move(text), path, {"a camera file of OpenCV in XML", "opencv_storage"});
    return node_of_xml(xml, xml.root());
  }
  for (YamlNode& document : parse_yaml(without_opencv_header(std::move(text)), path)) {
    if (document.is_map()) return std::move(document);
    if (!document.is_null()) break;
  }
  throw InputError(path + ": is not a camera file: not a map of names and values");
}

}  // namespace
}  // namespace detail

CameraInfo read_camera_file(const std::string& path, Diagnostics& diagnostics,
                            const std::string& which) {
  detail::YamlNode document = detail::camera_document(path);
  std::string left = which;  // of the name, for a file of one camera
  if (const std::vector<std::string> cameras = detail::stereo_cameras(document); !cameras.empty()) {
    const bool is_known = std::find(cameras.begin(), cameras.end(), which) != cameras.end();
    if (!is_known && !(which.empty() && cameras.size() == 1)) {
      diagnostics.error({path, 0},
                        which.empty()
                            ? fmt::format("there are several cameras, {}; choose one: {}:{}",
                                          fmt::join(cameras, ", "), path, cameras.front())
                            : "there is no camera '" + which + "'" + did_you_mean(which, cameras) +
                                  fmt::format("; there are {}", fmt::join(cameras, ", ")));
      return {};
    }
    document = detail::one_of_stereo(document, which.empty() ? cameras.front() : which);
    left.clear();
  }
  detail::ConfigMap file(document, {path, 0}, "", diagnostics);
  const std::size_t errors = diagnostics.errors.size();
  const auto any = [&](bool (*is)(const detail::ConfigEntry&)) {
    return std::any_of(file.entries().begin(), file.entries().end(), is);
  };
  CameraInfo camera;
  if (any(detail::is_kalibr_camera)) {
    camera = detail::read_camchain(file, which);
  } else if (!left.empty()) {
    file.error({path, 0},
               "has a single camera and there is no '" + which + "'; leave the name out");
  } else if (any(detail::is_opencv_matrix)) {
    camera = detail::read_opencv_camera(file);
  } else if (file.peek("camera_matrix") || file.peek("K") || file.peek("k")) {
    camera = detail::read_camera_info(file);
  } else {
    file.error({path, 0},
               "is not a camera file: it has neither camera_matrix (camera_info, OpenCV), nor K or "
               "k (a message), nor a camera_model below cam0 (Kalibr)");
  }
  if (diagnostics.errors.size() != errors) return camera;
  int k_line = 0;
  for (const char* key : {"camera_matrix", "K", "k"}) {
    if (const detail::ConfigEntry* k = file.peek(key)) k_line = k->place.line;
  }
  detail::check_camera(camera, {path, 0}, diagnostics, k_line);
  return camera;
}

CameraInfo read_camera_argument(const std::string& argument, Diagnostics& diagnostics) {
  const std::size_t colon = argument.rfind(':');
  if (colon == std::string::npos || std::filesystem::exists(argument)) {
    return read_camera_file(argument, diagnostics);
  }
  return read_camera_file(argument.substr(0, colon), diagnostics, argument.substr(colon + 1));
}

}  // namespace kinecal
