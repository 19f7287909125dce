// Definitions of opencv_module.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/boards/opencv_module.hpp"

#include <dlfcn.h>

#include <string_view>

#include "kinecal/capture/plugin_file.hpp"

namespace kinecal::detail {
namespace {

struct LoadedOpencv {
  const OpencvModule* module = nullptr;
  std::string fault;  ///< why not, after "finding checkerboards needs OpenCV: "
};

LoadedOpencv load_opencv() {
  const std::string file = plugin_file("kinecal_opencv.so").string();
  if (file.empty()) {
    return {nullptr,
            "install the package kinecal-opencv (README, Install, builds it where libopencv-dev is "
            "installed)"};
  }
  void* const plugin = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const symbol = plugin != nullptr ? dlsym(plugin, "kinecal_opencv") : nullptr;
  if (symbol == nullptr) {
    const char* const why = dlerror();
    return {nullptr, file +
                         " cannot be loaded: " + (why != nullptr ? why : "no plug-in of kinecal") +
                         "; install the package kinecal-opencv again"};
  }
  const OpencvModule* const module = reinterpret_cast<decltype(&kinecal_opencv)>(symbol)();
  if (std::string_view(module->version) != KINECAL_VERSION) {
    return {nullptr, file + " is of kinecal " + module->version +
                         ", this is kinecal " KINECAL_VERSION
                         "; install the package kinecal-opencv of the same version"};
  }
  return {module, ""};
}

const LoadedOpencv& loaded_opencv() {
  static const LoadedOpencv loaded = load_opencv();
  return loaded;
}

}  // namespace

const OpencvModule* opencv_module() {
  return loaded_opencv().module;
}

std::string opencv_fault(const std::string& what) {
  const std::string& fault = loaded_opencv().fault;
  return fault.empty() ? "" : "finding " + what + " needs OpenCV: " + fault;
}

}  // namespace kinecal::detail
