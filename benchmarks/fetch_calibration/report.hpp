// The results of the benchmark: a table for people and JSON for programs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "method.hpp"
#include "peak.hpp"

namespace kinecal::bench {

/// Figures of one method; empty if not measured.
struct Row {
  std::string name;
  std::optional<double> residual_ns, residual_jacobian_ns, normal_equations_ns;  ///< per sample
  std::map<int, Solved> solves;  ///< by number of samples
  Flops flops;
};

struct Report {
  std::vector<Row> rows;  ///< the others are compared with the first
  double peak_gflops = 0.0;
  int threads = 1;
};

namespace detail {

/// "1234 ns  21.3x  45 % of the peak": a figure, the speed-up over the first row, the peak's share.
[[nodiscard]] inline std::string figure(const std::optional<double>& ns,
                                        const std::optional<double>& first, double flops,
                                        double peak) {
  if (!ns) return "-";
  std::string text = fmt::format("{:.{}f}", *ns, *ns < 1000 ? 1 : 0);
  if (first && *first != *ns) text += fmt::format(" {:5.1f}x", *first / *ns);
  if (flops > 0.0 && peak > 0.0) text += fmt::format(" {:4.1f}%", 100.0 * flops / *ns / peak);
  return text;
}

/// With six digits; null if it was not measured.
[[nodiscard]] inline nlohmann::ordered_json json_number(const std::optional<double>& value) {
  if (!value) return nullptr;
  return std::strtod(fmt::format("{:.6g}", *value).c_str(), nullptr);
}

}  // namespace detail

/// Evaluation per sample: ns, ratio to the first row, share of the peak if known.
inline void print_evaluations(const Report& report) {
  fmt::print("peak of one core {:.1f} GFLOP/s ({}, {} lanes)\n\n", report.peak_gflops,
             instruction_set(), lanes());
  fmt::print("ns a sample, times faster than {}, share of the peak\n", report.rows.front().name);
  fmt::print("{:<12} {:>22} {:>22} {:>22}\n", "", "residuals", "+ Jacobian", "+ normal equations");
  const Row& first = report.rows.front();
  const double peak = report.peak_gflops;
  for (const Row& row : report.rows) {
    fmt::print("{:<12} {:>22} {:>22} {:>22}\n", row.name,
               detail::figure(row.residual_ns, first.residual_ns, row.flops.residual, peak),
               detail::figure(row.residual_jacobian_ns, first.residual_jacobian_ns,
                              row.flops.residual_jacobian, peak),
               detail::figure(row.normal_equations_ns, first.normal_equations_ns,
                              row.flops.normal_equations, peak));
  }
}

/// Whole solves: milliseconds, ratio to the first row, iterations.
/// @param counts  numbers of samples
inline void print_solves(const Report& report, const std::vector<int>& counts) {
  fmt::print("\nwhole solve: ms, times faster than {}, iterations\n", report.rows.front().name);
  fmt::print("{:<12}", "samples");
  for (const int n : counts) fmt::print(" {:>22}", n);
  fmt::print("\n");
  const std::map<int, Solved>& first = report.rows.front().solves;
  for (const Row& row : report.rows) {
    fmt::print("{:<12}", row.name);
    for (const int n : counts) {
      const auto solved = row.solves.find(n);
      std::string text = "-";
      if (solved != row.solves.end()) {
        const auto other = first.find(n);
        text = fmt::format("{:.4g}", 1e3 * solved->second.seconds);
        if (&row != &report.rows.front() && other != first.end()) {
          text += fmt::format(" {:5.1f}x", other->second.seconds / solved->second.seconds);
        }
        text += fmt::format(" ({})", solved->second.iterations);
      }
      fmt::print(" {:>22}", text);
    }
    fmt::print("\n");
  }
  fmt::print("\n");
  for (const Row& row : report.rows) {
    if (row.solves.empty()) continue;
    const auto& [n, solved] = *row.solves.begin();
    fmt::print("{:<12} cost of {} samples {:.9e}, RMS distance {:.4f} mm\n", row.name, n,
               solved.cost, 1e3 * std::sqrt(2.0 * solved.cost / (n * kLeds)));
  }
}

/// {"rows": [{"name", "residual_ns", "residual_jacobian_ns", "normal_equations_ns",
///            "solve_ms": {"100": ..}}], "peak_gflops", "isa", "threads"}
[[nodiscard]] inline std::string to_json(const Report& report) {
  using Json = nlohmann::ordered_json;
  Json rows = Json::array();
  for (const Row& row : report.rows) {
    Json solves = Json::object();
    for (const auto& [n, solved] : row.solves) {
      solves[std::to_string(n)] = detail::json_number(1e3 * solved.seconds);
    }
    rows.push_back({{"name", row.name},
                    {"residual_ns", detail::json_number(row.residual_ns)},
                    {"residual_jacobian_ns", detail::json_number(row.residual_jacobian_ns)},
                    {"normal_equations_ns", detail::json_number(row.normal_equations_ns)},
                    {"solve_ms", solves}});
  }
  const Json all = {{"rows", rows},
                    {"peak_gflops", detail::json_number(report.peak_gflops)},
                    {"isa", instruction_set()},
                    {"threads", report.threads}};
  return all.dump() + "\n";
}

/// @throws std::runtime_error  if the file cannot be written
inline void write_json(const Report& report, const std::string& path) {
  std::ofstream out(path);
  out << to_json(report);
  out.close();
  if (!out) throw std::runtime_error(path + ": cannot be written");
}

}  // namespace kinecal::bench
