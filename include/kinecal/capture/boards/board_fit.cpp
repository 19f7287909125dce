// Definitions of board_fit.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/boards/board_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "kinecal/capture/boards/corner_fit.ipp"
#include "kinecal/geometry/median.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Powers of a place on the target: 1, x, y, x^2, ...
[[nodiscard]] Eigen::VectorXd powers_of(const Eigen::Vector2d& place, int degree) {
  Eigen::VectorXd row((degree + 1) * (degree + 2) / 2);
  Eigen::Index at = 0;
  for (int sum = 0; sum <= degree; ++sum) {
    for (int y = 0; y <= sum; ++y) {
      row(at++) = std::pow(place.x(), sum - y) * std::pow(place.y(), y);
    }
  }
  return row;
}

/// Takes a smooth field off what a fit misses.
/// @param degree  of its polynomial
[[nodiscard]] CornerFit without_smooth_field(const PlaneView& view, const CornerFit& from,
                                             int degree) {
  constexpr int kPasses = 12;
  Eigen::Vector2d least = view.plane.front(), most = least;
  for (const Eigen::Vector2d& p : view.plane) least = least.cwiseMin(p), most = most.cwiseMax(p);
  const Eigen::Vector2d middle = 0.5 * (least + most);
  const double size = std::max(1e-12, 0.5 * (most - least).maxCoeff());
  CornerFit fit = from;
  for (int pass = 0; pass < kPasses; ++pass) {
    const Eigen::Index n = powers_of(middle, degree).size();
    Eigen::MatrixXd sums = 1e-9 * Eigen::MatrixXd::Identity(n, n);
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n, 2);
    std::vector<Eigen::VectorXd> rows;
    for (std::size_t i = 0; i < view.plane.size(); ++i) {
      rows.push_back(powers_of((view.plane[i] - middle) / size, degree));
      if (!(fit.weights[i] > 0.0)) continue;
      sums += fit.weights[i] * rows[i] * rows[i].transpose();
      right += fit.weights[i] * rows[i] * from.misses[i].transpose();
    }
    const Eigen::MatrixXd field = sums.ldlt().solve(right);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      fit.misses[i] = from.misses[i] - field.transpose() * rows[i];
    }
    weigh(fit);
  }
  return fit;
}

/// The fit with the lens that agrees best; with a smooth field if that is not enough: of a paper that curls or waves, or of
/// a lens whose axis is not at the centre of the image.
[[nodiscard]] CornerFit best_fit(const PlaneView& view, const CameraInfo& camera) {
  // Four corners or more for each coefficient: fewer would follow a wrong one.
  constexpr std::pair<int, std::size_t> kFields[] = {{2, 24}, {3, 40}, {4, 80}, {5, 120}};
  const CornerFit lens = best_lens(view, camera);
  CornerFit best = lens;
  for (const auto& [degree, corners] : kFields) {
    if (is_good(best) || view.plane.size() < corners) break;
    take_better(without_smooth_field(view, lens, degree), best);
  }
  return best;
}

/// Median distance of a corner to its nearest neighbour, pixels.
[[nodiscard]] double median_gap(const std::vector<Eigen::Vector2d>& pixels) {
  std::vector<double> gaps;
  for (const Eigen::Vector2d& a : pixels) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector2d& b : pixels) {
      if (&a != &b) nearest = std::min(nearest, (a - b).norm());
    }
    gaps.push_back(nearest);
  }
  return gaps.empty() ? 0.0 : median_of(std::move(gaps));
}

[[nodiscard]] bool is_flat(const std::vector<TargetCorner>& corners) {
  return std::all_of(corners.begin(), corners.end(), [&](const TargetCorner& c) {
    return std::abs(c.target.z() - corners.front().target.z()) < 1e-9;
  });
}

}  // namespace
}  // namespace detail

bool BoardFit::agrees() const {
  if (off.empty()) return true;
  constexpr double kPixels = 2.0, kOfGap = 0.08;
  return typical <= std::max(kPixels, kOfGap * gap);
}

int BoardFit::wrong() const {
  return static_cast<int>(
      std::count_if(off.begin(), off.end(), [&](double distance) { return distance > limit; }));
}

BoardFit fit_board(const std::vector<TargetCorner>& corners, const CameraInfo& camera) {
  BoardFit board;
  if (corners.size() < detail::kFewest || !detail::is_flat(corners)) return board;
  detail::PlaneView view;
  for (const TargetCorner& corner : corners) {
    view.plane.push_back(corner.target.head<2>());
    view.pixels.push_back(corner.pixel);
  }
  const detail::CornerFit fit = detail::best_fit(view, camera);
  if (!std::isfinite(fit.typical)) return board;
  for (std::size_t i = 0; i < fit.misses.size(); ++i) {
    const Eigen::Vector2d& miss = fit.misses[i];
    board.off.push_back(miss.allFinite() ? miss.norm() : std::numeric_limits<double>::infinity());
    board.fitted.emplace_back(view.pixels[i] - miss);
  }
  board.typical = fit.typical;
  board.gap = detail::median_gap(view.pixels);
  constexpr double kFewOfGap = 0.03;
  board.limit = detail::limit_of(fit);
  // Few corners do not show the lens.
  if (corners.size() < detail::kForLens) board.limit += kFewOfGap * board.gap;
  return board;
}

std::string board_fault(const BoardFit& fit) {
  constexpr double kMostWrong = 0.4;
  if (fit.off.empty()) return "";
  const double all = static_cast<double>(fit.off.size());
  if (!fit.agrees()) {
    return "its corners do not agree with one flat board: half of them are more than " +
           detail::one_digit(fit.typical) +
           " pixels from where the others put them; do its numbers of columns and rows and its "
           "distances match the print?";
  }
  if (fit.wrong() > kMostWrong * all) {
    return std::to_string(fit.wrong()) + " of its " + std::to_string(fit.off.size()) +
           " corners are more than " + detail::one_digit(fit.limit) +
           " pixels from where the others put them";
  }
  return "";
}

void drop_wrong_corners(const BoardFit& fit, std::vector<TargetCorner>& found) {
  if (fit.off.empty()) return;
  std::vector<TargetCorner> left;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (fit.off[i] <= fit.limit) left.push_back(found[i]);
  }
  found = std::move(left);
}

std::string drop_wrong_corners(const CameraInfo& camera, std::vector<TargetCorner>& found) {
  const BoardFit fit = fit_board(found, camera);
  std::string fault = board_fault(fit);
  if (fault.empty()) drop_wrong_corners(fit, found);
  return fault;
}

}  // namespace kinecal
