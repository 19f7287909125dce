// Finds lenses that are not as they were taken.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/lens_pattern.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "kinecal/trust/error_columns.ipp"
#include "kinecal/trust/left_out_poses.ipp"
#include "kinecal/trust/sample_slopes.ipp"

namespace kinecal {

namespace detail {
namespace {

/// A shift of pixels, by their place in units of the radius.
using Shift = Eigen::Vector2d (*)(const Eigen::Vector2d&);

[[nodiscard]] Eigen::Vector2d lens_shift(const Eigen::Vector2d& p) {
  return p * p.squaredNorm();
}
/// What looks alike: the scales of u and v, and their shifts.
constexpr std::array<Shift, 4> kOtherShifts = {[](const Eigen::Vector2d& p) -> Eigen::Vector2d {
                                                 return {p.x(), 0.0};
                                               },
                                               [](const Eigen::Vector2d& p) -> Eigen::Vector2d {
                                                 return {0.0, p.y()};
                                               },
                                               [](const Eigen::Vector2d&) -> Eigen::Vector2d {
                                                 return {1.0, 0.0};
                                               },
                                               [](const Eigen::Vector2d&) -> Eigen::Vector2d {
                                                 return {0.0, 1.0};
                                               }};

/// A camera's pixels in some samples.
class CameraPixels {
 public:
  CameraPixels(const MountedSensor& mounted, ParameterValues values,
               std::span<const Sample> samples)
      : mounted_(mounted), own_(mounted.own_values(values)) {
    for (const Sample& sample : samples) {
      const Observation* seen = sample.observation(name());
      if (seen == nullptr) continue;
      const Eigen::Vector2d at = center(*seen);
      for (const Feature& feature : seen->features) {
        const double distance = (feature.point.head<2>() - at).norm();
        if (distance > radius_) radius_ = distance;  // not if it is NaN
      }
      if (first_ == nullptr) first_ = seen;
    }
  }

  [[nodiscard]] const std::string& name() const { return mounted_.mount().name; }
  [[nodiscard]] double radius() const { return radius_; }  ///< of the farthest feature, pixels
  [[nodiscard]] double focal_length() const {
    constexpr double kSmall = 1e-3;
    const std::vector<double> settings = mounted_.sensor().settings(*first_);
    const auto at = [&](double x, double y) {
      return mounted_.sensor().predict({x, y, 1.0}, settings, own_);
    };
    return 0.5 *
           ((at(kSmall, 0.0) - at(0.0, 0.0)).norm() + (at(0.0, kSmall) - at(0.0, 0.0)).norm()) /
           kSmall;
  }
  /// What its lens was taken as: settings beyond fx fy cx cy are those of a lens.
  [[nodiscard]] TakenLens taken() const {
    const auto is_set = [](double number) { return number != 0.0; };
    const std::vector<double> settings = mounted_.sensor().settings(*first_);
    constexpr std::ptrdiff_t kPinhole = 4;
    if (std::ssize(settings) > kPinhole &&
        std::any_of(settings.begin() + kPinhole, settings.end(), is_set)) {
      return TakenLens::given;
    }
    if (!first_->camera) return TakenLens::none;
    const std::vector<double>& d = first_->camera->d;
    return std::any_of(d.begin(), d.end(), is_set) ? TakenLens::rectified : TakenLens::none;
  }

  /// Moves the pixels of a sample by a field of shifts.
  void move(Sample& sample, Shift shift, double step) const {
    for (Observation& seen : sample.observations) {
      if (seen.sensor != name()) continue;
      const Eigen::Vector2d at = center(seen);
      for (Feature& feature : seen.features) {
        const Eigen::Vector2d place = (feature.point.head<2>() - at) / radius_;
        feature.point.head<2>() += step * shift(place);
      }
    }
  }

 private:
  /// The recorded principal point: a fitted one has moved with the lens.
  [[nodiscard]] Eigen::Vector2d center(const Observation& seen) const {
    return mounted_.sensor().predict({0.0, 0.0, 1.0}, mounted_.sensor().settings(seen));
  }

  const MountedSensor& mounted_;
  std::vector<double> own_;
  double radius_ = 0.0;
  const Observation* first_ = nullptr;
};

/// A fit, the samples that it is of, and their poses.
struct LensSearch {
  FittedSamples fitted;
  const PoseGroups& poses;

