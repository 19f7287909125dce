#include "kinecal/samples/paired_features.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/problem/mounted_sensor.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Ids = std::vector<int>;

/// Features whose points are (id, sensor's number, 0), so that they can be told apart.
Observation seen(const std::string& sensor, const Ids& ids, double number = 0.0) {
  Observation observation{sensor, {}};
  for (const int id : ids) {
    observation.features.push_back({sensor, {double(id), number, 0.0}, {}, {}, id});
  }
  return observation;
}
Sample sample_of(std::vector<Observation> observations) {
  Sample sample;
  sample.observations = std::move(observations);
  return sample;
}
/// The ids of a sensor's features; -1 - id where it is a gap.
Ids ids(const std::optional<Sample>& sample, const std::string& sensor) {
  Ids all;
  for (const Feature& feature : sample.value().observation(sensor)->features) {
    all.push_back(feature.point.allFinite() ? *feature.id : -1 - *feature.id);
    if (!feature.point.allFinite()) continue;
    EXPECT_EQ(feature.point.x(), *feature.id);
  }
  return all;
}
std::string error(const Sample& sample, const std::vector<ComparedSensors>& blocks) {
  return test::thrown<SampleError>([&] { (void)pair_features(sample, blocks); });
}

const std::vector<ComparedSensors> kPair = {{{"a", "b"}}};

TEST(PairedFeatures, NothingIsCopiedWithoutIdsOrIfTheListsAreTheSame) {
  Sample plain = sample_of({seen("a", {3, 1, 2}), seen("b", {3, 1, 2})});
  EXPECT_EQ(pair_features(plain, kPair), std::nullopt);
  for (Observation& o : plain.observations) {
    for (Feature& feature : o.features) feature.id.reset();
  }
  EXPECT_FALSE(has_ids(plain));
  EXPECT_EQ(pair_features(plain, kPair), std::nullopt);
}

TEST(PairedFeatures, AreInTheOrderOfTheirIds) {
  const auto paired = pair_features(sample_of({seen("a", {7, 0, 5}), seen("b", {5, 7, 0})}), kPair);
  EXPECT_THAT(ids(paired, "a"), ElementsAre(0, 5, 7));
  EXPECT_THAT(ids(paired, "b"), ElementsAre(0, 5, 7));
}

TEST(PairedFeatures, ThoseThatNoBlockComparesAreLeftOut) {
  const auto paired =
      pair_features(sample_of({seen("a", {0, 1, 2, 3}), seen("b", {2, 3, 4, 5, 6})}), kPair);
  EXPECT_THAT(ids(paired, "a"), ElementsAre(2, 3));
  EXPECT_THAT(ids(paired, "b"), ElementsAre(2, 3));
}

TEST(PairedFeatures, AGapStandsWhereASensorDidNotSeeOne) {
  Sample sample = sample_of({seen("board", {0, 1, 2, 3}), seen("a", {3, 1}), seen("b", {0, 1})});
  sample.observations[2].features[0].rotation = exp(Vector3<double>(0.1, 0.2, 0.3));
  sample.observations[2].features[1].sigma = 0.5;
  const auto paired =
      pair_features(sample, std::vector<ComparedSensors>{{{"board", "a"}}, {{"board", "b"}}});
  EXPECT_THAT(ids(paired, "board"), ElementsAre(0, 1, 3));
  EXPECT_THAT(ids(paired, "a"), ElementsAre(-1, 1, 3));
  EXPECT_THAT(ids(paired, "b"), ElementsAre(0, 1, -4));
  const Feature& gap = paired->observation("b")->features[2];
  EXPECT_EQ(gap.frame, "b");
  EXPECT_FALSE(gap.sigma.has_value());
  EXPECT_EQ(paired->observation("b")->features[1].sigma, 0.5);
  EXPECT_FALSE(gap.rotation.has_value());  // nor has the feature beside it one
}

