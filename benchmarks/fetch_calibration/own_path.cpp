#include "own_path.hpp"

#include "counting.hpp"
#include "fetch_crate.hpp"
#include "kinecal/evaluation/basic_problem.ipp"
#include "kinecal/solve/solve.hpp"
#include "own_problem.hpp"
#include "peak.hpp"

namespace kinecal::bench {
namespace {

/// The workload with chains built at run time.
template <class S>
BasicProblem<S> from_models(const FetchWork& work, int samples) {
  return own_problem<S>(work, work.cycled(samples));
}

/// The workload from the types of a crate.
template <class S>
BasicProblem<S> from_crate(const FetchWork& work, int samples) {
  BasicProblem<S> problem = FetchCrate().problem<S>(work.table);
  for (const Sample& sample : work.cycled(samples)) problem.add_sample(sample);
  return problem;
}

template <class S>
class OwnPath {
 public:
  using MakeProblem = BasicProblem<S> (*)(const FetchWork&, int samples);

  OwnPath(const FetchWork& work, int samples, MakeProblem make_problem)
      : problem_(make_problem(work, samples)),
        free_(all_free(work.table)),
        values_(work.initial_values()),
        evaluator_(problem_, free_) {}

  /// Residuals and dense Jacobian, one pack of samples after the other.
  void evaluate(Values x, bool jacobian) {
    evaluator_.for_each_term(
        x, jacobian, [&](int, const kinecal::detail::TermCode<S>& code, const auto& views, auto) {
          code.evaluate(views, jacobian, Linearization::measured, rows_);
          detail::hide(rows_);
        });
  }

  [[nodiscard]] Sums normal_equations(Values x) {
    const NormalEquations normal = evaluator_.normal_equations(x);
    return {normal.cost, normal.gradient, normal.hessian};
  }

  [[nodiscard]] Stacked stacked(Values x, bool jacobian) {
    Stacked all{Eigen::VectorXd(problem_.num_residuals()),
                RowMajor(problem_.num_residuals(), kParameters)};
    (void)evaluator_.evaluate(x, jacobian, [&](int, int n, const TermResiduals& r) {
      all.residual.segment<kRows>(kRows * n) = r.residual;
      if (jacobian) all.jacobian.middleRows<kRows>(kRows * n) = r.jacobian;
    });
    return all;
  }

  [[nodiscard]] Solved solve() {
    const auto start = std::chrono::steady_clock::now();
    SolveOptions options;
    options.threads = 1;
    options.function_tolerance = solver_options().function_tolerance;
    Eigen::VectorXd values = values_;
    const StepResult result = kinecal::solve(problem_, free_, values, options);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    return {seconds.count(), result.final_cost, result.iterations, result.converged, values};
  }

 private:
  BasicProblem<S> problem_;
  FreeSet free_;
  Eigen::VectorXd values_;
  Evaluator<S> evaluator_;
  kinecal::detail::BatchRows<S> rows_;
};

/// Operations per sample, including its share of what is done once for all samples.
Flops own_flops(const FetchWork& work) {
  OwnPath<Counting> path(work, kSamples, from_models);
  const Eigen::VectorXd values = work.timed_values();
  const Values x(values.data(), kParameters);
  const auto per_sample = [](const Operations& done) { return double(done.total()) / kSamples; };
  return {per_sample(operations_of([&] { path.evaluate(x, false); })),
          per_sample(operations_of([&] { path.evaluate(x, true); })),
          per_sample(operations_of([&] { (void)path.normal_equations(x); }))};
}

template <class S>
Method own_method(const std::string& name, const FetchWork& work, const Flops& flops,
                  typename OwnPath<S>::MakeProblem make_problem) {
  const auto path = std::make_shared<OwnPath<S>>(work, kSamples, make_problem);
  return {
      .name = name,
      .exact = true,
      .residuals = [path](Values x) { path->evaluate(x, false); },
      .residuals_jacobian = [path](Values x) { path->evaluate(x, true); },
      .normal_equations = [path](Values x) { return path->normal_equations(x); },
      .stacked = [path](Values x, bool jacobian) { return path->stacked(x, jacobian); },
      .solve = [&work, make_problem](int n) { return OwnPath<S>(work, n, make_problem).solve(); },
      .flops = flops};
}

}  // namespace

std::vector<Method> own_methods(const FetchWork& work) {
  const Flops flops = own_flops(work);
  return {own_method<double>("scalar", work, flops, from_models<double>),
          own_method<Packet>("packets", work, flops, from_models<Packet>),
          own_method<Packet>("crate", work, {}, from_crate<Packet>)};
}

}  // namespace kinecal::bench
