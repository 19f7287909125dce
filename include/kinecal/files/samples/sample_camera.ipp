// Builds the camera of an observation from `ext_camera_info`, with its lists and parameters.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <concepts>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/cameras/camera_info.hpp"
#include "kinecal/files/cameras/image_part.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/samples/feature_id_parameters.ipp"
#include "kinecal/files/samples/sample_schema.ipp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// Errors in a file of samples, or in a piece of it.
struct SampleErrors {
  /// Largest number listed per file; the rest usually have the same cause.
  static constexpr std::size_t kMost = 20;

  struct Message {
    int line;
    std::string text;
  };
  std::vector<Message> errors, warnings;

  [[nodiscard]] bool too_many() const { return errors.size() > kMost; }
  void add(int line, std::string text) {
    if (!too_many()) errors.push_back({line, std::move(text)});
  }
  void warn(int line, std::string text) { warnings.push_back({line, std::move(text)}); }
  /// Warns of something that probably repeats in every sample.
  void warn_once(int line, std::string text) {
    for (const Message& known : warnings) {
      if (known.text == text) return;
    }
    warn(line, std::move(text));
  }
};

inline void report(const SampleErrors& all, const std::string& file, Diagnostics& diagnostics) {
  for (const auto& [line, text] : all.warnings) diagnostics.warning({file, line}, text);
  for (std::size_t i = 0; i < all.errors.size(); ++i) {
    const auto& [line, text] = all.errors[i];
    const bool last = i == SampleErrors::kMost;
    diagnostics.error({file, line}, last ? fmt::format("more than {} errors; this one and those "
                                                       "that follow are not listed",
                                                       SampleErrors::kMost)
                                         : text);
  }
}

/// A text of the file for a message: shortened, without control characters.
[[nodiscard]] inline std::string shown(std::string_view text) {
  if (text == "...") {
    return "'...', for values left out ('ros2 topic echo --full-length' prints them all),";
  }
  std::string s(text.substr(0, 40));
  for (char& c : s) c = static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  return "'" + s + (text.size() > 40 ? "...'" : "'");
}

class SampleCamera {
 public:
  /// A map or list begins.  @param line  of its first character, from 1
  void begin(SampleNode node, int line) {
    if (node == SampleNode::camera_info) k_ = r_ = p_ = {0, line};
    if (node == SampleNode::k) k_ = {0, line};
    if (node == SampleNode::r) r_ = {0, line};
    if (node == SampleNode::p) p_ = {0, line};
    if (node == SampleNode::parameter) parameter_ = {{}, "0", line};
  }

  void word(SampleNode node, int line, std::string_view text) {
    if (node == SampleNode::distortion_model) info_.distortion_model = text;
    if (node == SampleNode::parameter_name) parameter_.name = text;
    if (node != SampleNode::parameter_value) return;
    parameter_.value = text;
    parameter_.line = line;
  }

  void number(SampleNode node, int line, double value, SampleErrors& errors) {
    if (node == SampleNode::height) info_.height = pixels("height", line, value, errors);
    if (node == SampleNode::width) info_.width = pixels("width", line, value, errors);
    if (node == SampleNode::d_item) info_.d.push_back(value);
    if (node == SampleNode::k_item) append(info_.k, k_, value);
    if (node == SampleNode::r_item) append(info_.r, r_, value);
    if (node == SampleNode::p_item) append(info_.p, p_, value);
    if (node == SampleNode::binning_x) part_.binning_x = value;
    if (node == SampleNode::binning_y) part_.binning_y = value;
    if (node == SampleNode::roi_x) part_.x = value;
    if (node == SampleNode::roi_y) part_.y = value;
    if (node == SampleNode::roi_height) part_.height = value;
    if (node == SampleNode::roi_width) part_.width = value;
  }

  [[nodiscard]] const ImagePart& part() const { return part_; }

  /// Only z_offset_mm, z_scaling and ids matter; others may have any value.  Until here the value
  /// is text:  moving its decimal point converts millimetres to metres without a rounding error.
  void end_parameter(SampleErrors& errors) {
    if (parameter_.name.starts_with(kFeatureId)) {
      const std::string wrong = ids_.add(parameter_.name, number_from_yaml(parameter_.value));
      if (!wrong.empty()) errors.add(parameter_.line, wrong);
      return;
    }
    const bool offset = parameter_.name == "z_offset_mm";
    if (!offset && parameter_.name != "z_scaling") return;
    const auto value =
        offset ? metres_from_millimetres(parameter_.value) : number_from_yaml(parameter_.value);
    if (!value) {
      errors.add(parameter_.line,
                 fmt::format("{}: {} is not a number", parameter_.name, shown(parameter_.value)));
    }
    (offset ? info_.z_offset : info_.z_scaling) = value.value_or(0.0);
  }

  /// The feature ids in its parameters.
  [[nodiscard]] const FeatureIdParameters& ids() const { return ids_; }

  /// @param where  returns "sample at line 37, sensor 'camera'"
  /// @return       nullopt for a sensor that is not a camera, or if a list has the wrong size
  template <std::invocable Where>
  [[nodiscard]] std::optional<CameraInfo> take(int line, const Where& where, SampleErrors& errors) {
    const bool blank = is_blank(info_);
    const bool k = has_size("K", k_, 9, true, where, errors);
    const bool r = has_size("R", r_, 9, true, where, errors);
    const bool only_size = k_.size == 0 && r_.size == 0 && info_.d.empty();  // nobody knows more
    const bool p = has_size("P", p_, 12, blank || only_size, where, errors);
    if (k && r && blank && (info_.z_offset != 0.0 || info_.z_scaling != 1.0)) {
      errors.warn(line, where() +
                            ": z_offset_mm and z_scaling are not used, because there is no "
                            "camera_info or it is all zeros");
    }
    if (!k || !r || !p || blank) return std::nullopt;
    return std::move(info_);
  }

 private:
  struct List {
    std::size_t size = 0;
    int line = 0;  ///< of its first number, or of camera_info if it is missing
  };
  struct Parameter {
    std::string name, value;
    int line = 0;
  };

  [[nodiscard]] static int pixels(const char* name, int line, double value, SampleErrors& errors) {
    if (value >= 0.0 && value <= std::numeric_limits<int>::max() && value == std::floor(value)) {
      return static_cast<int>(value);
    }
    errors.add(line, fmt::format("{}: {} is not a number of pixels", name, value));
    return 0;
  }

  template <std::size_t N>
  static void append(std::array<double, N>& values, List& list, double value) {
    if (list.size < N) values[list.size] = value;
    ++list.size;
  }

  /// @param may_be_empty  true if the list may be empty or missing
  template <std::invocable Where>
  [[nodiscard]] static bool has_size(const char* name, const List& list, std::size_t size,
                                     bool may_be_empty, const Where& where, SampleErrors& errors) {
    if (list.size == size || (list.size == 0 && may_be_empty)) return true;
    errors.add(list.line, fmt::format("{}: {} of camera_info has {} numbers, not {}", where(), name,
                                      list.size, size));
    return false;
  }

  CameraInfo info_;
  List k_, r_, p_;
  ImagePart part_;
  Parameter parameter_;
  FeatureIdParameters ids_;
};

}  // namespace kinecal::detail
