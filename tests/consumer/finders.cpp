// A program that finds targets, with whatever optional libraries kinecal was built with.
#include <iostream>

#include "kinecal/capture.hpp"

int main() {
  kinecal::View view;
  view.image = kinecal::GrayImage(64, 48, 128);
  view.camera = kinecal::CameraInfo{};
  view.camera->width = 64;
  view.camera->height = 48;
  kinecal::AprilTagSettings tags;
  tags.columns = tags.rows = 2;
  tags.size = 0.05;
  for (const std::string& refusal : {kinecal::CheckerboardFinder({}).find(view).refusal,
                                     kinecal::CharucoFinder({}).find(view).refusal,
                                     kinecal::AprilTagFinder(tags).find(view).refusal}) {
    if (refusal.empty()) return 1;
    std::cout << refusal << '\n';
  }
  return 0;
}
