// How well a camera's projection is known, over its image.
//
// A camera's parameters i trade off against each other and against its pose: a principal point that is off looks like
// a rotation.  So the map is of the projection relative to what the camera saw:
//
//   A = J_i + J_m G      G = -(sum J_m^T J_m)^-1 sum J_m^T J_i   over the features of the samples
//
// J_i derivatives of a pixel by i, J_m by a rigid motion m of the camera; G i is the motion that takes up most of a
// change of i.  The covariance of a pixel is A C A^T, C that of i.
//
// What samples do not determine counts only where it moves pixels: fx and xi of a double_sphere in a narrow view do not.
//
// Two halves of the poses, solved apart, should differ as the information of each half says: cross-validation.  If they
// differ by much more, the lens has a shape that its model does not have, or the target has one.
// Source: mrcal's documentation, "Projection uncertainty" and "Cross-validation", for what to ask; the rest is linear
// propagation, with Satterthwaite's degrees of freedom for the sum of squares.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/noise/pose_groups.hpp"
#include "kinecal/trust/uncertainty/uncertainty.hpp"

namespace kinecal {

/// What is known of the projection in a cell of the image.
struct KnownPixel {
  std::array<double, 2> pixel{};  ///< its middle
  int features = 0;               ///< observed in it
  /// Variances of u and v and their covariance, square pixels; infinite if not determined, NaN where the lens sees
  /// nothing.
  std::array<double, 3> covariance{};
  double metres =
      0.0;  ///< standard deviation of a point at ProjectionMap::distance, across the line of sight
  double difference = 0.0;  ///< between two halves of the poses, solved apart, pixels

  /// Standard deviation of the pixel, pixels: sqrt(trace).
  [[nodiscard]] double deviation() const;
};

/// The difference between two halves of the poses, solved apart, where features are.
struct HalvesApart {
  double difference = 0.0;  ///< root of the mean square over the cells with features, pixels
  double allowed = 0.0;     ///< the same that the covariance leads to expect
  double chance = 1.0;      ///< probability of such a difference, or a larger one
};

/// A focal length, a coordinate of the principal point or a coefficient of the lens, as camera files have it.
struct CameraNumber {
  std::string name;    ///< "fx", "k1"
  double value = 0.0;  ///< of fx fy cx cy: pixels
  std::optional<double>
      deviation;  ///< standard deviation, infinite if not determined; nullopt: held
};

/// How well a camera's projection is known.
struct ProjectionMap {
  std::string sensor;  ///< the camera
  std::array<double, 2>
      low{};  ///< corner of the image, pixels; of what features cover if its size is unknown
  std::array<double, 2> high{};  ///< the opposite corner
  int columns = 0, rows = 0;     ///< cells
  double distance = 0.0;         ///< of features from the camera, median, metres; 0: unknown
  /// Of the first sample's camera_info, corrected; and kAxisFocal, where fx is known worse than to 5 % and it is not.
  std::vector<CameraNumber> numbers = {};
  std::vector<KnownPixel> cells = {};      ///< row by row
  std::optional<HalvesApart> halves = {};  ///< nullopt if there are too few poses

  /// The cell of a pixel; nullptr outside.
  [[nodiscard]] const KnownPixel* at(double u, double v) const;
  /// The ninth of the image in which a cell is: text/image_region.hpp.
  [[nodiscard]] std::size_t region_of(const KnownPixel& cell) const;
  /// Standard deviations at the cell with the least, in the median of cells with features, and at the worst cell that
  /// the lens sees, pixels.
  [[nodiscard]] std::array<double, 3> deviations() const;
  /// True if pixels where features are, are known as well as they are used.
  [[nodiscard]] bool is_known() const { return deviations()[1] <= kEnough; }
  static constexpr double kEnough = 1.0;  ///< pixels
  /// A number of the camera; nullptr if it has none of this name.
  [[nodiscard]] const CameraNumber* number(std::string_view name) const;
  /// The focal length at the axis: kAxisFocal, or fx; nullptr if the camera has neither.
  [[nodiscard]] const CameraNumber* focal() const;
  /// Standard deviation of focal(), of its value; infinite if not determined, zero if held.
  [[nodiscard]] double focal_deviation() const;
  /// What double_sphere divides between fx and xi: pixels of u per radian at the axis.
  static constexpr std::string_view kAxisFocal = "focal length at the axis";
  static constexpr double kKnownFocal = 0.05;  ///< of it: worse is not known
};

/// What is known of the solution.
struct KnownSolution {
  AnyEvaluator& evaluator;          ///< of the problem and its free parameters
  const FreeSet& free;              ///< those of the evaluator
  ParameterValues values;           ///< of all parameters of the table
  const LinearFit& fit;             ///< there
  const Uncertainty& uncertainty;   ///< of the free parameters
  std::span<const Sample> samples;  ///< those of the problem, in their order
  const PoseGroups& poses;          ///< of these
};

/// Maps of the cameras of which something is free: an intrinsic parameter or a coefficient of the lens.
[[nodiscard]] std::vector<ProjectionMap> projection_maps(const KnownSolution& solution);
/// The same, with the noise that the residuals show.
/// @param free     parameters
/// @param values   the solution, of all parameters of the table
/// @param samples  those of the problem, in their order
[[nodiscard]] std::vector<ProjectionMap> projection_maps(const AnyProblem& problem,
                                                         const FreeSet& free,
                                                         ParameterValues values,
                                                         const std::vector<Sample>& samples);

}  // namespace kinecal