  /// (rows) derivatives of weighted residuals by the size of a shift, pixels.
  [[nodiscard]] Eigen::VectorXd slope(const CameraPixels& camera, Shift shift) const {
    constexpr double kStep = 1e-3;  // pixels
    const auto move = [&](Sample& sample) { camera.move(sample, shift, kStep); };
    return sample_slopes(fitted, move, kStep);
  }

  /// What the lens of a camera explains; nullopt if it could be chance, or does not matter.
  [[nodiscard]] std::optional<LensPattern> lens_of(const CameraPixels& camera,
                                                   double chance) const {
    constexpr double kLeft = 0.95, kPixels = 0.5;
    // A shift that is larger, in parts of the radius, is none: what is left of a column that free parameters explain has
    // the noise of the pixels at which it was computed, and so explains noise.
    constexpr double kLarge = 0.5;
    const LinearFit& fit = fitted.fit;
    const auto samples = std::ssize(fitted.samples);
    Eigen::MatrixXd slopes(fit.residual.size(), 1 + std::ssize(kOtherShifts));
    slopes.col(0) = slope(camera, lens_shift);
    const Eigen::ArrayXd squares = fit.loss.array() * fit.residual.array().square();
    const double own = (slopes.col(0).array() != 0.0).select(squares, 0.0).sum();
    const Eigen::MatrixXd inverse = Spectrum(information(fit, fit.loss)).pseudo_inverse();
    const Fall fall =
        ErrorColumns(fit, slopes.col(0), samples).fall(Eigen::MatrixXd::Ones(samples, 1), inverse);
    const double left = std::max(0.0, own - fall.squares), farther = -fall.change(0);
    if (!(own > 0.0) || left > kLeft * kLeft * own || !(std::abs(farther) > kPixels)) return {};
    if (std::abs(farther) > kLarge * camera.radius()) return {};
    for (std::size_t i = 0; i < kOtherShifts.size(); ++i) {
      slopes.col(static_cast<Eigen::Index>(i) + 1) = slope(camera, kOtherShifts[i]);
    }
    const double per_pixel = fit.loss.dot(slopes.rightCols(2).rowwise().squaredNorm());
    if (!(farther * farther * per_pixel > left)) return {};  // below the noise
    const ColumnTest test = test_column(fit, slopes, poses);
    if (test.chance > chance || !(test.change * farther < 0.0)) return {};
    const double f = camera.focal_length(), r = camera.radius();
    const double per_shift = std::sqrt(fit.loss.dot(slopes.col(0).cwiseAbs2()));
    return LensPattern{.sensor = camera.name(),
                       .pixels = std::copysign(std::sqrt(fall.squares) / per_shift, farther),
                       .radius = r,
                       .k1 = farther * f * f / (r * r * r),
                       .noise_left = std::sqrt(std::max(0.0, 1.0 - fall.squares / squares.sum())),
                       .taken = camera.taken()};
  }
};

}  // namespace
}  // namespace detail

namespace detail {
namespace {

/// A lens of which a coefficient is free fits as well as its model can.
[[nodiscard]] bool is_fitted(const MountedSensor& mounted, const FreeSet& free) {
  const std::vector<int>& own = mounted.parameters();
  const std::vector<int>& freed = free.parameters();
  const auto from =
      own.begin() + std::min(std::ssize(own), static_cast<std::ptrdiff_t>(kIntrinsics));
  return std::any_of(from, own.end(), [&](int parameter) {
    return std::find(freed.begin(), freed.end(), parameter) != freed.end();
  });
}

}  // namespace
}  // namespace detail

std::optional<LensPattern> lens_pattern(const AnyProblem& problem, const FreeSet& free,
                                        const LinearFit& fit, ParameterValues values,
                                        std::span<const Sample> samples, const PoseGroups& poses) {
  constexpr double kChance = 1e-3;
  std::optional<LensPattern> best;
  if (detail::is_exact(problem, fit)) return best;
  const detail::LensSearch search{{problem, free, fit, values, samples}, poses};
  const double each = kChance / static_cast<double>(problem.sensors().size());
  for (const MountedSensor& mounted : problem.sensors()) {
    if (!mounted.sensor().is_camera() || measures_depth(mounted.sensor())) continue;
    if (detail::is_fitted(mounted, free)) continue;
    const detail::CameraPixels camera(mounted, values, samples);
    if (!(camera.radius() > 0.0)) continue;
    const auto found = search.lens_of(camera, each);
    if (found && (!best || found->noise_left < best->noise_left)) best = found;
  }
  return best;
}

}  // namespace kinecal
