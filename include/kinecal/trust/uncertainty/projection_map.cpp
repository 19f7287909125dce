// Maps cameras.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/uncertainty/projection_map.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/geometry/least_norm.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/solve/spectrum.hpp"
#include "kinecal/text/image_region.hpp"
#include "kinecal/trust/f_distribution.hpp"
#include "kinecal/trust/noise/noise.hpp"
#include "kinecal/trust/uncertainty/feature_places.hpp"
#include "kinecal/trust/uncertainty/weak_parameters.hpp"

namespace kinecal {

namespace detail {
namespace {

// Derivatives of a camera's pixels, by its parameters and by its motion.

/// A camera at the solution, with its free parameters.
class SolvedProjection {
 public:
  using PixelByFree = Eigen::Matrix<double, 2, Eigen::Dynamic>;  ///< (2 x free), pixels
  using PixelByPoint = Eigen::Matrix<double, 2, 3>;              ///< pixels per metre
  using PixelByMotion =
      Eigen::Matrix<double, 2, 6>;  ///< translation in units of a distance, rotation

  /// @param settings  of its observations
  SolvedProjection(const MountedSensor& camera, const FreeSet& free, ParameterValues values,
                   std::vector<double> settings)
      : camera_(camera), settings_(std::move(settings)), own_(camera.own_values(values)) {
    for (std::size_t i = 0; i < own_.size(); ++i) {
      const int column = camera.parameters()[i] >= 0 ? free.column(camera.parameters()[i]) : -1;
      if (column < 0) continue;
      parameters_.push_back(i);
      columns_.push_back(column);
    }
  }

  /// Columns of its free parameters.
  [[nodiscard]] const std::vector<int>& columns() const { return columns_; }
  /// Its free parameters at some values.
  [[nodiscard]] Eigen::VectorXd own(ParameterValues values) const {
    const std::vector<double> all = camera_.own_values(values);
    Eigen::VectorXd some(std::ssize(parameters_));
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      some(static_cast<Eigen::Index>(i)) = all[parameters_[i]];
    }
    return some;
  }
  /// What camera files have: fx fy cx cy in pixels, and coefficients of the lens.
  /// @param deviations  of its free parameters
  [[nodiscard]] std::vector<CameraNumber> numbers(std::span<const double> settings,
                                                  std::span<const double> deviations) const {
    static constexpr std::array<std::string_view, 4> kIntrinsicNames = {"fx", "fy", "cx", "cy"};
    const std::span<const ParameterInfo> infos = camera_.sensor().parameters();
    std::vector<CameraNumber> all;
    for (std::size_t i = 0; i < infos.size(); ++i) {
      const auto intrinsic =
          std::find(kIntrinsicNames.begin(), kIntrinsicNames.end(), infos[i].name);
      const bool relative = intrinsic != kIntrinsicNames.end();
      if (!relative && settings.size() != infos.size()) continue;  // not those of a lens
      const double was =
          settings[relative ? static_cast<std::size_t>(intrinsic - kIntrinsicNames.begin()) : i];
      CameraNumber number{
          std::string(infos[i].name), relative ? was * (1.0 + own_[i]) : was + own_[i], {}};
      const auto free = std::find(parameters_.begin(), parameters_.end(), i);
      if (free != parameters_.end()) {
        number.deviation = (relative ? was : 1.0) *
                           deviations[static_cast<std::size_t>(free - parameters_.begin())];
      }
      all.push_back(std::move(number));
    }
    return all;
  }
  /// Where a point (3) is seen.
  [[nodiscard]] Eigen::Vector2d pixel(const Vector3<double>& p) const {
    return camera_.sensor().predict(p, settings_, own_);
  }
  /// The unit direction of a pixel; NaN where the lens sees nothing.
  [[nodiscard]] Vector3<double> direction(const Eigen::Vector2d& pixel) const {
    return camera_.sensor().place({pixel.x(), pixel.y(), 0.0}, settings_, own_).normalized();
  }
  [[nodiscard]] PixelByFree by_free(const Vector3<double>& p) const {
    constexpr double kStep = 1e-6;
    PixelByFree all(2, std::ssize(parameters_));
    std::vector<double> own = own_;
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      double& value = own[parameters_[i]];
      const double at = value;
      value = at + kStep;
      const Eigen::Vector2d above = camera_.sensor().predict(p, settings_, own);
      value = at - kStep;
      const Eigen::Vector2d below = camera_.sensor().predict(p, settings_, own);
      value = at;
      all.col(static_cast<Eigen::Index>(i)) = (above - below) / (2.0 * kStep);
    }
    return all;
  }
  [[nodiscard]] PixelByPoint by_point(const Vector3<double>& p) const {
    const double step = 1e-6 * p.norm();
    PixelByPoint all;
    for (int i = 0; i < 3; ++i) {
      const Vector3<double> off = step * Vector3<double>::Unit(i);
      all.col(i) = (camera_.sensor().predict(p + off, settings_, own_) -
                    camera_.sensor().predict(p - off, settings_, own_)) /
                   (2.0 * step);
    }
    return all;
  }
  /// By a motion of the points against the camera: distance * translation + rotation x p.
  [[nodiscard]] static PixelByMotion by_motion(const PixelByPoint& by_point,
                                               const Vector3<double>& p, double distance) {
    PixelByMotion all;
    all.leftCols<3>() = by_point * distance;
    for (int i = 0; i < 3; ++i) all.col(3 + i) = by_point * Vector3<double>::Unit(i).cross(p);
    return all;
  }