TEST(PairedFeatures, AGapIsInTheFrameOfTheFeatureBeforeItAndOrientedLikeIt) {
  Sample sample = sample_of({seen("a", {0, 1, 2, 3}), seen("b", {1, 3})});
  for (Feature& feature : sample.observations[1].features) {
    feature.rotation = exp(Vector3<double>(0.1, 0.2, 0.3));
  }
  sample.observations[1].features[1].frame = "other";
  const auto paired = pair_features(sample, std::vector<ComparedSensors>{{{"a", "b"}}, {{"a"}}});
  const auto& features = paired->observation("b")->features;
  ASSERT_THAT(ids(paired, "b"), ElementsAre(-1, 1, -3, 3));
  EXPECT_EQ(features[0].frame, "b");
  EXPECT_EQ(features[2].frame, "b");
  EXPECT_EQ(features[3].frame, "other");
  EXPECT_TRUE(features[2].rotation->isIdentity());
}

TEST(PairedFeatures, ABlockOfOneSensorOrOfPlanesTakesAllOfThem) {
  const Sample sample = sample_of({seen("a", {0, 1}), seen("b", {1, 2})});
  std::vector<ComparedSensors> blocks = {{{"a", "b"}}, {{"b"}}};
  EXPECT_THAT(ids(pair_features(sample, blocks), "b"), ElementsAre(1, 2));
  EXPECT_THAT(ids(pair_features(sample, blocks), "a"), ElementsAre(1, -3));
  blocks[1] = {{"a", "b"}, false};
  EXPECT_THAT(ids(pair_features(sample, blocks), "a"), ElementsAre(0, 1, -3));
  EXPECT_EQ(pair_features(sample, std::span(blocks).subspan(1)), std::nullopt);
}

TEST(PairedFeatures, BlocksConnectOnlyTheSensorsThatObserved) {
  const Sample sample = sample_of({seen("a", {0, 1}), seen("b", {1, 2}), seen("c", {})});
  const std::vector<ComparedSensors> through_c = {{{"a", "c"}}, {{"c", "b"}}, {{"b", "d"}}};
  EXPECT_EQ(pair_features(sample, through_c), std::nullopt);
}

TEST(PairedFeatures, WithNothingInCommonNoFeatureIsPaired) {
  const Sample sample = sample_of({seen("a", {0, 1}), seen("b", {2, 3})});
  const auto paired = pair_features(sample, kPair);
  EXPECT_THAT(ids(paired, "a"), ElementsAre(0, 1, -3, -4));
  EXPECT_THAT(ids(paired, "b"), ElementsAre(-1, -2, 2, 3));
  EXPECT_TRUE(ids_are_disjoint(sample, {"a", "b"}));
  EXPECT_FALSE(ids_are_disjoint(sample, {"a"}));
  EXPECT_FALSE(ids_are_disjoint(sample, {"a", "c"}));
  EXPECT_FALSE(ids_are_disjoint(sample_of({seen("a", {0, 1}), seen("b", {1, 3})}), {"a", "b"}));
}

TEST(PairedFeatures, AnIdThatOccursTwiceIsAnError) {
  EXPECT_EQ(error(sample_of({seen("a", {0, 1}), seen("b", {4, 2, 4})}), kPair),
            "sensor 'b': two features have the id 4; each feature needs an id of its own");
}

TEST(PairedFeatures, FeaturesWithAndWithoutIdsInOneObservationAreAnError) {
  Sample sample = sample_of({seen("a", {0, 1, 2}), seen("b", {0, 1, 2})});
  sample.observations[0].features[1].id.reset();
  EXPECT_EQ(error(sample, kPair),
            "sensor 'a': 1 of its 3 features has no id; give all of them one, or none");
}

/// The user numbered one sensor, and wrote the list of the other by hand in the same order.
TEST(PairedFeatures, IdsOfOneSensorAlonePairByPlace) {
  Sample sample = sample_of({seen("a", {2, 0, 1}), seen("b", {0, 1, 2})});
  for (Feature& feature : sample.observations[1].features) feature.id.reset();
  EXPECT_EQ(pair_features(sample, kPair), std::nullopt);
}

TEST(PairedFeatures, IdsThatDifferCannotBePairedWithASensorThatHasNone) {
  Sample sample = sample_of({seen("a", {0, 1}), seen("b", {1, 0}), seen("c", {0, 1})});
  for (Feature& feature : sample.observations[2].features) feature.id.reset();
  const std::vector<ComparedSensors> blocks = {{{"a", "b"}}, {{"a", "c"}}};
  EXPECT_THAT(error(sample, blocks), HasSubstr("the features of sensor 'c' have no ids, those of "
                                               "sensor 'a' have"));
}

}  // namespace
}  // namespace kinecal
