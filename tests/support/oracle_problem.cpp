#include "support/oracle_problem.hpp"

namespace kinecal::test {
namespace {

struct Robust {
  double rho, derivative;
};

/// What a squared residual costs, and its derivative.
Robust robust(LossType type, double c, double squared) {
  const double ratio = squared / (c * c);
  if (type == LossType::huber && ratio > 1.0) {
    return {c * (2.0 * std::sqrt(squared) - c), c / std::sqrt(squared)};
  }
  if (type == LossType::cauchy) return {c * c * std::log1p(ratio), 1.0 / (1.0 + ratio)};
  if (type == LossType::tukey) {
    if (ratio >= 1.0) return {c * c / 3.0, 0.0};
    return {squared * (1.0 - ratio + ratio * ratio / 3.0), (1.0 - ratio) * (1.0 - ratio)};
  }
  return {squared, 1.0};
}

/// Adds the rows of one feature to normal equations.
/// @param factor  of the block's weight
void add(const Eigen::VectorXd& residual, const Eigen::MatrixXd& jacobian,
         const TermOptions& options, double factor, const FreeSet& free, Losses losses,
         NormalEquations& total) {
  Eigen::MatrixXd columns(residual.size(), free.size());
  for (int c = 0; c < free.size(); ++c) {
    columns.col(c) = jacobian.col(free.parameters()[static_cast<std::size_t>(c)]);
  }
  LossType type = options.loss.type;
  if (losses == Losses::convex && type != LossType::none) type = LossType::huber;
  const double w2 = std::pow(options.weight() * factor, 2);
  const Robust cost = robust(type, options.loss.scale, w2 * residual.squaredNorm());
  total.cost += 0.5 * cost.rho;
  total.gradient += cost.derivative * w2 * columns.transpose() * residual;
  total.hessian += cost.derivative * w2 * columns.transpose() * columns;
}

/// True if all sensors of a term saw something and, where that is asked for, no others.
bool applies(const std::vector<std::string>& sensors, bool alone, const Sample& sample) {
  std::size_t observing = 0, of_term = 0;
  for (const Observation& seen : sample.observations) {
    if (seen.features.empty()) continue;
    ++observing;
    for (const std::string& name : sensors) of_term += seen.sensor == name ? 1 : 0;
  }
  return of_term == sensors.size() && (!alone || observing == of_term);
}

TermResiduals numbers(const OracleResiduals& residuals, int parameters) {
  TermResiduals numbers;
  numbers.resize(std::ssize(residuals), parameters);
  for (Eigen::Index i = 0; i < std::ssize(residuals); ++i) {
    const OracleJet& r = residuals[static_cast<std::size_t>(i)];
    numbers.residual(i) = r.a;
    numbers.jacobian.row(i) = r.v.head(parameters).transpose();
  }
  return numbers;
}

}  // namespace

OraclePlane<OracleJet> OracleView::plane() const {
  std::vector<Vector3<OracleJet>> those_there;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (there[i]) those_there.push_back(points[i]);
  }
  return oracle_plane(those_there);
}

OracleResiduals oracle_residual(const PointToPoint&, const Vector3<OracleJet>& a,
                                const Vector3<OracleJet>& b) {
  return {a.x() - b.x(), a.y() - b.y(), a.z() - b.z()};
}

OracleResiduals oracle_residual(const PointToPlane& block, const Vector3<OracleJet>& p) {
  const double d = block(Vector3<double>(0, 0, 0))(0);
  const double a = block(Vector3<double>(1, 0, 0))(0) - d;
  const double b = block(Vector3<double>(0, 1, 0))(0) - d;
  const double c = block(Vector3<double>(0, 0, 1))(0) - d;
  return {a * p.x() + b * p.y() + c * p.z() + d};
}

OracleResiduals oracle_residual(const PlaneToPlane& block, const OraclePlane<OracleJet>& a,
                                const OraclePlane<OracleJet>& b) {
  const double side = a.normal.dot(b.normal).a < 0.0 ? -1.0 : 1.0;
  OracleResiduals r;
  OracleJet offset(0.0);
  for (int k = 0; k < 3; ++k) {
    const OracleJet n_b = side * b.normal(k);
    r.push_back(block.normal_scale * (a.normal(k) - n_b));
    offset += n_b * (a.centroid(k) - b.centroid(k));
  }
  r.push_back(block.offset_scale * offset);
  return r;
}

OracleResiduals oracle_residual(const PointToPixel&, const OracleView& view,
                                const OracleView& camera, std::size_t i) {
  const Vector3<OracleJet> p = camera.pose.inverse()(view.points[i]);
  const Eigen::Matrix<OracleJet, 2, 1> pixel = oracle_pixel(
      *camera.seen->camera, p, camera.sensor->mount.parameter_prefix(), *camera.values);
  const Vector3<double>& observed = camera.seen->features[i].point;
  return {pixel.x() - observed.x(), pixel.y() - observed.y()};
}

