// Definitions of pose_numbers.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/poses/pose_numbers.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace kinecal {

namespace detail {

std::optional<Matrix3<double>> rotation_from_rounded_quaternion(const Eigen::Vector4d& xyzw) {
  constexpr double kMostOff = 1e-2;  // of its length; a file has few digits
  const double length = xyzw.norm();
  if (std::abs(length - 1.0) > kMostOff) return std::nullopt;  // NaN is no wrong length
  return rotation_from_quaternion<double>(xyzw / length);
}

std::string not_unit_text(double length) {
  return fmt::format("a unit quaternion has length 1, not {}", length);
}

std::string far_away_text(const Vector3<double>& position) {
  constexpr double kFar = 20.0;  // metres
  const double far = position.cwiseAbs().maxCoeff();
  if (far <= kFar) return {};
  return fmt::format("the position is {:.6g} m away; it looks like millimetres", far);
}

namespace {

/// One of x, y, z as 0, 1, 2; -1 for anything else.
[[nodiscard]] int axis_of(char letter) {
  return letter >= 'x' && letter <= 'z' ? letter - 'x' : -1;
}

/// True for three axes of which neighbours differ: "zyx", "zyz".
[[nodiscard]] bool are_axes(std::string_view axes) {
  return axes.size() == 3 &&
         std::all_of(axes.begin(), axes.end(), [](char letter) { return axis_of(letter) >= 0; }) &&
         axes[0] != axes[1] && axes[1] != axes[2];
}

[[nodiscard]] Matrix3<double> turn_about(char axis, double angle) {
  return exp(Vector3<double>(angle * Vector3<double>::Unit(axis_of(axis))));
}

/// The rotation of three angles, radians.
[[nodiscard]] Matrix3<double> rotation_of(const PoseForm& form, const Vector3<double>& angles) {
  Matrix3<double> rotation = Matrix3<double>::Identity();
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Matrix3<double> turn = turn_about(form.axes[static_cast<std::size_t>(i)], angles(i));
    rotation = form.rotation == RotationForm::euler ? Matrix3<double>(rotation * turn)
                                                    : Matrix3<double>(turn * rotation);
  }
  return rotation;
}

/// The nearest rotation to a matrix with the digits of a file.
/// @param wrong  set if none is within 0.01
[[nodiscard]] Matrix3<double> nearest_rotation(const Matrix3<double>& m, std::string& wrong) {
  constexpr double kMostOff = 1e-2;
  const Eigen::JacobiSVD<Matrix3<double>> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3<double> rotation = svd.matrixU() * svd.matrixV().transpose();
  if (!((rotation - m).cwiseAbs().maxCoeff() <= kMostOff) || rotation.determinant() < 0.0) {
    wrong =
        "the first three columns of the matrix are not a rotation: each row of numbers must be "
        "r11 r12 r13 x r21 r22 r23 y r31 r32 r33 z";
  }
  return rotation;
}

[[nodiscard]] NumberedPose pose_of_matrix(std::span<const double> numbers) {
  NumberedPose read;
  Matrix3<double> m;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m(i, j) = numbers[static_cast<std::size_t>(4 * i + j)];
    read.pose.translation(i) = numbers[static_cast<std::size_t>(4 * i + 3)];
  }
  read.pose.rotation = nearest_rotation(m, read.wrong);
  if (numbers.size() == 16 && read.wrong.empty() &&
      !(numbers[12] == 0.0 && numbers[13] == 0.0 && numbers[14] == 0.0 && numbers[15] == 1.0)) {
    read.wrong = "the last row of the matrix is not 0 0 0 1; write it by rows, not by columns";
  }
  return read;
}

/// Says what is wrong with angles.
/// @param largest  as in the file
[[nodiscard]] std::string wrong_angles(const PoseForm& form, double largest) {
  constexpr double kTurn = 2.0 * std::numbers::pi, kSlack = 1e-3;
  if (form.degrees) {
    if (largest <= 2.0 * 360.0) return {};
    return fmt::format("an angle of {:.6g} degrees is more than two turns", largest);
  }
  if (largest <= kTurn + kSlack) return {};
  return fmt::format(
      "an angle of {:.6g} rad is more than a turn; if these are degrees, write "
      "'angles: degrees'",
      largest);
}

