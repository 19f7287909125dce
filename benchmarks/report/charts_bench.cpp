// The cost of drawing all charts of a report, and their size.
// Control: formatting each feature once, as a table would.
//
//   charts_bench [REPETITIONS]     10 by default; the least time is printed
//
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>

#include "kinecal/report/charts/charts.hpp"
#include "support/report_data.hpp"

namespace kinecal {
namespace {

/// Milliseconds of the fastest of some runs.
double fastest(int repetitions, const std::function<void()>& run) {
  double least = 1e300;
  for (int i = 0; i < repetitions; ++i) {
    const auto start = std::chrono::steady_clock::now();
    run();
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    least = std::min(least, took.count());
  }
  return least;
}

std::size_t bytes_of(const std::vector<Chart>& all) {
  std::size_t bytes = 0;
  for (const Chart& chart : all) bytes += chart.svg.size();
  return bytes;
}

/// Length of a table of all features.
std::size_t table_size(const ReportData& data) {
  std::size_t bytes = 0;
  char line[100];
  for (const ReportedBlock& block : data.blocks) {
    for (const ReportedFeature& feature : block.features) {
      bytes += static_cast<std::size_t>(std::snprintf(
          line, sizeof line, "%d %g %g\n", feature.sample, feature.before, feature.after));
    }
  }
  return bytes;
}

int run(int repetitions) {
  std::printf("samples  features  charts      ms      kB  table, ms\n");
  for (const int samples : {100, 1000, 10000}) {
    const ReportData data = test::report_data(samples);
    const std::vector<Chart> all = charts(data);
    if (all.size() < 20 || bytes_of(all) != bytes_of(charts(data))) {
      std::fprintf(stderr, "error: charts are missing or differ\n");
      return 1;
    }
    std::size_t sink = 0;
    const double drawing = fastest(repetitions, [&] { sink += bytes_of(charts(data)); });
    const double table = fastest(repetitions, [&] { sink += table_size(data); });
    if (sink == 0) return 1;
    std::printf("%7d  %8zu  %6zu  %6.1f  %6.0f  %9.1f\n", samples,
                data.blocks.size() * data.blocks[0].features.size(), all.size(), drawing,
                1e-3 * static_cast<double>(bytes_of(all)), table);
  }
  return 0;
}

}  // namespace
}  // namespace kinecal

int main(int argc, char** argv) {
  return kinecal::run(argc > 1 ? std::max(1, std::atoi(argv[1])) : 10);
}
