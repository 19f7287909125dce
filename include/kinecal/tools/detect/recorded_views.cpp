// Definitions of recorded_views.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/recorded_views.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "kinecal/files/recordings/read_bag.hpp"
#include "kinecal/tools/detect/intervals.ipp"
#include "kinecal/tools/detect/raw_view.ipp"
#include "kinecal/tools/detect/recorded_checks.ipp"
#include "kinecal/tools/detect/recorded_survey.ipp"
#include "kinecal/tools/detect/standstill_reader.ipp"
#include "kinecal/tools/detect/still_view.hpp"

namespace kinecal {

RecordedViews::RecordedViews(RecordingOptions options, const std::vector<CaptureFinder>& finders,
                             Diagnostics& diagnostics, const ProgressMeter& meter)
    : options_(std::move(options)), survey_(std::make_unique<detail::RecordedSurvey>()) {
  detail::MessageForms forms;
  const auto handle = [&](const BagMessage& message) { survey_->add(message, forms); };
  Diagnostics own;
  read_bag(options_.path, {detail::RecordedSurvey::wants, handle, meter}, own);
  survey_->sort_views();
  if (own.errors.empty()) {
    survey_->joints.choose(options_.joints, options_.path, own, in_motion());
    choose_cameras(finders, own);
    detail::report_messages(*survey_, cameras_, options_.path, own);
  }
  if (own.errors.empty()) detail::check_clocks(*survey_, cameras_, options_.path, own);
  if (own.errors.empty()) {
    times_ = in_motion() ? detail::find_intervals(*survey_, cameras_, options_, own)
                         : detail::find_standstills(*survey_, options_, own);
  }
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
  const auto& main = survey_->topics.at(topics.front()).views;
  const Stamp together = in_motion() ? detail::kTogetherInMotion : detail::kTogether;
  for (const detail::ViewStamp& stamp :
       in_motion() ? detail::middle_view(main, time) : detail::worth_a_look(main, time)) {
    detail::RawView view{stamp.stamp, {}};
    view.parts.reserve(2);
    view.parts.push_back({topics.front(), stamp.index});
    if (topics.size() > 1) {
      const auto* other =
          detail::companion(survey_->topics.at(topics[1]).views, stamp.stamp, together);
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

std::string RecordedViews::nothing_in(const ViewTopics& topics) const {
  const std::vector<std::string> parts = detail::parts_of(topics);
  const std::string text = "topic '" + printable(parts.front()) + "' has nothing ";
  if (!in_motion()) return text + "while the robot stands still";
  if (parts.size() < 2) return text + "in this interval";
  return text + "in this interval of which topic '" + printable(parts[1]) +
         "' has the same within " + std::to_string(detail::kTogetherInMotion.count()) + " ms";
}

RecordedView RecordedViews::view(const RecordedStandstill& standstill, std::size_t camera) const {
  const ViewTopics& topics = cameras_.at(camera);
  std::optional<CameraInfo> settings = options_.camera;
  if (!settings && !topics.camera_info.empty()) {
    settings = survey_->topics.at(topics.camera_info).camera;
  }
  std::vector<View> views;
  std::string failure = nothing_in(topics);
  for (const auto& raw : standstill.views.at(camera)) {
    try {
      views.push_back(detail::decoded(*raw, topics, settings, options_.frame));
    } catch (const std::runtime_error& error) {
      failure = error.what();
    }
  }
  if (views.empty()) return {{}, failure};
  if (in_motion()) {
    JointsInMotion joints = survey_->joints.motion(views.front().stamp);
    if (!joints.refusal.empty()) return {{}, std::move(joints.refusal)};
    views.front().joints = std::move(joints.joints);
    return {std::move(views.front()), {}, true, true};
  }
  const StillView chosen = still_view(views);
  if (!chosen.refusal.empty()) return {{}, chosen.refusal};
  View& view = views[chosen.index];
  view.joints = survey_->joints.positions(view.stamp, standstill.time);
  return {std::move(view), {}, views.size() > 1};
}

}  // namespace kinecal
