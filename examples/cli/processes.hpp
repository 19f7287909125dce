// Processes that mpirun or srun has started together to share one task.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

struct KinecalMpi;

namespace kinecal::cli {

/// The user asked to stop; says how to go on.
struct Interrupted : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// This process and those started with it; this one alone without mpirun.  They exchange data by
/// MPI, which the plug-in lib/kinecal/kinecal_mpi.so uses: nothing else needs it.
class Processes {
 public:
  /// Joins the others.
  /// @throws InputError  if they cannot be joined: no plug-in, or another MPI started them
  Processes();

  [[nodiscard]] int rank() const;  ///< of this process, from 0
  [[nodiscard]] int size() const;  ///< number of processes

  /// Runs what they share, in each of them.  An exception ends all of them: the lowest of the processes
  /// that fail at nearly the same time tells its message.
  /// @returns  the exit code of this process
  [[nodiscard]] int run(const std::function<int()>& work) const;

  /// Runs what each of them does alike before they share the work.  Only the first prints.
  void alike(const std::function<void()>& work) const;

  /// What each process gives, in the order of their ranks.  All of them call it.
  [[nodiscard]] std::vector<std::string> gather(const std::string& own) const;

  /// The same for the first process; nothing for the others.
  [[nodiscard]] std::vector<std::string> gather_in_first(const std::string& own) const;

  /// All of them call it.
  /// @param mistake  the message where they differ: {one} and {first} are processes, {text} and
  ///                 {first_text} what they give
  /// @throws InputError  in all of them, naming the first process that differs from process 0
  void require_same(const std::string& text, std::string_view mistake) const;

 private:
  [[nodiscard]] std::vector<std::string> gathered(const std::string& own, bool by_all) const;
  [[nodiscard]] int fail(const std::string& message, int code) const;

  const KinecalMpi* mpi_ = nullptr;  ///< of a process that is not alone
};

}  // namespace kinecal::cli