void read_rotation(const PoseForm& form, std::span<const double> numbers, NumberedPose& read) {
  if (!form.has_angles()) {
    const bool first = form.rotation == RotationForm::quaternion_wxyz;
    const Eigen::Vector4d q = Eigen::Vector4d::Map(numbers.data());
    const Eigen::Vector4d xyzw = first ? Eigen::Vector4d(q(1), q(2), q(3), q(0)) : q;
    const auto rotation = rotation_from_rounded_quaternion(xyzw);
    if (rotation) read.pose.rotation = *rotation;
    if (!rotation) {
      read.wrong = not_unit_text(q.norm()) + "; are these columns the quaternion?";
    }
    return;
  }
  const Vector3<double> given = Vector3<double>::Map(numbers.data());
  const Vector3<double> angles = form.degrees ? given * (std::numbers::pi / 180.0) : given;
  const bool is_vector = form.rotation == RotationForm::rotation_vector;
  read.wrong = wrong_angles(form, is_vector ? given.norm() : given.cwiseAbs().maxCoeff());
  constexpr double kTurn = 360.5;  // degrees
  if (is_vector && form.degrees && given.norm() > kTurn) {
    read.wrong = fmt::format(
        "a rotation vector of {:.4g} degrees is more than a turn; if these are angles about axes, "
        "write their form: fixed_xyz, euler_zyx ...",
        given.norm());
  }
  read.pose.rotation = is_vector ? exp(angles) : rotation_of(form, angles);
}

}  // namespace
}  // namespace detail

bool PoseForm::has_size(std::size_t numbers) const {
  if (rotation == RotationForm::matrix) return numbers == 12 || numbers == 16;
  return numbers == (has_angles() ? 6u : 7u);
}

std::string PoseForm::columns_text() const {
  constexpr const char* kTexts[] = {"7 columns: x y z qx qy qz qw", "7 columns: x y z qw qx qy qz",
                                    "6 columns: x y z rx ry rz",
                                    "12 or 16 columns: the rows of the matrix"};
  if (axes.empty()) return kTexts[static_cast<int>(rotation)];
  return fmt::format("6 columns: x y z, then the angles about {} {} {}", axes[0], axes[1], axes[2]);
}

namespace detail {
namespace {

/// A name that stands for a form and its units.
struct NamedForm {
  std::string_view name, form;
  bool millimetres = false, degrees = false;
};

constexpr NamedForm kNamedForms[] = {{"rpy", "fixed_xyz"},
                                     {"ur", "rotation_vector"},
                                     {"abb", "quaternion_wxyz", true},
                                     {"kuka", "euler_zyx", true, true},
                                     {"fanuc", "fixed_xyz", true, true},
                                     {"yaskawa", "fixed_xyz", true, true},
                                     {"fairino", "fixed_xyz", true, true},
                                     {"techman", "fixed_xyz", true, true},
                                     {"dobot", "fixed_xyz", true, true},
                                     {"elite", "fixed_xyz", true, true},
                                     {"jaka", "fixed_xyz", true},
                                     {"aubo", "fixed_xyz"},
                                     {"kinova", "fixed_xyz", false, true},
                                     {"nachi", "euler_zyx", true, true},
                                     {"staubli", "euler_xyz", true, true},
                                     {"doosan", "euler_zyz", true, true},
                                     {"kawasaki", "euler_zyz", true, true}};

}  // namespace
}  // namespace detail

std::optional<PoseForm> pose_form(std::string_view name) {
  for (const detail::NamedForm& named : detail::kNamedForms) {
    if (named.name != name) continue;
    std::optional<PoseForm> form = pose_form(named.form);
    form->millimetres = named.millimetres;
    form->degrees = named.degrees;
    return form;
  }
  PoseForm form;
  const bool is_euler = name.starts_with("euler_"), is_fixed = name.starts_with("fixed_");
  if (is_euler || is_fixed) {
    form.axes = std::string(name.substr(6));
    if (!detail::are_axes(form.axes)) return std::nullopt;
    form.rotation = is_euler ? RotationForm::euler : RotationForm::fixed_axes;
  } else if (name == "quaternion_wxyz") {
    form.rotation = RotationForm::quaternion_wxyz;
  } else if (name == "rotation_vector") {
    form.rotation = RotationForm::rotation_vector;
  } else if (name == "matrix") {
    form.rotation = RotationForm::matrix;
  } else if (name != "quaternion_xyzw") {
    return std::nullopt;
  }
  return form;
}

std::vector<std::string> pose_form_names() {
  std::vector<std::string> names = {"quaternion_xyzw", "quaternion_wxyz", "rotation_vector",
                                    "matrix",          "fixed_xyz",       "euler_zyx"};
  for (const detail::NamedForm& named : detail::kNamedForms) names.emplace_back(named.name);
  return names;
}

NumberedPose pose_from_numbers(const PoseForm& form, std::span<const double> numbers) {
  const bool is_matrix = form.rotation == RotationForm::matrix;
  NumberedPose read;
  if (is_matrix) read = detail::pose_of_matrix(numbers);
  if (!is_matrix) {
    read.pose.translation = Vector3<double>::Map(numbers.data());
    detail::read_rotation(form, numbers.subspan(3), read);
  }
  if (form.millimetres) read.pose.translation /= 1000.0;
  if (const std::string far = detail::far_away_text(read.pose.translation); !far.empty()) {
    read.wrong = far + (form.millimetres ? " of millimetres" : ": write 'unit: millimetres'");
  }
  if (form.inverse) read.pose = read.pose.inverse();
  return read;
}

}  // namespace kinecal
