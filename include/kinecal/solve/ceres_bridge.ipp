// Adding calibration problems to a Ceres problem.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <stdexcept>

#include "kinecal/solve/ceres_bridge.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

KINECAL_INLINE void CeresBridge::add(const AnyProblem& problem, const FreeSet& free,
                                     const Eigen::VectorXd& values, Losses losses) {
  auto evaluator = problem.evaluator(free, 1);  // checks the free set
  const ParameterTable& table = problem.table();
  const std::vector<std::string>& owners = problem.owners();
  std::map<std::string, std::vector<int>> columns;
  for (int c = 0; c < free.size(); ++c) {
    const int parameter = free.parameters()[static_cast<std::size_t>(c)];
    columns[owners[static_cast<std::size_t>(parameter)]].push_back(c);
  }
  const auto index = [&](int column) {
    return free.parameters()[static_cast<std::size_t>(column)];
  };
  std::map<std::string, Block> added;
  for (const auto& [owner, of_owner] : columns) {
    Block block;
    for (const int column : of_owner) {
      block.names.push_back(table[index(column)].name);
      block.values.push_back(values(index(column)));
    }
    const auto known = blocks_.find(owner);
    if (known != blocks_.end() && known->second.names != block.names) {
      throw std::invalid_argument(
          "parameter block '" + owner +
          "' has other parameters, or in another order, than in the problem "
          "that was added before");
    }
    added.emplace(owner, std::move(block));
  }
  blocks_.merge(added);  // nothing below can fail
  detail::CompressedCost::Blocks partition;
  std::vector<double*> of_ceres;
  for (const auto& [owner, of_owner] : columns) {
    partition.push_back(of_owner);
    of_ceres.push_back(blocks_.at(owner).values.data());
  }
  problem_.AddResidualBlock(
      new detail::CompressedCost(*evaluator, values, losses, std::move(partition)), nullptr,
      of_ceres);
  evaluators_.push_back(std::move(evaluator));
  for (const auto& [owner, of_owner] : columns) {
    double* block = blocks_.at(owner).values.data();
    for (int k = 0; k < static_cast<int>(of_owner.size()); ++k) {
      const Parameter& parameter = table[index(of_owner[static_cast<std::size_t>(k)])];
      if (std::isfinite(parameter.lower))
        problem_.SetParameterLowerBound(block, k, parameter.lower);
      if (std::isfinite(parameter.upper))
        problem_.SetParameterUpperBound(block, k, parameter.upper);
    }
  }
}

KINECAL_INLINE const CeresBridge::Block& CeresBridge::find(const std::string& name) const {
  const auto found = blocks_.find(name);
  if (found != blocks_.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, block] : blocks_) names.push_back(known);
  throw std::invalid_argument("no parameter block '" + name + "'" + did_you_mean(name, names));
}

KINECAL_INLINE double* CeresBridge::block(const std::string& name) {
  (void)find(name);
  return blocks_.at(name).values.data();
}

KINECAL_INLINE const std::vector<std::string>& CeresBridge::parameters(
    const std::string& name) const {
  return find(name).names;
}

KINECAL_INLINE void CeresBridge::read(const ParameterTable& table, Eigen::VectorXd& values) const {
  for (const auto& [owner, block] : blocks_) {
    for (std::size_t k = 0; k < block.names.size(); ++k) {
      const int parameter = table.find(block.names[k]);
      if (parameter >= 0) values(parameter) = block.values[k];
    }
  }
}

}  // namespace kinecal
