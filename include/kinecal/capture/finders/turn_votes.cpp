// Definitions of turn_votes.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/turn_votes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace kinecal::detail {

/// For 0 to 3 quarter turns.
using Votes = std::array<double, 4>;

[[nodiscard]] double turn_angle(const Matrix3<double>& rotation) {
  return std::acos(std::clamp((rotation.trace() - 1.0) / 2.0, -1.0, 1.0));
}

/// 1 if two motions rotate by the same angle, 1/2 if they differ by 5 degrees, less beyond.
[[nodiscard]] double turn_agreement(double difference) {
  constexpr double kUsual = 5.0 * std::numbers::pi / 180.0;
  return 1.0 / (1.0 + difference * difference / (kUsual * kUsual));
}

/// The votes of all pairs, and those that each sample gets from the others in their current
/// rotation.
class TurnVotes {
 public:
  TurnVotes(const std::vector<Matrix3<double>>& links, const std::vector<Matrix3<double>>& boards,
            int step)
      : size_(links.size()), step_(step), pairs_(size_ * size_), sums_(size_) {
    for (std::size_t i = 0; i < size_; ++i) {
      for (std::size_t j = 0; j < size_; ++j) {
        if (i == j) continue;
        const double by_joints = turn_angle(links[j].transpose() * links[i]);
        for (int turns = 0; turns < 4; turns += step) {
          const double by_board = turn_angle(boards[j] * (boards[i] * turned(turns)).transpose());
          pairs_[i * size_ + j][static_cast<std::size_t>(turns)] =
              turn_agreement(by_joints - by_board);
        }
      }
    }
  }

  /// Resets the counts.
  void clear() { sums_.assign(size_, Votes{}); }

  /// Adds (sign 1) or removes (sign -1) the votes of sample j in its current rotation.
  void count(std::size_t j, int turns, double sign) {
    for (std::size_t i = 0; i < size_; ++i) {
      for (int t = 0; t < 4; t += step_) {
        sums_[i][static_cast<std::size_t>(t)] +=
            sign * pairs_[i * size_ + j][static_cast<std::size_t>((t - turns + 4) % 4)];
      }
    }
  }

  /// The best rotation of a sample, and its lead in votes over the next.
  [[nodiscard]] std::pair<int, double> best(std::size_t i) const {
    int best = 0;
    for (int t = step_; t < 4; t += step_) {
      if (of(i, t) > of(i, best)) best = t;
    }
    double next = 0.0;
    for (int t = 0; t < 4; t += step_) {
      if (t != best) next = std::max(next, of(i, t));
    }
    return {best, of(i, best) - next};
  }

  /// Votes for a turn of a sample.
  [[nodiscard]] double of(std::size_t i, int turns) const {
    return sums_[i][static_cast<std::size_t>(turns)];
  }

 private:
  [[nodiscard]] static Matrix3<double> turned(int turns) {
    const double angle = turns * std::numbers::pi / 2.0;
    Matrix3<double> z = Matrix3<double>::Identity();
    z(0, 0) = z(1, 1) = std::cos(angle);
    z(1, 0) = std::sin(angle);
    z(0, 1) = -z(1, 0);
    return z;
  }

  std::size_t size_;
  int step_;
  std::vector<Votes> pairs_;  ///< of i (row) turned against j
  std::vector<Votes> sums_;
};

/// Rotations of all samples against the first, added in the order of confidence.
[[nodiscard]] std::vector<int> turns_from(TurnVotes& votes, std::size_t n, std::size_t first) {
  std::vector<int> turns(n, -1);
  votes.clear();
  turns[first] = 0;
  votes.count(first, 0, 1.0);
  for (std::size_t added = 1; added < n; ++added) {
    std::size_t surest = n;
    std::pair<int, double> choice = {0, -1.0};
    for (std::size_t i = 0; i < n; ++i) {
      if (turns[i] >= 0) continue;
      if (const auto best = votes.best(i); best.second > choice.second) {
        choice = best;
        surest = i;
      }
    }
    turns[surest] = choice.first;
    votes.count(surest, choice.first, 1.0);
  }
  return turns;
}

/// Lets each sample follow the others until none changes; returns the votes for all.
double settle_turns(TurnVotes& votes, std::vector<int>& turns) {
  constexpr int kPasses = 20;
  bool changed = true;
  for (int pass = 0; pass < kPasses && changed; ++pass) {
    changed = false;
    for (std::size_t i = 0; i < turns.size(); ++i) {
      const int best = votes.best(i).first;
      if (!(votes.of(i, best) > votes.of(i, turns[i]))) continue;
      votes.count(i, turns[i], -1.0);
      votes.count(i, best, 1.0);
      turns[i] = best;
      changed = true;
    }
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < turns.size(); ++i) sum += votes.of(i, turns[i]);
  return sum;
}

AgreedTurns agreed_turns(const std::vector<Matrix3<double>>& links,
                         const std::vector<Matrix3<double>>& boards, int step) {
  constexpr std::size_t kStarts = 5;
  constexpr double kClear = 0.1;  // votes of a sample, of those that it could have
  const std::size_t n = links.size();
  TurnVotes votes(links, boards, step);
  AgreedTurns agreed;
  double most = -1.0;
  for (std::size_t k = 0; k < std::min(n, kStarts); ++k) {
    std::vector<int> turns = turns_from(votes, n, k * n / std::min(n, kStarts));
    const double sum = settle_turns(votes, turns);
    if (sum <= most) continue;
    most = sum;
    agreed = {turns, {}};
    for (std::size_t i = 0; i < n; ++i) {
      agreed.doubtful.push_back(votes.best(i).second < kClear * static_cast<double>(n - 1));
    }
  }
  std::array<int, 4> counts = {};
  for (const int t : agreed.turns) ++counts[static_cast<std::size_t>(t)];
  const auto usual =
      static_cast<int>(std::max_element(counts.begin(), counts.end()) - counts.begin());
  for (int& t : agreed.turns) t = (t - usual + 4) % 4;
  return agreed;
}

}  // namespace kinecal::detail
