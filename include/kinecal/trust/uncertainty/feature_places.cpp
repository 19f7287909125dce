// Places features.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/uncertainty/feature_places.hpp"

#include <algorithm>
#include <map>
#include <string>

#include "kinecal/text/frame_name.hpp"

namespace kinecal {

bool is_seen(const Feature& feature) {
  return feature.point.allFinite() && (!feature.rotation || feature.rotation->allFinite());
}

const Feature* observed_feature(const Observation& seen, const FeatureLabel& label) {
  if (!label.id) {
    const auto place = static_cast<std::size_t>(label.place);
    return place < seen.features.size() ? &seen.features[place] : nullptr;
  }
  const auto at = std::find_if(seen.features.begin(), seen.features.end(),
                               [&](const Feature& feature) { return feature.id == label.id; });
  return at == seen.features.end() ? nullptr : &*at;
}

FeaturePlaces::FeaturePlaces(const AnyProblem& problem, ParameterValues values)
    : problem_(problem), values_(values) {
  for (const MountedSensor& sensor : problem.sensors()) {
    auto& corrections = corrections_.emplace_back();
    for (const SampledChain& chain : sensor.chains()) {
      corrections.push_back(corrections_for(chain.parameters(), values));
    }
  }
}

Pose<double> FeaturePlaces::base_T_frame(int sensor, const std::string& frame,
                                         const Sample& sample) const {
  const auto s = static_cast<std::size_t>(sensor);
  const std::vector<SampledChain>& chains = problem_.sensors()[s].chains();
  std::size_t chain = 0;
  for (std::size_t c = 1; c < chains.size(); ++c) {
    if (same_frame(chains[c].chain().tip, frame)) chain = c;
  }
  return chains[chain].tip(sample, corrections_[s][chain]);
}

std::vector<PlacedFeature> FeaturePlaces::placed(int sensor, const Observation& seen,
                                                 const Sample& sample) const {
  const MountedSensor& of = problem_.sensors()[static_cast<std::size_t>(sensor)];
  const bool rays = of.sensor().places() == Quantity::ray;
  const std::vector<double> settings = of.sensor().settings(seen), own = of.own_values(values_);
  std::map<std::string, Pose<double>> frames;
  std::vector<PlacedFeature> all;
  all.reserve(seen.features.size());
  auto frame = frames.end();
  for (const Feature& feature : seen.features) {
    if (frame == frames.end() || frame->first != feature.frame) frame = frames.find(feature.frame);
    if (frame == frames.end()) {
      frame = frames.emplace(feature.frame, base_T_frame(sensor, feature.frame, sample)).first;
    }
    const Pose<double>& base_T_sensor = frame->second;
    const bool counts = is_seen(feature);
    Vector3<double> p = feature.point;
    if (counts) p = of.sensor().place(of.sensor().measurement(p, settings), settings, own);
    all.push_back({rays ? Vector3<double>(base_T_sensor.rotation * p) : base_T_sensor * p,
                   base_T_sensor.translation, base_T_sensor.rotation.col(2), counts});
  }
  return all;
}

std::vector<Eigen::Vector2d> FeaturePlaces::pixels(int camera, const Observation& seen,
                                                   const Sample& sample,
                                                   std::span<const PlacedFeature> points) const {
  const MountedSensor& of = problem_.sensors()[static_cast<std::size_t>(camera)];
  const std::vector<double> settings = of.sensor().settings(seen), own = of.own_values(values_);
  const Pose<double> camera_T_base = base_T_frame(camera, of.mount().frame, sample).inverse();
  std::vector<Eigen::Vector2d> all;
  for (const PlacedFeature& point : points) {
    all.push_back(of.sensor().predict(camera_T_base * point.point, settings, own));
  }
  return all;
}

}  // namespace kinecal
