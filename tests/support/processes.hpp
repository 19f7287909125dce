// Runs programs in several processes, by mpirun.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "support/paths.hpp"

namespace kinecal::test {

/// The call of so many processes, whatever the number of cores, also by root and in a container.  What MPI itself
/// leaves allocated is not our leak.  Processes that wait do so actively, so they give way to other tests.
inline std::string in_processes(int count, const std::string& call) {
  return "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_plm_rsh_agent=false "
         "OMPI_MCA_btl_vader_single_copy_mechanism=none OMPI_MCA_rmaps_base_oversubscribe=1 "
         "OMPI_MCA_btl=self,vader OMPI_MCA_mpi_yield_when_idle=1 ASAN_OPTIONS=detect_leaks=0 "
         "timeout 300 nice -n 10 " +
         mpirun() + " --bind-to none -n " + std::to_string(count) + " " + call;
}

}  // namespace kinecal::test

/// Skips the test and says why if there is no MPI; fails with KINECAL_REQUIRE_DATA=1.
#define KINECAL_REQUIRE_MPIRUN()                                                       \
  do {                                                                                 \
    if (::kinecal::test::mpirun().empty()) {                                           \
      if (std::getenv("KINECAL_REQUIRE_DATA") != nullptr) FAIL() << "there is no MPI"; \
      GTEST_SKIP() << "there is no MPI";                                               \
    }                                                                                  \
  } while (false)
