// SPDX-License-Identifier: Apache-2.0
#include "process_group.hpp"

#include <charconv>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

#include "kinecal/files/diagnostics.hpp"

namespace kinecal::cli {
namespace {

std::optional<int> number_in_environment(const char* name) {
  const char* text = std::getenv(name);
  if (text == nullptr) return std::nullopt;
  const std::string value = text;
  int number = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (error == std::errc() && end == value.data() + value.size()) return number;
  throw InputError(std::string(name) + " is '" + value + "', not a number");
}

}  // namespace

ProcessGroup process_group() {
  for (const auto& [rank, size] : {std::pair("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"),
                                   {"PMI_RANK", "PMI_SIZE"},
                                   {"SLURM_PROCID", "SLURM_NTASKS"}}) {
    const std::optional<int> own = number_in_environment(rank), all = number_in_environment(size);
    if (!own || !all) continue;
    if (*own >= 0 && *own < *all) return {*own, *all};
    throw InputError(std::string(rank) + " is " + std::to_string(*own) + ", but " + size + " is " +
                     std::to_string(*all));
  }
  return {};
}

}  // namespace kinecal::cli
