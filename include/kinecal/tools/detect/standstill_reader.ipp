// Second pass over a recording: the messages of each standstill or interval.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/tools/detect/raw_view.ipp"
#include "kinecal/tools/detect/recorded_survey.ipp"
#include "kinecal/tools/detect/recorded_views.hpp"

namespace kinecal::detail {

/// Second pass over a recording: delivers each standstill when all its messages were read.
class StandstillReader {
 public:
  StandstillReader(std::vector<RecordedStandstill> standstills,
                   const std::function<void(RecordedStandstill)>& handle)
      : standstills_(std::move(standstills)), handle_(handle), missing_(standstills_.size(), 0) {
    for (std::size_t s = 0; s < standstills_.size(); ++s) {
      for (const auto& camera : standstills_[s].views) {
        for (const auto& view : camera) {
          for (RawView::Part& part : view->parts) {
            wanted_[part.topic].emplace(part.index, Place{s, &part});
            ++missing_[s];
          }
        }
      }
    }
  }

  [[nodiscard]] bool wants(const BagTopic& topic) const {
    return wanted_.count(topic.name) > 0 && RecordedSurvey::wants(topic);
  }

  void take(const BagMessage& message) {
    const std::size_t index = count_[message.topic.name]++;
    const auto [first, last] = wanted_[message.topic.name].equal_range(index);
    for (auto at = first; at != last; ++at) {
      const auto& [standstill, part] = at->second;
      part->form = forms_.of(message.topic);
      part->data.assign(message.data.begin(), message.data.end());
      standstills_[standstill].bytes += part->data.size();
      if (--missing_[standstill] == 0) give(standstill);
    }
  }

  /// Delivers the rest: those without messages, and those that the recording has only in part.
  void finish() {
    for (std::size_t s = 0; s < standstills_.size(); ++s) {
      if (!given_.count(s)) give(s);
    }
  }

 private:
  struct Place {
    std::size_t standstill;
    RawView::Part* part;
  };

  void give(std::size_t s) {
    given_.insert(s);
    for (auto& camera : standstills_[s].views) {
      std::erase_if(camera, [](const auto& view) { return !view->complete(); });
    }
    handle_(std::move(standstills_[s]));
  }

  std::vector<RecordedStandstill> standstills_;
  const std::function<void(RecordedStandstill)>& handle_;
  std::vector<std::size_t> missing_;  ///< messages of each standstill
  std::set<std::size_t> given_;
  std::map<std::string, std::multimap<std::size_t, Place>> wanted_;  ///< by topic and index
  std::map<std::string, std::size_t> count_;                         ///< messages so far
  MessageForms forms_;
};

}  // namespace kinecal::detail