 private:
  const MountedSensor& camera_;
  std::vector<double> settings_, own_;
  std::vector<std::size_t> parameters_;  ///< free ones among its own
  std::vector<int> columns_;
};

/// G of the header: the motion that takes up most of a change of the parameters, from the points of features.
class TakenUp {
 public:
  explicit TakenUp(Eigen::Index free)
      : squares_(Eigen::Matrix<double, 6, 6>::Zero()), products_(Eigen::MatrixXd::Zero(6, free)) {}

  void add(const SolvedProjection::PixelByFree& by_free,
           const SolvedProjection::PixelByMotion& by_motion) {
    if (!by_free.allFinite() || !by_motion.allFinite()) return;
    squares_ += by_motion.transpose() * by_motion;
    products_ += by_motion.transpose() * by_free;
  }
  /// (6 x free)
  [[nodiscard]] Eigen::MatrixXd motion() const { return -least_norm_solution(squares_, products_); }

 private:
  Eigen::Matrix<double, 6, 6> squares_;
  Eigen::MatrixXd products_;
};

// What a camera observed in the samples of a solution: pixels, and how far away they are.

/// What a camera observed.
struct SeenByCamera {
  std::vector<Eigen::Vector2d> pixels;
  std::vector<double> distances;  ///< from the camera, metres; 0: unknown
  std::vector<double> settings;
  std::array<double, 2> low{}, high{};
};

/// Distances of a sample's features from a camera, by what another sensor of an error block says of them.
void set_distances(const AnyProblem& problem, const FeaturePlaces& places, int camera,
                   const Sample& sample, std::vector<double>& distances) {
  for (int t = 0; t < problem.num_terms(); ++t) {
    const std::vector<int>& sensors = problem.term(t).sensors;
    if (sensors.size() != 2 || std::find(sensors.begin(), sensors.end(), camera) == sensors.end()) {
      continue;
    }
    const int other = sensors[0] == camera ? sensors[1] : sensors[0];
    const MountedSensor& of = problem.sensors()[static_cast<std::size_t>(other)];
    const Observation* seen = sample.observation(of.mount().name);
    const auto kind = of.sensor().places();
    if (seen == nullptr || !kind || *kind == Quantity::ray || *kind == Quantity::reading) continue;
    const std::string& name = problem.sensors()[static_cast<std::size_t>(camera)].mount().name;
    const auto rays = places.placed(camera, *sample.observation(name), sample);
    const auto points = places.placed(other, *seen, sample);
    for (std::size_t i = 0; i < std::min({rays.size(), points.size(), distances.size()}); ++i) {
      if (points[i].seen) distances[i] = (points[i].point - rays[i].origin).norm();
    }
  }
}

[[nodiscard]] SeenByCamera seen_by(const KnownSolution& solution, const FeaturePlaces& places,
                                   int camera) {
  const AnyProblem& problem = solution.evaluator.problem();
  const MountedSensor& mounted = problem.sensors()[static_cast<std::size_t>(camera)];
  SeenByCamera all;
  all.low.fill(std::numeric_limits<double>::infinity());
  all.high.fill(-std::numeric_limits<double>::infinity());
  const CameraInfo* info = nullptr;
  for (const Sample& recorded : solution.samples) {
    const std::optional<Sample> paired = problem.paired(recorded);
    const Sample& sample = paired ? *paired : recorded;
    const Observation* seen = sample.observation(mounted.mount().name);
    if (seen == nullptr) continue;
    if (all.settings.empty()) all.settings = mounted.sensor().settings(*seen);
    if (info == nullptr && seen->camera)
      info = &*recorded.observation(mounted.mount().name)->camera;
    std::vector<double> distances(seen->features.size(), 0.0);
    set_distances(problem, places, camera, sample, distances);
    for (std::size_t i = 0; i < seen->features.size(); ++i) {
      if (!is_seen(seen->features[i])) continue;
      const Eigen::Vector2d pixel = seen->features[i].point.head<2>();
      all.pixels.push_back(pixel);
      all.distances.push_back(distances[i]);
      for (std::size_t k = 0; k < 2; ++k) {
        all.low[k] = std::min(all.low[k], pixel(static_cast<Eigen::Index>(k)));
        all.high[k] = std::max(all.high[k], pixel(static_cast<Eigen::Index>(k)));
      }
    }
  }
  if (info != nullptr && info->width > 0 && info->height > 0) {
    all.low = {0.0, 0.0};
    all.high = {static_cast<double>(info->width), static_cast<double>(info->height)};
  }
  return all;
}

// Two halves of the poses, solved apart.

/// Two halves of the poses.
struct Halves {
  std::array<Eigen::VectorXd, 2>
      values;  ///< of all parameters of the table, each half solved apart
  Eigen::MatrixXd
      spread;  ///< (free x free) covariance of their difference over unit noise: (H_1^-1 + H_2^-1)
  Eigen::MatrixXd whole;  ///< (free x free) the same of all poses: H^-1

