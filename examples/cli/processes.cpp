// SPDX-License-Identifier: Apache-2.0
#include "processes.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <limits>
#include <string_view>

#include "commands.hpp"
#include "kinecal/capture/plugin_file.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/text/printable.hpp"
#include "mpi/kinecal_mpi.h"

namespace kinecal::cli {
namespace {

/// As how many processes mpirun or srun has started this one, by what they put into the environment.
int number_started() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"}) {
    if (const char* text = std::getenv(name)) return std::max(1, std::atoi(text));
  }
  return 1;
}

const KinecalMpi* join(int started) {
  const std::filesystem::path file = detail::plugin_file("kinecal_mpi.so");
  if (file.empty()) {
    throw InputError(
        fmt::format("this is one of {} processes, and there is no kinecal_mpi.so, by which they "
                    "share the work: "
                    "build kinecal with MPI (apt install libopenmpi-dev), or start one process",
                    started));
  }
  // Open MPI's own plug-ins look for its symbols in the whole program.
  void* const plugin = dlopen(file.c_str(), RTLD_NOW | RTLD_GLOBAL);
  void* const symbol = plugin != nullptr ? dlsym(plugin, "kinecal_mpi_join") : nullptr;
  if (symbol == nullptr) {
    const char* const why = dlerror();
    throw InputError(fmt::format(
        "this is one of {} processes, which share the work by kinecal_mpi.so; it cannot be loaded: "
        "{} (apt install libopenmpi3)",
        started, why != nullptr ? why : "not a plug-in of kinecal"));
  }
  const KinecalMpi* const mpi = reinterpret_cast<decltype(&kinecal_mpi_join)>(symbol)();
  if (std::string_view(mpi->version) != KINECAL_VERSION) {
    throw InputError(fmt::format("{}: is of kinecal {}, this is kinecal {}", file.string(),
                                 mpi->version, KINECAL_VERSION));
  }
  if (mpi->size != started) {
    throw InputError(
        fmt::format("this is one of {} processes, but they cannot talk to each other: start them "
                    "by the mpirun of "
                    "the MPI that kinecal was built with (mpirun --version), or by srun --mpi=pmix",
                    started));
  }
  return mpi;
}

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "a computer";
}

/// Sends what this process prints nowhere.
class Silence {
 public:
  Silence() {
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    for (std::size_t i = 0; i < kept_.size(); ++i) {
      std::fflush(i == 0 ? stdout : stderr);
      kept_[i] = dup(static_cast<int>(i) + 1);
      dup2(nowhere, static_cast<int>(i) + 1);
    }
    close(nowhere);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;
  ~Silence() {
    for (std::size_t i = 0; i < kept_.size(); ++i) {
      std::fflush(i == 0 ? stdout : stderr);
      dup2(kept_[i], static_cast<int>(i) + 1);
      close(kept_[i]);
    }
  }

 private:
  std::array<int, 2> kept_{};  ///< standard output and error
};

}  // namespace

Processes::Processes() {
  if (const int started = number_started(); started > 1) mpi_ = join(started);
}

int Processes::rank() const {
  return mpi_ == nullptr ? 0 : mpi_->rank;
}

int Processes::size() const {
  return mpi_ == nullptr ? 1 : mpi_->size;
}

int Processes::run(const std::function<int()>& work) const {
  int code = kDone;
  try {
    require_same(version(),
                 "{one} is {text}, but {first} is {first_text}: install the same on all of "
                 "them, and use processors of the same level");
    code = work();
    std::fflush(stdout);
  } catch (const Interrupted& stopped) {
    code = fail(stopped.what(), kInterrupted);
  } catch (const std::exception& error) {
    code = fail("error: " + with_hanging_lines(error.what()), kBadInput);
  }
  if (mpi_ != nullptr) mpi_->finish();
  return code;
}

int Processes::fail(const std::string& message, int code) const {
  constexpr int kWait = 300;  // milliseconds
  const int first = mpi_ == nullptr ? 0 : mpi_->first_to_fail(kWait);
  const bool all_failed = mpi_ == nullptr || first >= size();
  if (first % size() == rank()) {
    std::fprintf(stderr, "%s\n", printable(message).c_str());
  } else if (!all_failed) {
    usleep(kWait * 1000);  // the first of them ends all
  }
  if (!all_failed) mpi_->end_all(code);
  return code;
}

void Processes::alike(const std::function<void()>& work) const {
  if (rank() == 0) return work();
  const Silence silence;
  work();
}

std::vector<std::string> Processes::gather(const std::string& own) const {
  return gathered(own, true);
}

std::vector<std::string> Processes::gather_in_first(const std::string& own) const {
  return gathered(own, false);
}

std::vector<std::string> Processes::gathered(const std::string& own, bool by_all) const {
  if (mpi_ == nullptr) return {own};
  using Word = unsigned long long;
  const auto number = static_cast<std::size_t>(size());
  const std::vector<int> ones(number, 1);
  const Word own_bytes = own.size();
  std::vector<Word> bytes(number);
  mpi_->gather(&own_bytes, ones.data(), bytes.data(), 1);
  std::vector<int> counts;
  Word sum = 0;
  for (const Word one : bytes) {
    const Word words = (one + sizeof(Word) - 1) / sizeof(Word);
    sum += words;
    if (sum > static_cast<Word>(std::numeric_limits<int>::max())) {
      throw std::length_error("processes exchange more than 16 GiB at once");
    }
    counts.push_back(static_cast<int>(words));
  }
  std::vector<Word> padded(static_cast<std::size_t>(counts[static_cast<std::size_t>(rank())]));
  if (!own.empty()) std::memcpy(padded.data(), own.data(), own.size());
  const bool gets_all = by_all || rank() == 0;
  std::vector<Word> all(gets_all ? static_cast<std::size_t>(sum) : 0);
  mpi_->gather(padded.data(), counts.data(), all.data(), by_all ? 1 : 0);
  if (!gets_all) return {};
  std::vector<std::string> texts;
  const Word* at = all.data();
  for (std::size_t i = 0; i < number; ++i) {
    texts.emplace_back(reinterpret_cast<const char*>(at), static_cast<std::size_t>(bytes[i]));
    at += counts[i];
  }
  return texts;
}

void Processes::require_same(const std::string& text, std::string_view mistake) const {
  const std::vector<std::string> all = gather(text);
  const auto other =
      std::find_if(all.begin(), all.end(), [&](const std::string& one) { return one != all[0]; });
  if (other == all.end()) return;
  const std::vector<std::string> hosts = gather(host_name());
  const auto rank = static_cast<std::size_t>(other - all.begin());
  throw InputError(fmt::format(fmt::runtime(mistake),
                               fmt::arg("one", fmt::format("process {} on {}", rank, hosts[rank])),
                               fmt::arg("first", fmt::format("process 0 on {}", hosts[0])),
                               fmt::arg("text", *other), fmt::arg("first_text", all[0])));
}

}  // namespace kinecal::cli
