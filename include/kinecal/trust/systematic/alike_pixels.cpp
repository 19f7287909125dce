// Measures how far residuals depend on the place in an image.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/systematic/alike_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <utility>

#include "kinecal/text/image_region.hpp"
#include "kinecal/trust/uncertainty/feature_places.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Sums of residuals of a view in a cell of the image.
struct CellSum {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double count = 0.0;
};

/// Residuals of a camera by view and cell.
class ImageCells {
 public:
  explicit ImageCells(const ProjectionMap& map) : map_(map) {}

  void add(int view, const Eigen::Vector2d& pixel, const Eigen::Vector2d& residual) {
    const KnownPixel* cell = map_.at(pixel.x(), pixel.y());
    if (cell == nullptr) return;
    CellSum& sum = views_[view][cell - map_.cells.data()];
    sum.sum += residual;
    sum.count += 1.0;
    squares_ += residual.squaredNorm();
    count_ += 1.0;
  }

  [[nodiscard]] AlikePixels alike() const {
    AlikePixels found{.sensor = map_.sensor, .region = {}};
    constexpr std::size_t kFewestViews = 8;
    if (views_.size() < kFewestViews || count_ == 0.0) return found;
    found.all = std::sqrt(squares_ / count_);
    const std::vector<double> weights = pair_weights();
    const std::vector<double> parts = parts_of(std::vector<double>(views_.size(), 1.0), weights);
    double part = 0.0;
    for (const double p : parts) part += p;
    if (!(part > 0.0)) return found;
    found.chance = chance_of(part, weights);
    found.alike = std::sqrt(part / count_);
    const auto largest = std::max_element(parts.begin(), parts.end()) - parts.begin();
    const KnownPixel& cell = map_.cells[static_cast<std::size_t>(largest)];
    found.pixel = cell.pixel;
    CellSum there;
    for (const auto& [view, cells] : views_) {
      const auto at = cells.find(largest);
      if (at == cells.end()) continue;
      there.sum += at->second.sum;
      there.count += at->second.count;
    }
    found.there = {there.sum.x() / there.count, there.sum.y() / there.count};
    found.region = kImageRegionNames[map_.region_of(cell)];
    return found;
  }

 private:
  /// n_c / (n_c^2 - sum_v n_cv^2) of each cell; 0 if only one view has features there.
  [[nodiscard]] std::vector<double> pair_weights() const {
    std::vector<double> n(map_.cells.size(), 0.0), own(n.size(), 0.0);
    for (const auto& [view, cells] : views_) {
      for (const auto& [c, sum] : cells) {
        n[static_cast<std::size_t>(c)] += sum.count;
        own[static_cast<std::size_t>(c)] += sum.count * sum.count;
      }
    }
    for (std::size_t c = 0; c < n.size(); ++c) {
      const double pairs = n[c] * n[c] - own[c];
      n[c] = pairs > 0.0 ? n[c] / pairs : 0.0;
    }
    return n;
  }
  /// n_c m_c^2 of each cell.
  /// @param signs  of each view
  [[nodiscard]] std::vector<double> parts_of(const std::vector<double>& signs,
                                             const std::vector<double>& weights) const {
    std::vector<Eigen::Vector2d> sums(weights.size(), Eigen::Vector2d::Zero());
    std::vector<double> parts(weights.size(), 0.0);
    std::size_t v = 0;
    for (const auto& [view, cells] : views_) {
      for (const auto& [c, sum] : cells) {
        sums[static_cast<std::size_t>(c)] += signs[v] * sum.sum;
        parts[static_cast<std::size_t>(c)] -= sum.sum.squaredNorm();
      }
      ++v;
    }
    for (std::size_t c = 0; c < parts.size(); ++c) {
      parts[c] = weights[c] * (parts[c] + sums[c].squaredNorm());
    }
    return parts;
  }
  [[nodiscard]] double chance_of(double part, const std::vector<double>& weights) const {
    constexpr int kTrials = 999;
    std::mt19937 random(1);
    int as_large = 0;
    std::vector<double> signs(views_.size());
    for (int i = 0; i < kTrials; ++i) {
      for (double& sign : signs) sign = (random() & 1U) != 0U ? 1.0 : -1.0;
      double sum = 0.0;
      for (const double p : parts_of(signs, weights)) sum += p;
      as_large += sum >= part ? 1 : 0;
    }
    return (1.0 + as_large) / (1.0 + kTrials);
  }
  const ProjectionMap& map_;
  std::map<int, std::map<std::ptrdiff_t, CellSum>> views_;
  double squares_ = 0.0, count_ = 0.0;
};

}  // namespace
}  // namespace detail

std::vector<AlikePixels> alike_pixels(const AnyProblem& problem, const LinearFit& fit,
                                      const std::vector<ProjectionMap>& maps,
                                      std::span<const Sample> samples) {
  std::vector<AlikePixels> all;
  for (const ProjectionMap& map : maps) {
    detail::ImageCells cells(map);
    for (const RowBlock& block : fit.blocks) {
      const Term& term = problem.term(block.term);
      const bool compares = std::any_of(term.sensors.begin(), term.sensors.end(), [&](int s) {
        return problem.sensors()[static_cast<std::size_t>(s)].mount().name == map.sensor;
      });
      if (!compares || term.options.unit != "px" || term.feature_size != 2) continue;
      const Observation* seen =
          samples[static_cast<std::size_t>(block.sample)].observation(map.sensor);
      if (seen == nullptr) continue;
      for (Eigen::Index i = 0; 2 * i < block.size; ++i) {
        const Feature* feature =
            observed_feature(*seen, problem.feature(block.term, block.sample, i));
        if (feature == nullptr || !feature->point.allFinite()) continue;
        cells.add(block.sample, feature->point.head<2>(),
                  fit.residual.segment<2>(block.first + 2 * i) / term.weight);
      }
    }
    all.push_back(cells.alike());
  }
  return all;
}

}  // namespace kinecal