  /// Covariance of the difference of some free parameters.
  /// @param known  their covariance with all poses, which has the noise and what poses share
  [[nodiscard]] Eigen::MatrixXd covariance(const std::vector<int>& columns,
                                           const Eigen::MatrixXd& known) const {
    const Eigen::MatrixXd unit = whole(columns, columns);
    return known.diagonal().cwiseQuotient(unit.diagonal()).mean() * spread(columns, columns);
  }
};

/// Solves each half of the poses apart; nullopt if that fails.
[[nodiscard]] std::optional<Halves> halves_of(const KnownSolution& solution) {
  constexpr int kFewest = 8;
  if (solution.poses.count < kFewest) return std::nullopt;
  const LinearFit& fit = solution.fit;
  const Eigen::MatrixXd& basis = fit.coordinates.basis;
  const auto inverse = [&](const Eigen::MatrixXd& information) {
    return Eigen::MatrixXd(basis * Spectrum(information).pseudo_inverse() * basis.transpose());
  };
  Halves halves{{}, Eigen::MatrixXd::Zero(basis.rows(), basis.rows()), inverse(fit.hessian)};
  std::vector<int> half_of;  // each sample
  for (const int pose : solution.poses.of_sample) half_of.push_back(pose % 2);
  const std::vector<RowSums> others = sums_without_parts(fit, fit.loss, half_of);
  for (int half = 0; half < 2; ++half) {
    constexpr double kPriors = 0.5;
    Eigen::VectorXd weights = fit.loss;
    for (const RowBlock& block : fit.blocks) {
      if (half_of[static_cast<std::size_t>(block.sample)] != half) continue;
      weights.segment(block.first, block.size).setZero();
    }
    const RowSums& sums = others[static_cast<std::size_t>(half)];
    halves.spread += inverse(sums.information + kPriors * fit.prior_hessian);
    try {
      const Eigen::VectorXd first = step_to_minimum(fit, sums, kPriors);
      halves.values[static_cast<std::size_t>(half)] =
          refit(solution.evaluator, solution.values, fit, weights, first, kPriors).values;
    } catch (const std::domain_error&) {  // a point behind a camera
      return std::nullopt;
    }
  }
  return halves;
}

/// How far halves are apart where features are, beside what is expected; nullopt if nothing is.
/// @param derivatives  A of projection_map.hpp, of each cell
/// @param covariance   of the difference of the camera's free parameters
/// @param freedom      of the noise
[[nodiscard]] std::optional<HalvesApart> halves_apart(
    const ProjectionMap& map, const std::vector<SolvedProjection::PixelByFree>& derivatives,
    const Eigen::MatrixXd& covariance, double freedom) {
  const Eigen::Index n = covariance.rows();
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(n, n);
  double difference = 0.0, cells = 0.0;
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    if (map.cells[i].features == 0 || !derivatives[i].allFinite()) continue;
    squares += derivatives[i].transpose() * derivatives[i];
    difference += map.cells[i].difference * map.cells[i].difference;
    cells += 1.0;
  }
  if (cells == 0.0) return std::nullopt;
  const Eigen::MatrixXd of_pixels = covariance * squares;
  const double allowed = of_pixels.trace();
  if (!(allowed > 0.0)) return std::nullopt;
  const double independent = allowed * allowed / (of_pixels * of_pixels).trace();
  return HalvesApart{std::sqrt(difference / cells), std::sqrt(allowed / cells),
                     f_tail(difference / allowed, independent, freedom)};
}

