// The main benchmark: the time to evaluate and solve the calibration of a Fetch, by each method, on
// one thread, and as a fraction of the processor's peak.
//
//   fetch_calibration_bench [--json FILE] [--quick] [--samples N]
//
// All methods are compared with each other before anything is timed; exit code 1 if they differ.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "checks.hpp"
#include "comparisons.hpp"
#include "flops.hpp"
#include "kdl_numeric.hpp"
#include "own_path.hpp"
#include "report.hpp"
#include "timing.hpp"
#include "wide_jets.hpp"

namespace kinecal::bench {
namespace {

struct Options {
  std::string json;
  int rounds = 21;
  int most_samples = 100000;
};

[[noreturn]] void usage(const std::string& mistake) {
  fmt::print(stderr,
             "error: {}\nusage: fetch_calibration_bench [--json FILE] [--quick] [--samples N]\n",
             mistake);
  std::exit(1);
}

Options read_options(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string_view option = argv[i];
    const auto value = [&]() -> std::string {
      if (i + 1 >= argc) usage(std::string(option) + " takes a value");
      return argv[++i];
    };
    if (option == "--json") {
      options.json = value();
    } else if (option == "--quick") {
      options.rounds = 5;
    } else if (option == "--samples") {
      options.most_samples = std::atoi(value().c_str());
      if (options.most_samples < kSamples) usage("--samples takes a number from 100 on");
    } else {
      usage("unknown option '" + std::string(option) + "'");
    }
  }
  return options;
}

/// The method of a class that evaluates stacked rows and solves with Ceres.
template <class Evaluator>
Method stacked_method(const std::string& name, bool exact, const FetchWork& work,
                      const Flops& flops) {
  const auto all = std::make_shared<Evaluator>(work, kSamples);
  return {.name = name,
          .exact = exact,
          .residuals = [all](Values x) { all->evaluate(x, false); },
          .residuals_jacobian = [all](Values x) { all->evaluate(x, true); },
          .normal_equations =
              [all](Values x) {
                all->evaluate(x, true);
                return sums_of(all->stacked());
              },
          .stacked =
              [all](Values x, bool jacobian) {
                all->evaluate(x, jacobian);
                return all->stacked();
              },
          .solve = [&work](int n) { return Evaluator(work, n).solve(); },
          .flops = flops};
}

/// All methods in the order of the report; the first is the yardstick.
std::vector<Method> all_methods(const FetchWork& work) {
  std::vector<Method> methods = own_methods(work);
  methods.insert(methods.begin(),
                 {stacked_method<KdlNumeric>("kdl_numeric", false, work, {}),
                  stacked_method<WideJets>("jet", true, work, wide_jet_flops(work))});
  return methods;
}

const Method& exact_one(const std::vector<Method>& methods) {
  return *std::find_if(methods.begin(), methods.end(), [](const Method& m) { return m.exact; });
}

std::vector<Row> time_evaluations(const std::vector<Method>& methods, Values x, int rounds) {
  std::vector<Timed> all;
  for (const Method& method : methods) {
    all.push_back({[&method, x] { method.residuals(x); }});
    all.push_back({[&method, x] { method.residuals_jacobian(x); }});
    all.push_back({[&method, x] {
      Sums sums = method.normal_equations(x);
      detail::hide(sums);
    }});
  }
  time_interleaved(all, rounds);
  const auto ns_a_sample = [&](std::size_t i) { return 1e9 * all[i].seconds / kSamples; };
  std::vector<Row> rows;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    rows.push_back({methods[m].name,
                    ns_a_sample(3 * m),
                    ns_a_sample(3 * m + 1),
                    ns_a_sample(3 * m + 2),
                    {},
                    methods[m].flops});
  }
  return rows;
}

/// Solves n samples a few times by each method, unless it is predicted to take too long.
void time_solves(const std::vector<Method>& methods, int n, std::vector<Row>& rows) {
  std::vector<std::vector<double>> seconds(methods.size());
  std::vector<double> budget(methods.size(), 2.0);
  std::optional<double> cost;
  for (int round = 0; round < 15; ++round) {
    for (std::size_t m = 0; m < methods.size(); ++m) {
      std::map<int, Solved>& solves = rows[m].solves;
      const bool predicted = n == kSamples || solves.contains(n / 10);
      if (!predicted || (n > kSamples && 10 * solves[n / 10].seconds > kLongestSolve)) continue;
      if (budget[m] <= 0.0) continue;  // two seconds of solving are enough
      Solved solved = methods[m].solve(n);
      budget[m] -= solved.converged ? solved.seconds : budget[m];
      if (!solved.converged) continue;
      check_solution(methods[m].name, solved, cost.value_or(solved.cost));
      cost = cost.value_or(solved.cost);
      seconds[m].push_back(solved.seconds);
      solved.seconds = median(seconds[m]);
      solves[n] = std::move(solved);
    }
  }
}

void run(const Options& options) {
  const FetchWork work;
  const std::vector<Method> methods = all_methods(work);
  const Eigen::VectorXd timed = work.timed_values(), initial = work.initial_values();
  for (const Eigen::VectorXd* values : {&initial, &timed}) {
    check_evaluations(exact_one(methods), methods, Values(values->data(), kParameters));
  }
  fmt::print("{} {} samples; {} methods agree\n", work.samples.size(),
             work.recorded ? "recorded" : "made", methods.size());

  Report report;
  report.peak_gflops = peak_gflops();
  report.rows = time_evaluations(methods, Values(timed.data(), kParameters), options.rounds);
  print_evaluations(report);

  std::vector<int> counts;
  for (int n = kSamples; n <= options.most_samples; n *= 10) {
    counts.push_back(n);
    time_solves(methods, n, report.rows);
  }
  print_solves(report, counts);
  print_comparisons(work, options.rounds, options.most_samples);
  if (!options.json.empty()) write_json(report, options.json);
}

}  // namespace
}  // namespace kinecal::bench

int main(int argc, char** argv) {
  const auto options = kinecal::bench::read_options(argc, argv);
  try {
    kinecal::bench::run(options);
  } catch (const std::exception& e) {
    fmt::print(stderr, "error: {}\n", e.what());
    return 1;
  }
  return 0;
}
