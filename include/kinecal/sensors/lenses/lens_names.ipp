// Definitions of lens_names.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "kinecal/sensors/lenses/lens_names.hpp"
#include "kinecal/sensors/lenses/lenses.hpp"
#include "kinecal/sensors/sensor.hpp"

namespace kinecal {

namespace detail {

/// What names tell of a lens.
struct NamedLens {
  std::string_view name;         ///< of the lens
  std::size_t coefficients = 0;  ///< number of them
  bool bends_pinhole = false;    ///< contains all such lenses with fewer coefficients
  std::span<const std::string_view> also = {};  ///< other names in files
};
template <LensModel... Ls>
[[nodiscard]] constexpr auto named(LensList<Ls...>) {
  const auto of = []<class L>(std::type_identity<L>) {
    NamedLens lens{L::kName, L::kCoefficients.size()};
    if constexpr (requires { L::kBendsPinhole; }) lens.bends_pinhole = L::kBendsPinhole;
    if constexpr (requires { L::kAlso; }) lens.also = L::kAlso;
    return lens;
  };
  return std::array{of(std::type_identity<Ls>())...};
}
inline constexpr std::array kLenses = named(Lenses());

[[nodiscard]] inline const NamedLens* find_lens(std::string_view name) {
  for (const NamedLens& lens : kLenses) {
    if (lens.name == name) return &lens;
    if (std::find(lens.also.begin(), lens.also.end(), name) != lens.also.end()) return &lens;
  }
  return nullptr;
}

/// Number of coefficients up to the last one that is not zero.
[[nodiscard]] inline std::size_t used_coefficients(std::span<const double> d) {
  std::size_t used = d.size();
  while (used > 0 && d[used - 1] == 0.0) --used;
  return used;
}

}  // namespace detail

KINECAL_INLINE std::string_view lens_named(std::string_view name) {
  const detail::NamedLens* lens = detail::find_lens(name);
  return lens == nullptr ? std::string_view{} : lens->name;
}

KINECAL_INLINE bool bends_pinhole(std::string_view lens) {
  const detail::NamedLens* named = detail::find_lens(lens);
  return named != nullptr && named->bends_pinhole;
}

KINECAL_INLINE bool contains_lens(std::string_view lens, std::string_view other) {
  if (lens == other) return true;
  const detail::NamedLens *own = detail::find_lens(lens), *theirs = detail::find_lens(other);
  if (own == nullptr || theirs == nullptr) return false;
  return own == theirs ||
         (own->bends_pinhole && theirs->bends_pinhole && theirs->coefficients <= own->coefficients);
}

KINECAL_INLINE std::string_view distortion_model_of(std::string_view lens) {
  return lens == ThinPrism::kName ? RationalPolynomial::kName : lens;
}

KINECAL_INLINE std::span<const std::string_view> lens_names() {
  static const auto names = [] {
    std::array<std::string_view, detail::kLenses.size()> all;
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = detail::kLenses[i].name;
    return all;
  }();
  return names;
}

KINECAL_INLINE std::string lens_of(const CameraInfo& info) {
  if (info.distortion_model.empty()) return "plumb_bob";
  const std::size_t used = detail::used_coefficients(info.d);
  const std::string_view lens = lens_named(info.distortion_model);
  if (lens.empty() && used == 0) return "plumb_bob";
  if (lens.empty()) {
    std::string known;
    for (const std::string_view name : lens_names()) {
      known += (known.empty() ? "" : ", ") + std::string(name);
    }
    throw SettingsError("distortion model '" + info.distortion_model +
                        "' is not supported in raw images; rectify them and write 'image: "
                        "rectified' in the model, or use one of " +
                        known);
  }
  return lens == "rational_polynomial" && used > 8 ? "thin_prism" : std::string(lens);
}

KINECAL_INLINE std::vector<double> coefficients_of(const CameraInfo& info, std::string_view lens,
                                                   std::size_t count) {
  const detail::NamedLens* known = detail::find_lens(lens);
  const bool is_known = known != nullptr && known->name == lens && known->coefficients == count;
  const detail::NamedLens own = is_known ? *known : detail::NamedLens{lens, count};
  const bool is_own = !is_known && info.distortion_model == lens;
  const detail::NamedLens theirs = is_own ? own : *detail::find_lens(lens_of(info));
  const std::size_t used = detail::used_coefficients(info.d), size = info.d.size();
  const auto text = [](std::size_t n) {
    return std::to_string(n) + " distortion coefficient" + (n == 1 ? "" : "s");
  };
  if (used > 12 && theirs.name == "thin_prism") {
    throw SettingsError(
        "its distortion coefficients 13 and 14 tilt the image plane, which no lens here does; "
        "rectify the images and write 'image: rectified' in the model");
  }
  const bool is_short = used > 0 && size < theirs.coefficients &&
                        !(theirs.name == "plumb_bob" && size == 4);  // OpenCV: k3 = 0
  if (used > theirs.coefficients || is_short) {
    throw SettingsError(std::string(theirs.name) + " has " + text(theirs.coefficients) + ", not " +
                        std::to_string(size));
  }
  const bool contains = own.bends_pinhole && theirs.bends_pinhole && used <= own.coefficients;
  const bool is_any = info.distortion_model.empty() && used == 0;
  if (own.name != theirs.name && !contains && !is_any) {
    throw SettingsError("its lens is " + std::string(lens) + ", but camera_info has " +
                        (used > 0 ? "the " + text(used) + " of " : "the lens ") +
                        std::string(theirs.name));
  }
  std::vector<double> d(own.coefficients, 0.0);
  std::copy_n(info.d.begin(), std::min(used, d.size()), d.begin());
  for (const double coefficient : d) {
    if (!std::isfinite(coefficient)) {
      throw SettingsError("a distortion coefficient of camera_info is not a number");
    }
  }
  return d;
}

KINECAL_INLINE void set_coefficients(CameraInfo& info, std::string_view lens,
                                     std::span<const ParameterInfo> coefficients,
                                     std::span<const double> changes, bool raw) {
  const auto changed =
      std::find_if(changes.begin(), changes.end(), [](double change) { return change != 0.0; });
  if (changed == changes.end()) return;
  if (!raw) {
    const auto which = static_cast<std::size_t>(changed - changes.begin());
    throw std::invalid_argument("its image is rectified, which has no distortion: '" +
                                std::string(coefficients[which].name) +
                                "' must be held, or the image is raw ('image: raw')");
  }
  std::vector<double> d = coefficients_of(info, lens, coefficients.size());
  for (std::size_t i = 0; i < d.size(); ++i) d[i] += changes[i];
  // the model that its driver writes and as many coefficients, if they hold the lens
  const std::string_view model = distortion_model_of(lens);
  const detail::NamedLens* recorded = detail::find_lens(info.distortion_model);
  const std::size_t used = detail::used_coefficients(d), size = info.d.size();
  const bool may_stay = recorded != nullptr && recorded->bends_pinhole && bends_pinhole(lens);
  if (may_stay && used <= recorded->coefficients) {
    d.resize(used <= size ? size : recorded->coefficients, 0.0);
  } else {
    if (recorded == nullptr || recorded->name != model) info.distortion_model = std::string(model);
    d.resize(std::max(d.size(), size), 0.0);
  }
  info.d = std::move(d);
}

}  // namespace kinecal
