// Definitions of recorded_views.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/recorded_views.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include "kinecal/files/recordings/read_bag.hpp"
#include "kinecal/tools/detect/raw_view.ipp"
#include "kinecal/tools/detect/recorded_checks.ipp"
#include "kinecal/tools/detect/recorded_survey.ipp"
#include "kinecal/tools/detect/still_view.hpp"

namespace kinecal {
namespace detail {
namespace {

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

}  // namespace
}  // namespace detail

RecordedViews::RecordedViews(RecordingOptions options, const std::vector<CaptureFinder>& finders,
                             Diagnostics& diagnostics, const ProgressMeter& meter)
    : options_(std::move(options)), survey_(std::make_unique<detail::RecordedSurvey>()) {
  detail::MessageForms forms;
  const auto handle = [&](const BagMessage& message) { survey_->add(message, forms); };
  Diagnostics own;
  read_bag(options_.path, {detail::RecordedSurvey::wants, handle, meter}, own);
  if (own.errors.empty()) {
    survey_->joints.choose(options_.joints, options_.path, own);
    choose_cameras(finders, own);
    detail::report_messages(*survey_, cameras_, options_.path, own);
  }
  if (own.errors.empty()) detail::check_clocks(*survey_, cameras_, options_.path, own);
  if (own.errors.empty()) times_ = detail::find_standstills(*survey_, options_, own);
  for (const auto list :
       {&Diagnostics::errors, &Diagnostics::warnings, &Diagnostics::doubts, &Diagnostics::notes}) {
    auto& all = diagnostics.*list;
    all.insert(all.end(), (own.*list).begin(), (own.*list).end());
  }
}

RecordedViews::~RecordedViews() = default;
RecordedViews::RecordedViews(RecordedViews&&) noexcept = default;
RecordedViews& RecordedViews::operator=(RecordedViews&&) noexcept = default;

void RecordedViews::choose_cameras(const std::vector<CaptureFinder>& finders,
                                   Diagnostics& diagnostics) {
  std::vector<RecordedTopic> recorded;
  for (const auto& [name, topic] : survey_->topics) recorded.push_back(topic.topic);
  const auto chosen = choose_topics(
      recorded, finders, {options_.path, options_.depth, options_.camera.has_value()}, diagnostics);
  for (const ViewTopics& topics : chosen) {
    const auto known = std::find(cameras_.begin(), cameras_.end(), topics);
    camera_of_.push_back(static_cast<std::size_t>(known - cameras_.begin()));
    if (known == cameras_.end()) cameras_.push_back(topics);
  }
  if (cameras_.size() > 1 && (options_.camera || !options_.frame.empty())) {
    diagnostics.error(
        {options_.path, 0},
        "--camera and --frame are for a single camera, but the finders look through " +
            std::to_string(cameras_.size()));
  }
}

std::vector<std::shared_ptr<detail::RawView>> RecordedViews::planned(const Standstill& time,
                                                                     std::size_t camera) const {
  const std::vector<std::string> topics = detail::parts_of(cameras_[camera]);
  std::vector<std::shared_ptr<detail::RawView>> views;
  const auto& main = survey_->topics.at(topics.front());
  for (const detail::ViewStamp& stamp : detail::worth_a_look(main.views, time)) {
    detail::RawView view{stamp.stamp, {}};
    view.parts.reserve(2);
    view.parts.push_back({topics.front(), stamp.index});
    if (topics.size() > 1) {
      const auto* other = detail::companion(survey_->topics.at(topics[1]).views, stamp.stamp);
      if (other == nullptr) continue;
      view.parts.push_back({topics[1], other->index});
    }
    views.push_back(std::make_shared<detail::RawView>(std::move(view)));
  }
  return views;
}

void RecordedViews::read(const std::function<void(RecordedStandstill)>& handle,
                         const ProgressMeter& meter) const {
  std::vector<RecordedStandstill> standstills;
  const Stamp start = survey_->joints.span().value_or(Standstill{}).begin;
  for (const Standstill& time : times_) {
    RecordedStandstill standstill;
    standstill.number = standstills.size();
    standstill.time = time;
    standstill.source = options_.path + " at " +
                        detail::stamp_text(time.begin + (time.end - time.begin) / 2 - start);
    for (std::size_t c = 0; c < cameras_.size(); ++c) standstill.views.push_back(planned(time, c));
    standstills.push_back(std::move(standstill));
  }
  detail::StandstillReader reader(std::move(standstills), handle);
  Diagnostics repeated;  // the first pass has reported them
  read_bag(options_.path,
           {[&](const BagTopic& topic) { return reader.wants(topic); },
            [&](const BagMessage& message) { reader.take(message); }, meter},
           repeated);
  reader.finish();
}

RecordedView RecordedViews::view(const RecordedStandstill& standstill, std::size_t camera) const {
  const ViewTopics& topics = cameras_.at(camera);
  std::optional<CameraInfo> settings = options_.camera;
  if (!settings && !topics.camera_info.empty()) {
    settings = survey_->topics.at(topics.camera_info).camera;
  }
  std::vector<View> views;
  std::string failure = "topic '" + printable(detail::parts_of(topics).front()) +
                        "' has nothing while the robot stands still";
  for (const auto& raw : standstill.views.at(camera)) {
    try {
      views.push_back(detail::decoded(*raw, topics, settings, options_.frame));
    } catch (const std::runtime_error& error) {
      failure = error.what();
    }
  }
  if (views.empty()) return {{}, failure};
  const StillView chosen = still_view(views);
  if (!chosen.refusal.empty()) return {{}, chosen.refusal};
  View& view = views[chosen.index];
  view.joints = survey_->joints.positions(view.stamp, standstill.time);
  return {std::move(view), {}, views.size() > 1};
}

}  // namespace kinecal
