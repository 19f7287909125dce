// kinecal_mpi.so: kinecal_mpi.h by an implementation of MPI.
// Source: MPI: A Message-Passing Interface Standard, version 3.1.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal_mpi.h"

#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <thread>
#include <vector>

namespace {

KinecalMpi processes;
MPI_Comm failures = MPI_COMM_NULL;  // for these alone: the others may wait in gather()

void gather(const unsigned long long* own, const int* counts, unsigned long long* all, int by_all) {
  std::vector<int> offsets(static_cast<std::size_t>(processes.size), 0);
  std::partial_sum(counts, counts + processes.size - 1, offsets.begin() + 1);
  const MPI_Datatype word = MPI_UNSIGNED_LONG_LONG;
  const int count = counts[processes.rank];
  if (by_all != 0) {
    MPI_Allgatherv(own, count, word, all, counts, offsets.data(), word, MPI_COMM_WORLD);
  } else {
    MPI_Gatherv(own, count, word, all, counts, offsets.data(), word, 0, MPI_COMM_WORLD);
  }
}

// One that fails tells all others, and listens.  A message of four bytes is on its way when MPI_Isend returns,
// whether or not the other ever takes it.
int first_to_fail(int milliseconds) {
  std::vector<MPI_Request> sent(static_cast<std::size_t>(processes.size), MPI_REQUEST_NULL);
  for (int other = 0; other < processes.size; ++other) {
    if (other == processes.rank) continue;
    MPI_Isend(&processes.rank, 1, MPI_INT, other, 0, failures,
              &sent[static_cast<std::size_t>(other)]);
  }
  using Clock = std::chrono::steady_clock;
  const Clock::time_point end = Clock::now() + std::chrono::milliseconds(milliseconds);
  int failed = 1, first = processes.rank;
  while (failed < processes.size && Clock::now() < end) {
    int is_there = 0;
    MPI_Iprobe(MPI_ANY_SOURCE, 0, failures, &is_there, MPI_STATUS_IGNORE);
    if (is_there == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      continue;
    }
    int other = 0;
    MPI_Recv(&other, 1, MPI_INT, MPI_ANY_SOURCE, 0, failures, MPI_STATUS_IGNORE);
    ++failed;
    first = std::min(first, other);
  }
  if (failed < processes.size) return first;
  MPI_Waitall(processes.size, sent.data(), MPI_STATUSES_IGNORE);
  return processes.size + first;
}

void end_all(int code) {
  MPI_Abort(MPI_COMM_WORLD, code);
}

void finish() {
  MPI_Finalize();
}

}  // namespace

const KinecalMpi* kinecal_mpi_join() {
  MPI_Init(nullptr, nullptr);
  MPI_Comm_dup(MPI_COMM_WORLD, &failures);
  processes.version = KINECAL_VERSION;
  MPI_Comm_rank(MPI_COMM_WORLD, &processes.rank);
  MPI_Comm_size(MPI_COMM_WORLD, &processes.size);
  processes.gather = gather;
  processes.first_to_fail = first_to_fail;
  processes.end_all = end_all;
  processes.finish = finish;
  return &processes;
}
