// The oracle: where the features of a sample are, from the definitions alone, in any scalar.
//
// It shares data types with the code under test (Robot, Sample, ParameterTable) and no function:
// links are found by climbing to the root, turns are quaternions, positions come from the sample by
// the names of its joints, and planes are singular vectors.  In ceres::Jet it differentiates
// itself. Slow and obvious.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/LU>
#include <Eigen/SVD>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "kinecal/kinematics/robot.hpp"
#include "kinecal/parameters/parameter_table.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::test {

/// The values of parameters by name; zero for a name that is not a parameter.
template <class S>
class OracleValues {
 public:
  template <class Values>
  OracleValues(const ParameterTable& table, const Values& values) {
    std::size_t i = 0;
    for (const Parameter& parameter : table) values_[parameter.name] = values[i++];
  }
  [[nodiscard]] S operator()(const std::string& name) const {
    const auto it = values_.find(name);
    return it == values_.end() ? S(0.0) : it->second;
  }

 private:
  std::map<std::string, S> values_;
};

/// p -> r p + t
template <class S>
struct OraclePose {
  Matrix3<S> r = Matrix3<S>::Identity();
  Vector3<S> t = Vector3<S>::Zero();

  [[nodiscard]] Vector3<S> operator()(const Vector3<S>& p) const { return r * p + t; }
  [[nodiscard]] OraclePose then(const OraclePose& next) const {
    return {r * next.r, r * next.t + t};
  }
  [[nodiscard]] OraclePose inverse() const { return {r.transpose(), -(r.transpose() * t)}; }
};

/// The turn of the unit quaternion w + x i + y j + z k.
template <class S>
Matrix3<S> turn_of(const S& w, const S& x, const S& y, const S& z) {
  const S two(2.0);
  Matrix3<S> r;
  r(0, 0) = w * w + x * x - y * y - z * z;
  r(1, 1) = w * w - x * x + y * y - z * z;
  r(2, 2) = w * w - x * x - y * y + z * z;
  r(0, 1) = two * (x * y - w * z);
  r(1, 0) = two * (x * y + w * z);
  r(0, 2) = two * (x * z + w * y);
  r(2, 0) = two * (x * z - w * y);
  r(1, 2) = two * (y * z - w * x);
  r(2, 1) = two * (y * z + w * x);
  return r;
}

/// A turn about a unit vector.
template <class S>
OraclePose<S> turned(const Vector3<double>& axis, const S& angle) {
  using std::cos, std::sin;
  const S s = sin(angle * 0.5);
  return {turn_of<S>(cos(angle * 0.5), s * axis.x(), s * axis.y(), s * axis.z()),
          Vector3<S>::Zero()};
}

/// The turn of a rotation vector: its length is the angle.
template <class S>
Matrix3<S> turn_of(const Vector3<S>& v) {
  using std::cos, std::sin, std::sqrt;
  const S t2 = v.x() * v.x() + v.y() * v.y() + v.z() * v.z();
  S c, s;              // cos(t / 2) and sin(t / 2) / t
  if (t2 < S(1e-4)) {  // the next terms are below 1e-19
    c = 1.0 - t2 / 8.0 + t2 * t2 / 384.0 - t2 * t2 * t2 / 46080.0;
    s = 0.5 - t2 / 48.0 + t2 * t2 / 3840.0 - t2 * t2 * t2 / 645120.0;
  } else {
    const S t = sqrt(t2);
    c = cos(t * 0.5);
    s = sin(t * 0.5) / t;
  }
  return turn_of<S>(c, s * v.x(), s * v.y(), s * v.z());
}

/// The free frame of a name: the correction of a joint, or a virtual frame on its sensor.
template <class S>
OraclePose<S> oracle_frame(const std::string& name, const OracleValues<S>& values) {
  return {turn_of<S>(Vector3<S>(values(name + "_a"), values(name + "_b"), values(name + "_c"))),
          Vector3<S>(values(name + "_x"), values(name + "_y"), values(name + "_z"))};
}

/// Where a joint stands, its offset included.
template <class S>
S oracle_position(const Robot& robot, const Joint& joint, const Sample& sample,
                  const OracleValues<S>& values) {
  if (joint.mimic) {
    for (const Joint& driver : robot.joints()) {
      if (driver.name != joint.mimic->joint) continue;
      return joint.mimic->multiplier * oracle_position(robot, driver, sample, values) +
             joint.mimic->offset;
    }
  }
  for (std::size_t i = 0; i < sample.joint_names.size(); ++i) {
    if (sample.joint_names[i] != joint.name) continue;
    const double q = sample.joint_positions[i];
    return q * (values(joint.name + "_gear_ratio") + 1.0) + values(joint.name) +
           std::sin(q) * values(joint.name + "_eccentric_sin") +
           (std::cos(q) - 1.0) * values(joint.name + "_eccentric_cos") +
           std::sin(2.0 * q) * values(joint.name + "_second_harmonic_sin");
  }
  throw std::invalid_argument("the oracle does not know where joint '" + joint.name + "' stands");
}

/// The pose of a link in the root of its robot:  origin * frame * motion  of each joint above it.
template <class S>
OraclePose<S> oracle_in_root(const Robot& robot, const std::string& link, const Sample& sample,
                             const OracleValues<S>& values) {
  for (const Joint& joint : robot.joints()) {
    if (joint.child != link) continue;
    OraclePose<S> motion;
    if (joint.type == JointType::revolute || joint.type == JointType::continuous) {
      motion = turned<S>(joint.axis, oracle_position(robot, joint, sample, values));
    } else if (joint.type == JointType::prismatic) {
      motion.t = joint.axis.cast<S>() * oracle_position(robot, joint, sample, values);
    } else if (joint.type != JointType::fixed) {
      throw std::invalid_argument("the oracle does not know joints like '" + joint.name + "'");
    }
    return oracle_in_root(robot, joint.parent, sample, values)
        .then({joint.origin.rotation.cast<S>(), joint.origin.translation.cast<S>()})
        .then(oracle_frame(joint.name, values))
        .then(motion);
  }
  return {};
}

