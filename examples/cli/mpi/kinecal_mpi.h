/* What the program takes from MPI, so that only a plug-in of its own, kinecal_mpi.so, needs MPI.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef KINECAL_MPI_H
#define KINECAL_MPI_H

#ifdef __cplusplus
extern "C" {
#endif

/** Processes that mpirun or srun has started together.  Each function but end_all() and
 * first_to_fail() is collective: all processes call it. */
struct KinecalMpi {
  const char* version; /**< of kinecal that the plug-in belongs to */
  int rank;            /**< of this process, from 0 */
  int size;            /**< number of processes */
  /** Gives the words of all processes, in the order of their ranks, to each, or to the first.
   * @param own     of this process
   * @param counts  number of words of each process; the sum fits an int
   * @param all     out: so many words as all counts together, where they are given
   * @param by_all  whether each process gets them, else only that of rank 0 */
  void (*gather)(const unsigned long long* own, const int* counts, unsigned long long* all,
                 int by_all);
  /** Finds out which of the processes that fail at nearly the same time tells its error.
   * @param milliseconds  how long to wait for the others
   * @returns  the lowest rank of those that have failed; size + that rank if all have */
  int (*first_to_fail)(int milliseconds);
  /** Ends all processes. */
  void (*end_all)(int code);
  /** Ends the use of MPI in a process that has done its work. */
  void (*finish)(void);
};

/** Joins the processes.  Called once. */
const struct KinecalMpi* kinecal_mpi_join(void);

#ifdef __cplusplus
}
#endif

#endif
