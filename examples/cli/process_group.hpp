// Processes that share one task, as reported by mpirun, srun and others.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kinecal::cli {

/// The place of this process among those started together.
struct ProcessGroup {
  int rank = 0;  ///< from 0
  int size = 1;  ///< number of processes
};

/// From the environment that Open MPI, MPICH or Slurm sets; one process without it.
/// @throws InputError  if it is contradictory
[[nodiscard]] ProcessGroup process_group();

}  // namespace kinecal::cli
