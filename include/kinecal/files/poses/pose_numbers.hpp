// A pose as rows of numbers: position and rotation in the form that controllers and programs write.
//
//   quaternion_xyzw    x y z qx qy qz qw            ROS, most programs
//   quaternion_wxyz    x y z qw qx qy qz
//   rotation_vector    x y z rx ry rz               axis times angle
//   matrix             r11 r12 r13 x r21 ... z      3 x 4 by rows; with 0 0 0 1 at the end, 4 x 4
//   fixed_xyz ...      x y z a b c                  turns by a, b, c about axes that stand still
//   euler_zyx ...      x y z a b c                  ... about axes that turn along
//   ur                 rotation_vector              metres, radians
//   abb                quaternion_wxyz              millimetres
//   kuka               euler_zyx (A B C)            millimetres, degrees
//   fanuc, yaskawa, fairino, techman, dobot, elite
//                      fixed_xyz                    millimetres, degrees
//   jaka               fixed_xyz                    millimetres, radians
//   aubo               fixed_xyz                    metres, radians
//   kinova             fixed_xyz                    metres, degrees
//   nachi              euler_zyx (R P Y)            millimetres, degrees
//   staubli            euler_xyz (RX RY RZ)         millimetres, degrees
//   doosan, kawasaki   euler_zyz (A B C, O A T)     millimetres, degrees
//
// `rpy` is fixed_xyz: roll, pitch, yaw of a URDF.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/geometry/pose.hpp"

namespace kinecal {

/// The form of a rotation.
enum class RotationForm : std::uint8_t {
  quaternion_xyzw,
  quaternion_wxyz,
  rotation_vector,
  matrix,
  fixed_axes,  ///< three angles about axes that stand still
  euler        ///< three angles about axes that turn along
};

/// The form of a pose in numbers.
struct PoseForm {
  RotationForm rotation = RotationForm::quaternion_xyzw;  ///< after the position, or a matrix
  std::string axes = {};                                  ///< of the angles: "zyx"
  bool millimetres = false;                               ///< else metres
  bool degrees = false;                                   ///< of angles; else radians
  bool inverse = false;  ///< the numbers are those of the inverse: base in flange

  /// True if the rotation is in angles, so that `degrees` matters.
  [[nodiscard]] bool has_angles() const {
    return rotation >= RotationForm::rotation_vector && rotation != RotationForm::matrix;
  }
  /// True for a number of columns that the form has.
  [[nodiscard]] bool has_size(std::size_t numbers) const;
  /// "6 columns: x y z rx ry rz"
  [[nodiscard]] std::string columns_text() const;
};

/// The form with this name: "kuka"; nullopt if absent.
[[nodiscard]] std::optional<PoseForm> pose_form(std::string_view name);

/// Names for pose_form(), without all of the orders of axes.
[[nodiscard]] std::vector<std::string> pose_form_names();

/// A pose read from numbers.
struct NumberedPose {
  Pose<double> pose;  ///< metres
  std::string wrong;  ///< what is wrong with the numbers, and what to write; empty: nothing
};

/// The pose of a row of numbers.
/// @param numbers  as many as the form has
[[nodiscard]] NumberedPose pose_from_numbers(const PoseForm& form, std::span<const double> numbers);

namespace detail {

/// The rotation of a quaternion with the digits of a file.
/// @param xyzw  (4)
/// @return      (3 x 3), NaN of NaN; nullopt if the length is not 1 within 0.01
[[nodiscard]] std::optional<Matrix3<double>> rotation_from_rounded_quaternion(
    const Eigen::Vector4d& xyzw);

/// "a unit quaternion has length 1, not 1.4"
[[nodiscard]] std::string not_unit_text(double length);

/// What is wrong with a position that no robot reaches, metres; empty below 20 m.
[[nodiscard]] std::string far_away_text(const Vector3<double>& position);

}  // namespace detail
}  // namespace kinecal