/// The pose of a link, or of a virtual frame on it, in another link.
/// @param on  the virtual frame; empty or the link itself: none
template <class S>
OraclePose<S> oracle_pose(const Robot& robot, const std::string& base, const std::string& link,
                          const std::string& on, const Sample& sample,
                          const OracleValues<S>& values) {
  const OraclePose<S> pose = oracle_in_root(robot, base, sample, values)
                                 .inverse()
                                 .then(oracle_in_root(robot, link, sample, values));
  return on.empty() || on == link ? pose : pose.then(oracle_frame(on, values));
}

/// Where a depth camera's point is once its settings are corrected, metres, in the camera.
/// @param camera  prefix of its parameters
template <class S>
Vector3<S> oracle_depth_point(const CameraInfo& info, const Vector3<double>& recorded,
                              const std::string& camera, const OracleValues<S>& values) {
  const double fx = info.p[0], fy = info.p[5], cx = info.p[2], cy = info.p[6];
  const double u = cx + fx * recorded.x() / recorded.z();
  const double v = cy + fy * recorded.y() / recorded.z();
  const double raw = recorded.z() / info.z_scaling - info.z_offset;
  const S plain = (values(camera + "_z_offset") + raw) * (values(camera + "_z_scaling") + 1.0);
  const double x = recorded.x() / recorded.z(), y = recorded.y() / recorded.z();
  const S z = plain + plain * plain * values(camera + "_z_quadratic") +
              plain * (values(camera + "_z_x") * x + values(camera + "_z_y") * y +
                       values(camera + "_z_xx") * (x * x) + values(camera + "_z_xy") * (x * y) +
                       values(camera + "_z_yy") * (y * y));
  const S new_fx = fx * (values(camera + "_fx") + 1.0),
          new_cx = cx * (values(camera + "_cx") + 1.0);
  const S new_fy = fy * (values(camera + "_fy") + 1.0),
          new_cy = cy * (values(camera + "_cy") + 1.0);
  return {z * (u - new_cx) / new_fx, z * (v - new_cy) / new_fy, z};
}

/// The pixel at which a pinhole camera sees a point of its optical frame.
template <class S>
Eigen::Matrix<S, 2, 1> oracle_pixel(const CameraInfo& info, const Vector3<S>& p,
                                    const std::string& camera, const OracleValues<S>& values) {
  bool rectified = true;
  std::array<double, 5> d{};
  for (std::size_t i = 0; i < info.d.size(); ++i) {
    d.at(i) = info.d[i];
    if (d[i] != 0.0) rectified = false;
  }
  const auto [k1, k2, p1, p2, k3] = d;
  const double fx = rectified ? info.p[0] : info.k[0], cx = rectified ? info.p[2] : info.k[2];
  const double fy = rectified ? info.p[5] : info.k[4], cy = rectified ? info.p[6] : info.k[5];
  const S x = p.x() / p.z(), y = p.y() / p.z();
  const S r2 = x * x + y * y, r4 = r2 * r2, r6 = r2 * r2 * r2;
  const S radial = k1 * r2 + k2 * r4 + k3 * r6 + 1.0;
  const S distorted_x = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
  const S distorted_y = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
  return {fx * (values(camera + "_fx") + 1.0) * distorted_x + cx * (values(camera + "_cx") + 1.0),
          fy * (values(camera + "_fy") + 1.0) * distorted_y + cy * (values(camera + "_cy") + 1.0)};
}

template <class S>
struct OraclePlane {
  Vector3<S> centroid, normal;
};

inline double oracle_value(double x) {
  return x;
}
template <class S>
double oracle_value(const S& jet) {
  return jet.a;
}

/// The plane through points: the last singular vector of the centred points in double, then one
/// Newton step on (M n - l n, n.n - 1) = 0 in S, which makes its derivatives exact.  The sign of
/// its normal is anyone's.
template <class S>
OraclePlane<S> oracle_plane(const std::vector<Vector3<S>>& points) {
  OraclePlane<S> plane{Vector3<S>::Zero(), Vector3<S>::Zero()};
  for (const auto& p : points) plane.centroid += p / S(static_cast<double>(points.size()));
  Eigen::MatrixXd centred(points.size(), 3);
  Matrix3<S> scatter = Matrix3<S>::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3<S> q = points[i] - plane.centroid;
    scatter += q * q.transpose();
    for (int k = 0; k < 3; ++k) centred(static_cast<Eigen::Index>(i), k) = oracle_value(q(k));
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(centred, Eigen::ComputeFullV);
  const Vector3<S> start = Vector3<double>(svd.matrixV().col(2)).cast<S>();
  const S lambda = start.dot(scatter * start);
  Eigen::Matrix<S, 4, 4> system = Eigen::Matrix<S, 4, 4>::Zero();
  system.template topLeftCorner<3, 3>() = scatter - lambda * Matrix3<S>::Identity();
  system.template topRightCorner<3, 1>() = -start;
  system.template bottomLeftCorner<1, 3>() = S(2.0) * start.transpose();
  Eigen::Matrix<S, 4, 1> rhs;
  rhs << lambda * start - scatter * start, S(1.0) - start.squaredNorm();
  plane.normal = start + system.partialPivLu().solve(rhs).template head<3>();
  return plane;
}

}  // namespace kinecal::test
