// Your own program: `kinecal` with one sensor and one error block more.
//
//   own_kinecal calibrate --urdf robot.urdf --config calibrate.yaml --samples samples.yaml ...
//
// calibrate.yaml, beside this file, names `type: draw_wire` and `type: wire_length`.
// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include "kinecal/io/register.hpp"
#include "kinecal/program.hpp"

namespace {

using namespace kinecal;

/// The length of a wire that is pulled out of a drum: reading (1 + scale) + zero.
struct DrawWire {
  static constexpr std::string_view kType = "draw_wire";
  static constexpr std::array kParameters = {ParameterInfo{"scale"}, ParameterInfo{"zero", "m"}};

  template <class S, class Q>
  Reading<S> place(const Measurement<DrawWire, Q>& m, const std::array<S, 2>& v) const {
    return {.value = m.point.x() * (1.0 + v[0]) + v[1]};
  }
};

/// Distance of a point to the drum, minus the length of the wire and of what it hooks onto.
struct WireLength {
  static constexpr const char *kType = "wire_length", *kUnit = "m";
  using Inputs = Takes<Quantity::point, Quantity::reading>;
  double hook = 0.0;  ///< metres

  template <class S>
  Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p_base, const Reading<S>& wire) const {
    return Eigen::Matrix<S, 1, 1>((p_base - wire.origin).norm() - wire.value - hook);
  }
};

}  // namespace

int main(int argc, char** argv) {
  register_sensor(DrawWire{});
  register_block<WireLength>({{"model"}, {"wire"}}, {{"hook", 0.0}},
                             [](const BlockNumbers& numbers) {
                               const double hook = numbers.at("hook");
                               if (hook < 0.0)
                                 throw std::invalid_argument("the hook has a negative length");
                               return WireLength{hook};
                             });
  return run_program(argc, argv);
}