/// The map of one camera.
class CameraMap {
 public:
  CameraMap(const KnownSolution& solution, const SolvedProjection& camera, SeenByCamera seen)
      : camera_(camera), seen_(std::move(seen)) {
    const std::vector<int>& columns = camera.columns();
    covariance_ = solution.uncertainty.covariance.matrix()(columns, columns);
    for (const int c : columns) deviations_.push_back(solution.uncertainty.deviation(c));
    set_undetermined(solution);
    std::vector<double> known;
    for (const double d : seen_.distances) {
      if (d > 0.0) known.push_back(d);
    }
    distance_ = known.empty() ? 0.0 : median_of(known);
    motion_ = motion();
  }

  /// @param apart   difference of the camera's free parameters between halves
  /// @param allowed  covariance of that difference
  [[nodiscard]] ProjectionMap map(const std::string& name,
                                  const std::optional<Eigen::VectorXd>& apart,
                                  const Eigen::MatrixXd& allowed, double freedom) const {
    ProjectionMap all{.sensor = name, .low = seen_.low, .high = seen_.high};
    all.distance = distance_;
    constexpr int kColumns = 16;
    const double width = all.high[0] - all.low[0], height = all.high[1] - all.low[1];
    all.columns = kColumns;
    all.rows = std::clamp(static_cast<int>(std::lround(kColumns * height / width)), 4, 32);
    std::vector<SolvedProjection::PixelByFree> derivatives;
    for (int r = 0; r < all.rows; ++r) {
      for (int c = 0; c < all.columns; ++c) {
        KnownPixel& cell = all.cells.emplace_back();
        cell.pixel = {all.low[0] + width * (c + 0.5) / all.columns,
                      all.low[1] + height * (r + 0.5) / all.rows};
        derivatives.push_back(set(cell, apart));
      }
    }
    for (const Eigen::Vector2d& pixel : seen_.pixels) {
      const KnownPixel* cell = all.at(pixel.x(), pixel.y());
      if (cell != nullptr) ++all.cells[static_cast<std::size_t>(cell - all.cells.data())].features;
    }
    all.numbers = camera_.numbers(seen_.settings, deviations_);
    add_focal(all);
    if (apart && std::isfinite(all.deviations()[1])) {
      all.halves = halves_apart(all, derivatives, allowed, freedom);
    }
    return all;
  }