OracleRows OracleProblem::rows(std::span<const double> x) const {
  if (x.size() > std::size_t(OracleJet::DIMENSION)) {
    throw std::invalid_argument("the oracle's jets are too narrow");
  }
  std::vector<OracleJet> jets;
  for (std::size_t p = 0; p < x.size(); ++p) jets.emplace_back(x[p], static_cast<int>(p));
  const OracleValues<OracleJet> values(table_, jets);
  OracleRows rows;
  for (std::size_t n = 0; n < samples_.size(); ++n) {
    std::map<std::string, OracleView> views;
    for (std::size_t t = 0; t < terms_.size(); ++t) {
      const Term& term = terms_[t];
      if (!applies(term.sensors, term.options.exclusive, samples_[n])) continue;
      Views of_term;
      for (const std::string& name : term.sensors) {
        if (!views.contains(name)) views[name] = view(name, samples_[n], values);
        of_term.push_back(&views[name]);
      }
      const OracleResiduals residuals = term.residuals(of_term);
      if (residuals.empty()) continue;
      TermResiduals& one = rows[{static_cast<int>(t), static_cast<int>(n)}];
      one = numbers(residuals, table_.size());
      const std::vector<double> of_features = factors(term, of_term);
      if (std::ssize(of_features) * term.size != one.residual.size()) continue;  // planes
      for (Eigen::Index i = 0; i < one.residual.size(); ++i) {
        one.factor(i) = of_features[static_cast<std::size_t>(i / term.size)];
      }
    }
  }
  return rows;
}

std::vector<double> OracleProblem::factors(const Term& term, const Views& views) {
  std::vector<double> all;
  for (std::size_t i = 0; i < views[0]->there.size(); ++i) {
    double variance = 0.0;
    bool there = true;
    for (const OracleView* view : views) {
      there = there && view->there[i];
      if (term.of_pixels && view == views[0]) continue;
      if (const auto sigma = view->seen->features[i].sigma) variance += std::pow(*sigma, 2);
    }
    if (there)
      all.push_back(variance > 0.0 ? term.options.sigma.value_or(1.0) / std::sqrt(variance) : 1.0);
  }
  return all;
}

NormalEquations OracleProblem::multiplied_out(const OracleRows& rows, std::span<const double> x,
                                              const FreeSet& free, Losses losses) const {
  NormalEquations total(free.size());
  for (const auto& [key, of_term] : rows) {
    const Term& term = terms_[static_cast<std::size_t>(key.first)];
    for (Eigen::Index i = 0; i < of_term.residual.size(); i += term.size) {
      add(of_term.residual.segment(i, term.size), of_term.jacobian.middleRows(i, term.size),
          term.options, of_term.factor(i), free, losses, total);
    }
  }
  for (const auto& [prior, options] : priors_) {
    const TermResiduals one = prior_rows(prior, x);
    for (std::size_t n = 0; n < samples_.size(); ++n) {
      add(one.residual, one.jacobian, options, 1.0, free, losses, total);
    }
  }
  return total;
}

OracleView OracleProblem::view(const std::string& name, const Sample& sample,
                               const OracleValues<OracleJet>& values) const {
  OracleView view;
  for (const OracleSensor& sensor : sensors_) {
    if (sensor.mount.name == name) view.sensor = &sensor;
  }
  for (const Observation& seen : sample.observations) {
    if (seen.sensor == name) view.seen = &seen;
  }
  view.values = &values;
  view.sample = &sample;
  view.pose = oracle_pose(robot_, base_, view.sensor->mount.frame, "", sample, values);
  std::map<std::string, OraclePose<OracleJet>> poses = {{"", view.pose},
                                                        {view.sensor->mount.frame, view.pose}};
  for (const Feature& feature : view.seen->features) {
    const Vector3<double>& p = feature.point;
    view.there.push_back(std::isfinite(p.x()) && std::isfinite(p.y()) && std::isfinite(p.z()));
    Vector3<OracleJet> point(OracleJet(p.x()), OracleJet(p.y()), OracleJet(p.z()));
    if (view.sensor->type == "camera3d") {
      point =
          oracle_depth_point(*view.seen->camera, p, view.sensor->mount.parameter_prefix(), values);
    }
    if (!poses.contains(feature.frame)) {
      poses[feature.frame] =
          oracle_pose(robot_, base_, view.sensor->mount.frame, feature.frame, sample, values);
    }
    view.points.push_back(poses[feature.frame](point));
    view.frames.push_back(poses[feature.frame]);
  }
  return view;
}

TermResiduals OracleProblem::prior_rows(const Prior& prior, std::span<const double> x) const {
  const std::vector<std::pair<std::string, double>> scales = {
      {"", prior.joint_scale},      {"_x", prior.position_scale}, {"_y", prior.position_scale},
      {"_z", prior.position_scale}, {"_a", prior.rotation_scale}, {"_b", prior.rotation_scale},
      {"_c", prior.rotation_scale}};
  TermResiduals rows;
  rows.resize(std::ssize(scales), table_.size());
  for (int row = 0; row < std::ssize(scales); ++row) {
    const auto& [axis, scale] = scales[static_cast<std::size_t>(row)];
    for (int p = 0; p < table_.size(); ++p) {
      if (table_[p].name != prior.param + axis) continue;
      rows.residual(row) =
          scale * (x[static_cast<std::size_t>(p)] - prior.mean[static_cast<std::size_t>(row)]);
      rows.jacobian(row, p) = scale;
    }
  }
  return rows;
}

}  // namespace kinecal::test
