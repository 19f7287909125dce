// What finders make of rendered images: they find targets where the geometry has them.
#include <gtest/gtest.h>

#include <numbers>

#include "kinecal/capture/finders/april_tag_finder.hpp"
#include "kinecal/capture/finders/checkerboard_finder.hpp"
#include "kinecal/study/render.hpp"
#include "kinecal/study/tag_grid.hpp"

namespace kinecal {
namespace {

constexpr double kMeanError = 0.15, kLargestError = 0.6;  // pixels, with noise and blur

/// Poses of a target's middle in the camera, from its front: camera_T_middle.
std::vector<Pose<double>> poses() {
  SeededRandom random(3);
  std::vector<Pose<double>> all;
  for (int i = 0; i < 8; ++i) {
    const Vector3<double> turn(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5),
                               random.uniform(-0.6, 0.6));
    all.push_back({exp(turn), {random.uniform(-0.08, 0.08), random.uniform(-0.05, 0.05), 0.5}});
  }
  return all;
}

/// Compares the pixels that a finder found with projected corners.
void expect_found(const Found& found, const Lens& lens, const Pose<double>& camera_T_target) {
  ASSERT_TRUE(found) << found.refusal;
  double sum = 0.0;
  const std::vector<Feature>& seen = found.observations[0].features;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Vector3<double>& point = found.observations[1].features[i].point;
    const double error = (lens.project(camera_T_target * point) - seen[i].point.head<2>()).norm();
    EXPECT_LT(error, kLargestError);
    sum += error;
  }
  EXPECT_LT(sum / static_cast<double>(seen.size()), kMeanError);
}

View view_of(const SimulatedCamera& camera, const Renderer& renderer, const Scene& scene,
             SeededRandom& random) {
  const auto in_camera = [](const std::string&) { return Pose<double>(); };
  return photograph(camera, renderer.lens(), renderer.render(scene, in_camera, 0), random);
}

#ifdef KINECAL_HAVE_OPENCV
TEST(RenderedTargets, CheckerboardsAreFoundWhereTheyAre) {
  SimulatedCamera camera;
  camera.has_depth = false;
  const Renderer renderer(camera);
  const CheckerboardFinder finder({.points_x = 6, .points_y = 5, .size = 0.025});
  SeededRandom random(1);
  for (const Pose<double>& middle : poses()) {
    const Pose<double> board =
        middle * Pose<double>{Matrix3<double>::Identity(), {-0.0625, -0.05, 0.0}};
    Scene scene;
    scene.light.position = {0.5, -1.0, -0.5};
    add_checkerboard(scene, "", board, 6, 5, 0.025);
    expect_found(finder.find(view_of(camera, renderer, scene, random)), renderer.lens(), board);
  }
}
#endif

#ifdef KINECAL_HAVE_APRILTAG
TEST(RenderedTargets, TagsAreFoundWhereTheyAre) {
  SimulatedCamera camera;
  camera.has_depth = false;
  const Renderer renderer(camera);
  const AprilTagFinder finder({.columns = 3, .rows = 2, .size = 0.06, .spacing = 0.25});
  const auto picture = std::make_shared<const GrayImage>(tag_grid_picture(3, 2));
  const double bit = 0.06 / kPlainTags.tag();
  SeededRandom random(2);
  for (const Pose<double>& middle : poses()) {
    const Pose<double> corner =
        middle * Pose<double>{Matrix3<double>::Identity(), {-16 * bit, -11 * bit, 0.0}};
    // Of the grid: at the outer corner of the first tag, y up.
    const Pose<double> grid =
        corner * Pose<double>{Vector3<double>(1, -1, -1).asDiagonal(), {2 * bit, 20 * bit, 0.0}};
    Scene scene;
    scene.light.position = {0.5, -1.0, -0.5};
    add_picture(scene, "", corner, picture, 32 * bit);
    expect_found(finder.find(view_of(camera, renderer, scene, random)), renderer.lens(), grid);
  }
}

TEST(RenderedTargets, TagsOfKalibrsGridAreFoundWhereTheyAre) {
  SimulatedCamera camera;
  camera.has_depth = false;
  const Renderer renderer(camera);
  const AprilTagFinder finder({.columns = 3, .rows = 2, .size = 0.06, .spacing = 0.3, .border = 2});
  const auto picture = std::make_shared<const GrayImage>(tag_grid_picture(3, 2, kKalibrTags));
  const double bit = 0.06 / kKalibrTags.tag(), width = picture->width, height = picture->height;
  SeededRandom random(3);
  for (const Pose<double>& middle : poses()) {
    const Pose<double> corner =
        middle *
        Pose<double>{Matrix3<double>::Identity(), {-0.5 * width * bit, -0.5 * height * bit, 0.0}};
    const double margin = kKalibrTags.margin * bit;
    const Pose<double> grid = corner * Pose<double>{Vector3<double>(1, -1, -1).asDiagonal(),
                                                    {margin, height * bit - margin, 0.0}};
    Scene scene;
    scene.light.position = {0.5, -1.0, -0.5};
    add_picture(scene, "", corner, picture, width * bit);
    expect_found(finder.find(view_of(camera, renderer, scene, random)), renderer.lens(), grid);
  }
}
#endif

}  // namespace
}  // namespace kinecal