 private:
  /// Keeps what samples do not determine of the camera.
  void set_undetermined(const KnownSolution& solution) {
    const Eigen::MatrixXd& null = solution.fit.coordinates.null;
    undetermined_ = null(camera_.columns(), Eigen::all);
    sizes_ = null;
    for (Eigen::Index c = 0; c < null.rows(); ++c) {
      const int p = solution.free.parameters()[static_cast<std::size_t>(c)];
      sizes_.row(c) /= useful_deviation(solution.evaluator.problem().table()[p]);
    }
  }
  /// How far a number moves by an undetermined combination of the parameters, the one that moves it most, if that is off as
  /// far as typical robots are: see mark_undetermined().
  /// @param by  (free of the camera) derivative of the number
  [[nodiscard]] double unknown(const Eigen::RowVectorXd& by) const {
    constexpr double kOff = 0.4;  // of useful_deviation()
    if (undetermined_.cols() == 0) return 0.0;
    const Eigen::VectorXd along = (by * undetermined_).transpose();
    const double size = (sizes_ * along).lpNorm<Eigen::Infinity>();
    return size > 0.0 ? kOff * along.squaredNorm() / size : 0.0;
  }
  /// Adds the focal length at the axis, as it appears in u, if it is known and fx is not.
  void add_focal(ProjectionMap& to) const {
    if (!(to.focal_deviation() > ProjectionMap::kKnownFocal)) return;
    constexpr double kStep = 1e-3;  // radians
    const Vector3<double> right(kStep, 0.0, 1.0), left(-kStep, 0.0, 1.0);
    const Eigen::RowVectorXd by =
        (camera_.by_free(right).row(0) - camera_.by_free(left).row(0)) / (2.0 * kStep);
    const double focal = (camera_.pixel(right).x() - camera_.pixel(left).x()) / (2.0 * kStep);
    const double deviation = std::sqrt(std::max(0.0, (by * covariance_ * by.transpose()).value()));
    const bool is_known = deviation < ProjectionMap::kKnownFocal * focal &&
                          !is_lost(unknown(by), deviation, kSmall * focal);
    if (is_known) to.numbers.push_back({std::string(ProjectionMap::kAxisFocal), focal, deviation});
  }
  /// True if what is not determined moves a number by more than its deviation, and by more than is small.
  [[nodiscard]] static bool is_lost(double moves, double deviation, double small) {
    return moves > std::max(deviation, small);
  }
  [[nodiscard]] Vector3<double> point(const Eigen::Vector2d& pixel, double distance) const {
    return (distance > 0.0 ? distance : 1.0) * camera_.direction(pixel);
  }
  /// (6 x free) of some features, evenly chosen; without translation where no distance is known.
  [[nodiscard]] Eigen::MatrixXd motion() const {
    constexpr std::size_t kMost = 1000;
    TakenUp taken(std::ssize(camera_.columns()));
    const std::size_t step = 1 + seen_.pixels.size() / kMost;
    for (std::size_t i = 0; i < seen_.pixels.size(); i += step) {
      const double distance = seen_.distances[i];
      const Vector3<double> p = point(seen_.pixels[i], distance);
      taken.add(camera_.by_free(p), SolvedProjection::by_motion(camera_.by_point(p), p,
                                                                distance > 0.0 ? distance_ : 0.0));
    }
    return taken.motion();
  }
  /// Sets what is known of a cell.
  /// @returns  A of the header
  [[nodiscard]] SolvedProjection::PixelByFree set(
      KnownPixel& cell, const std::optional<Eigen::VectorXd>& apart) const {
    const Vector3<double> p = point({cell.pixel[0], cell.pixel[1]}, distance_);
    const SolvedProjection::PixelByPoint by_point = camera_.by_point(p);
    SolvedProjection::PixelByFree a = camera_.by_free(p);
    a += SolvedProjection::by_motion(by_point, p, distance_) * motion_;
    const Eigen::Matrix2d c = a * covariance_ * a.transpose();
    cell.covariance = {c(0, 0), c(1, 1), c(0, 1)};
    const Eigen::Matrix<double, 3, 2> across =
        by_point.transpose() * (by_point * by_point.transpose()).inverse();
    cell.metres =
        distance_ > 0.0 ? std::sqrt(std::max(0.0, (across * c * across.transpose()).trace())) : 0.0;
    const double moves = std::hypot(unknown(a.row(0)), unknown(a.row(1)));
    if (c.allFinite() && is_lost(moves, cell.deviation(), kSmallPixel)) {
      cell.covariance = {HUGE_VAL, HUGE_VAL, 0.0};
      cell.metres = HUGE_VAL;
    }
    cell.difference = apart ? (a * *apart).norm() : 0.0;
    return a;
  }

  const SolvedProjection& camera_;
  SeenByCamera seen_;
  Eigen::MatrixXd covariance_, motion_;
  static constexpr double kSmallPixel = 0.05;  // pixels: corners are found to that
  static constexpr double kSmall = 1e-3;       // of a focal length

  std::vector<double> deviations_;  ///< of its free parameters
  Eigen::MatrixXd undetermined_;    ///< (free of the camera x combinations)
  Eigen::MatrixXd sizes_;           ///< (all free x combinations) by useful_deviation()
  double distance_ = 0.0;
};

}  // namespace
}  // namespace detail

double KnownPixel::deviation() const {
  return std::sqrt(covariance[0] + covariance[1]);
}

