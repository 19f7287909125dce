#include "comparisons.hpp"

#include <fmt/core.h>
#include <malloc.h>

#include "own_problem.hpp"
#include "peak.hpp"
#include "timing.hpp"

namespace kinecal::bench {
namespace {

/// PointToPoint as a user would write it.
struct WrittenByAUser {
  static constexpr const char* kUnit = "m";
  template <class S>
  Vector3<S> operator()(const Vector3<S>& p_a, const Vector3<S>& p_b) const {
    return p_a - p_b;
  }
};

/// The distance as an angle at the base, so that jets compute the derivatives.
struct OfTheView {
  static constexpr const char* kUnit = "m";
  template <class S>
  Vector3<S> operator()(const Vector3<S>& p_a, const Vector3<S>& p_b) const {
    using std::sqrt;
    const S range = sqrt(p_a.x() * p_a.x() + p_a.y() * p_a.y() + p_a.z() * p_a.z());
    const S nearness = S(1.0) / range;
    return {(p_a.x() - p_b.x()) * nearness, (p_a.y() - p_b.y()) * nearness,
            (p_a.z() - p_b.z()) * nearness};
  }
};

/// The samples with each feature twelve times: the number of corners of a checkerboard.
std::vector<Sample> with_corners(std::vector<Sample> samples) {
  for (Sample& sample : samples) {
    for (Observation& observation : sample.observations) {
      const std::vector<Feature> few = observation.features;
      for (int n = 1; n < 12; ++n) {
        observation.features.insert(observation.features.end(), few.begin(), few.end());
      }
    }
  }
  return samples;
}

/// A problem that is evaluated repeatedly.
struct Work {
  std::string name;
  BasicProblem<Packet> problem;
  Evaluator<Packet> evaluator;

  Work(std::string title, BasicProblem<Packet> made, const FreeSet& free, int threads = 1)
      : name(std::move(title)), problem(std::move(made)), evaluator(problem, free, threads) {}
};

/// Prints the time of each as a multiple of the first.
void print_ratios(const std::vector<std::unique_ptr<Work>>& works, std::span<const double> x,
                  int rounds) {
  std::vector<Timed> timed;
  for (const auto& work : works) {
    timed.push_back({[&work, x] {
      NormalEquations sum = work->evaluator.normal_equations(x);
      detail::hide(sum);
    }});
  }
  time_interleaved(timed, rounds);
  const auto of_sample = [&](std::size_t i) {
    return timed[i].seconds / works[i]->problem.num_samples();
  };
  for (std::size_t i = 0; i < works.size(); ++i) {
    fmt::print("  {:<44}{:8.1f} ns a sample {:6.2f}x\n", works[i]->name, 1e9 * of_sample(i),
               of_sample(i) / of_sample(0));
  }
}

TermOptions robust(LossType type) {
  TermOptions options;
  options.loss = {type, 0.005};
  return options;
}

}  // namespace

void print_comparisons(const FetchWork& work, int rounds, int most_samples) {
  const FreeSet free = all_free(work.table);
  const Eigen::VectorXd values = work.timed_values();
  const std::span<const double> x(values.data(), static_cast<std::size_t>(values.size()));
  std::vector<std::unique_ptr<Work>> works;
  const auto add = [&](const std::string& name, BasicProblem<Packet> problem, int threads = 1) {
    works.push_back(std::make_unique<Work>(name, std::move(problem), free, threads));
  };
  const std::vector<Sample>& samples = work.samples;
  fmt::print("\nnormal equations of {} samples, packets\n", samples.size());
  add("point to point, 4 features", own_problem<Packet>(work, samples));
  add("the same written by a user", own_problem<Packet, WrittenByAUser>(work, samples));
  add("a user's that is not linear", own_problem<Packet, OfTheView>(work, samples));
  for (const auto& [name, type] : {std::pair{"huber", LossType::huber},
                                   {"cauchy", LossType::cauchy},
                                   {"tukey", LossType::tukey}}) {
    add(fmt::format("with the loss {}", name), own_problem<Packet>(work, samples, robust(type)));
  }
  add("48 features", own_problem<Packet>(work, with_corners(samples)));
  print_ratios(works, x, rounds);

  works.clear();
  const std::vector<Sample> many = work.cycled(most_samples);
  const auto before = mallinfo2();
  BasicProblem<Packet> problem = own_problem<Packet>(work, many);
  const auto after = mallinfo2();
  const double bytes =
      double(after.uordblks + after.hblkhd) - double(before.uordblks + before.hblkhd);
  fmt::print("\n{} samples, {:.0f} bytes each in memory; {} cores\n", most_samples,
             bytes / most_samples, kinecal::detail::number_of_threads(0));
  const std::size_t few = std::min<std::size_t>(1000, many.size());
  add(fmt::format("{} of them, one thread", few),
      own_problem<Packet>(work, std::span(many).first(few)), 1);
  add("all, one thread", own_problem<Packet>(work, many), 1);
  add("all, two threads", std::move(problem), 2);
  print_ratios(works, x, rounds);
  const double one = peak_gflops_of_threads(1), two = peak_gflops_of_threads(2);
  fmt::print("  the peak of two threads is {:.2f} times that of one\n", two / one);
}

}  // namespace kinecal::bench