const KnownPixel* ProjectionMap::at(double u, double v) const {
  const auto part = [](double x, double from, double to, int parts) {
    return static_cast<int>(std::floor((x - from) / (to - from) * parts));
  };
  if (!(u >= low[0] && u <= high[0] && v >= low[1] && v <= high[1])) return nullptr;
  const int c = std::min(part(u, low[0], high[0], columns), columns - 1);
  const int r = std::min(part(v, low[1], high[1], rows), rows - 1);
  return &cells[static_cast<std::size_t>(r * columns + c)];
}

std::size_t ProjectionMap::region_of(const KnownPixel& cell) const {
  const auto share = [&](std::size_t i) { return (cell.pixel[i] - low[i]) / (high[i] - low[i]); };
  return image_region(share(0), share(1));
}

std::array<double, 3> ProjectionMap::deviations() const {
  std::vector<double> all, of_features;
  for (const KnownPixel& cell : cells) {
    const double deviation = cell.deviation();
    if (std::isnan(deviation)) continue;
    all.push_back(deviation);
    if (cell.features > 0) of_features.push_back(deviation);
  }
  if (all.empty() || of_features.empty()) return {};
  const auto [least, most] = std::minmax_element(all.begin(), all.end());
  return {*least, median_of(of_features), *most};
}

const CameraNumber* ProjectionMap::number(std::string_view name) const {
  const auto found = std::find_if(numbers.begin(), numbers.end(),
                                  [&](const CameraNumber& one) { return one.name == name; });
  return found == numbers.end() ? nullptr : &*found;
}

const CameraNumber* ProjectionMap::focal() const {
  const CameraNumber* at_axis = number(kAxisFocal);
  return at_axis != nullptr ? at_axis : number("fx");
}

double ProjectionMap::focal_deviation() const {
  const CameraNumber* of = focal();
  return of == nullptr ? 0.0 : of->deviation.value_or(0.0) / std::abs(of->value);
}

std::vector<ProjectionMap> projection_maps(const KnownSolution& solution) {
  const AnyProblem& problem = solution.evaluator.problem();
  std::vector<ProjectionMap> maps;
  std::optional<detail::Halves> halves;
  const FeaturePlaces places(problem, solution.values);
  for (std::size_t s = 0; s < problem.sensors().size(); ++s) {
    const MountedSensor& mounted = problem.sensors()[s];
    if (!mounted.sensor().is_camera() || measures_depth(mounted.sensor())) continue;
    const std::vector<int>& own_parameters = mounted.parameters();
    const bool frees_some = std::any_of(own_parameters.begin(), own_parameters.end(), [&](int p) {
      return p >= 0 && solution.free.column(p) >= 0;
    });
    if (!frees_some) continue;  // before looking at its pixels
    detail::SeenByCamera seen = detail::seen_by(solution, places, static_cast<int>(s));
    if (seen.pixels.empty()) continue;
    const detail::SolvedProjection camera(mounted, solution.free, solution.values, seen.settings);
    if (maps.empty()) halves = detail::halves_of(solution);
    std::optional<Eigen::VectorXd> apart;
    const auto own = [&](std::size_t half) {
      const Eigen::VectorXd& values = halves->values[half];
      return camera.own({values.data(), static_cast<std::size_t>(values.size())});
    };
    Eigen::MatrixXd allowed;
    if (halves) {
      const std::vector<int>& columns = camera.columns();
      apart = own(0) - own(1);
      allowed =
          halves->covariance(columns, solution.uncertainty.covariance.matrix()(columns, columns));
    }
    maps.push_back(detail::CameraMap(solution, camera, std::move(seen))
                       .map(mounted.mount().name, apart, allowed, solution.poses.count - 1.0));
  }
  return maps;
}

std::vector<ProjectionMap> projection_maps(const AnyProblem& problem, const FreeSet& free,
                                           ParameterValues values,
                                           const std::vector<Sample>& samples) {
  const auto evaluator = problem.evaluator(free, 1);
  const LinearFit fit =
      linear_fit(*evaluator, values, determined_coordinates(problem, free, values));
  const Eigen::MatrixXd inverse = detail::Spectrum(fit.hessian).pseudo_inverse();
  const std::vector<BlockNoise> noise = estimate_noise(problem, fit, inverse);
  const PoseGroups poses = pose_groups(problem, samples);
  const Uncertainty known =
      uncertainty(problem, fit, noise, poses, feature_links(problem, fit, samples),
                  prior_variance(noise) * fit.prior_hessian);
  return projection_maps({*evaluator, free, values, fit, known, samples, poses});
}

}  // namespace kinecal
