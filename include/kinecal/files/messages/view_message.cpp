// Definitions of view_message.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/messages/view_message.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "kinecal/files/bags/bytes.hpp"
#include "kinecal/files/images/read_image.hpp"
#include "kinecal/files/messages/message_fields.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal::detail {

// Rows of pixels or points in a message.

/// Rows of pixels or points in a message.
struct MessageRows {
  int width = 0, height = 0;
  std::size_t step = 0;  ///< bytes of a row
  Bytes data;
  std::endian order = std::endian::little;

  /// The bytes of a row from some byte on.
  [[nodiscard]] ByteReader at(int row, std::size_t byte) const {
    return ByteReader(data.subspan(static_cast<std::size_t>(row) * step + byte), order);
  }
};

/// @param item  bytes of a pixel or point
/// @throws BytesError  if the size of the data does not match its rows
[[nodiscard]] inline MessageRows rows_of(const MessageFields& message, const char* step,
                                         std::size_t item) {
  constexpr double kMost = 1 << 16, kMostInList = 1 << 24;  // a list of points has one row
  const double width = number_at(message, "width"), height = number_at(message, "height");
  const MessageValue* data = field_at(message, "data");
  const auto* bytes = data == nullptr ? nullptr : data->as<Bytes>();
  MessageRows rows;
  const bool fits =
      width >= 1 && width <= (height == 1 ? kMostInList : kMost) && height >= 1 && height <= kMost;
  if (fits && bytes != nullptr) {
    rows.width = static_cast<int>(width);
    rows.height = static_cast<int>(height);
    rows.step = static_cast<std::size_t>(number_at(message, step));
    rows.data = *bytes;
    rows.order = number_at(message, "is_bigendian") != 0.0 ? std::endian::big : std::endian::little;
    const std::size_t needed = rows.step * static_cast<std::size_t>(rows.height);
    if (rows.step >= item * static_cast<std::size_t>(rows.width) && bytes->size() >= needed) {
      return rows;
    }
  }
  throw BytesError("an image or cloud of " + std::to_string(static_cast<std::int64_t>(width)) +
                   "x" + std::to_string(static_cast<std::int64_t>(height)) + " does not fit in " +
                   byte_count(bytes == nullptr ? 0 : bytes->size()));
}

/// Brightness of a colour, with the weights of ITU-R BT.601.
[[nodiscard]] inline unsigned brightness(unsigned red, unsigned green, unsigned blue) {
  return (299 * red + 587 * green + 114 * blue + 500) / 1000;
}

// Decodes depth images of the codec RVL: runs of pixels without and with depth, and differences of
// neighbours.
//
// Width and height come first, 32 bits each.  Then groups of four bits follow, eight in a 32-bit
// word, highest bits first.  A number consists of groups of three bits, lowest first; the fourth
// bit is set if more follow.  Differences have their sign in the lowest bit.
// Source: A. D. Wilson, "Fast Lossless Depth Image Compression", ISS 2017.

/// The numbers of a stream.
class RvlNumbers {
 public:
  explicit RvlNumbers(ByteReader words) : words_(words) {}

  /// @throws std::runtime_error  if the stream ends early, or the number has more than 32 bits
  [[nodiscard]] std::uint32_t next() {
    std::uint32_t number = 0;
    for (unsigned shift = 0;; shift += 3) {
      const std::uint32_t four = next_four();
      if (shift > 30 || (shift == 30 && (four & 7U) > 3U)) {
        throw std::runtime_error("compressed depth has a number of more than 32 bits");
      }
      number |= (four & 7U) << shift;
      if ((four & 8U) == 0) return number;
    }
  }

 private:
  [[nodiscard]] std::uint32_t next_four() {
    if (left_ == 0) {
      word_ = words_.number<std::uint32_t>();
      left_ = 8;
    }
    --left_;
    return (word_ >> (4U * left_)) & 15U;
  }

  ByteReader words_;
  std::uint32_t word_ = 0;
  unsigned left_ = 0;  ///< unread groups of the word
};

/// @param stream  width, height and runs
/// @returns       metres from 16-bit millimetres; NaN for pixels without depth
/// @throws std::runtime_error  if it is truncated or does not match its size
[[nodiscard]] inline DepthImage decode_rvl(std::string_view stream) {
  constexpr float kMillimetre = 1e-3F;
  ByteReader bytes(as_bytes(stream));
  const auto width = bytes.number<std::uint32_t>(), height = bytes.number<std::uint32_t>();
  if (std::uint64_t{width} * height > kMostPixels) {
    throw std::runtime_error("compressed depth has " + std::to_string(width) + " x " +
                             std::to_string(height) + " pixels");
  }
  DepthImage depth(static_cast<int>(width), static_cast<int>(height));
  RvlNumbers numbers(bytes);
  std::uint32_t previous = 0;
  const std::size_t all = depth.pixels.size();
  for (std::size_t at = 0; at < all;) {
    const std::size_t without = numbers.next(), with = numbers.next();
    if (without > all - at || with > all - at - without || without + with == 0) {
      throw std::runtime_error("compressed depth does not fit its size");
    }
    for (std::size_t end = at + without; at < end; ++at) depth.pixels[at] = no_point().z();
    for (std::size_t end = at + with; at < end; ++at) {
      const std::uint32_t difference = numbers.next();
      previous += (difference >> 1U) ^ (0U - (difference & 1U));
      const auto z = static_cast<std::uint16_t>(previous);
      depth.pixels[at] = z > 0 ? static_cast<float>(z) * kMillimetre : no_point().z();
    }
  }
  return depth;
}

// Depth from images, raw and compressed.

/// The bytes of a sensor_msgs/CompressedImage; nullopt for other messages.
[[nodiscard]] inline std::optional<std::string_view> compressed(const MessageFields& message) {
  const MessageValue* data = field_at(message, "data");
  const auto* bytes = data == nullptr ? nullptr : data->as<Bytes>();
  if (field_at(message, "format") == nullptr || bytes == nullptr) return std::nullopt;
  return std::string_view(reinterpret_cast<const char*>(bytes->data()), bytes->size());
}

/// A 16-bit PNG, or RVL, after the header of the transport compressedDepth: a 4-byte number, then a
/// and b for 32FC1, whose pixels are a / depth + b.
[[nodiscard]] inline DepthImage compressed_depth(std::string_view file, std::string_view format) {
  constexpr std::size_t kSettings = 12;
  constexpr float kMetre = 1000.0F;
  const bool metres = format.starts_with("32FC1");
  const bool rvl = format.find("rvl") != std::string_view::npos;
  float a = 0.0F, b = 0.0F;
  if (metres || format.find("compressedDepth") != std::string_view::npos) {
    ByteReader settings(as_bytes(file));
    settings.skip(4);
    a = settings.number<float>();
    b = settings.number<float>();
    file.remove_prefix(kSettings);
  }
  DepthImage depth = rvl ? decode_rvl(file) : decode_depth(file, "the image");
  if (!metres) return depth;
  for (float& z : depth.pixels) {
    const float near = std::round(z * kMetre) - b;
    z = near > 0.0F && a > 0.0F ? a / near : no_point().z();
  }
  return depth;
}

DepthImage depth_image(const MessageFields& message) {
  if (const auto file = compressed(message)) {
    return compressed_depth(*file, text_at(message, "format"));
  }
  const std::string_view encoding = text_at(message, "encoding");
  const bool metres = encoding == "32FC1";
  if (!metres && encoding != "16UC1" && encoding != "mono16") {
    throw std::runtime_error("depth of encoding '" + printable(encoding) +
                             "' is not supported; expected 16UC1 or 32FC1");
  }
  const MessageRows rows = rows_of(message, "step", metres ? sizeof(float) : 2);
  DepthImage depth(rows.width, rows.height);
  for (int v = 0; v < rows.height; ++v) {
    ByteReader row = rows.at(v, 0);
    for (int u = 0; u < rows.width; ++u) {
      constexpr float kMillimetre = 1e-3F;
      const float z = metres ? row.number<float>()
                             : static_cast<float>(row.number<std::uint16_t>()) * kMillimetre;
      depth(u, v) = z > 0.0F && std::isfinite(z) ? z : no_point().z();
    }
  }
  return depth;
}

bool is_depth(std::string_view encoding) {
  return encoding.starts_with("16UC1") || encoding.starts_with("32FC1");
}

// Point clouds from sensor_msgs/PointCloud2.

/// A number in each point.
struct PointField {
  std::size_t offset = 1 << 20;       ///< bytes; beyond any point: absent
  std::size_t bytes = sizeof(float);  ///< 4, or 8 for a double
};

/// A field of each point, as a number of 4 bytes or a double.
[[nodiscard]] inline PointField point_field(const MessageFields& cloud, std::string_view name) {
  constexpr double kUint32 = 6, kFloat32 = 7, kFloat64 = 8;
  for (const MessageValue& item : list_at(cloud, "fields")) {
    const auto* field = item.as<MessageFields>();
    if (field == nullptr || text_at(*field, "name") != name) continue;
    const double type = number_at(*field, "datatype");
    if (type != kUint32 && type != kFloat32 && type != kFloat64) continue;
    return {static_cast<std::size_t>(number_at(*field, "offset")),
            type == kFloat64 ? sizeof(double) : sizeof(float)};
  }
  return {};
}

/// @param point  first byte in the row
[[nodiscard]] inline float float_at(const MessageRows& rows, int row, std::size_t point,
                                    const PointField& field) {
  ByteReader bytes = rows.at(row, point + field.offset);
  return field.bytes == sizeof(double) ? static_cast<float>(bytes.number<double>())
                                       : bytes.number<float>();
}

void read_cloud(const MessageFields& cloud, PointCloud& points, GrayImage& image) {
  const PointField x = point_field(cloud, "x"), y = point_field(cloud, "y"),
                   z = point_field(cloud, "z");
  const std::size_t rgb =
      std::min(point_field(cloud, "rgb").offset, point_field(cloud, "rgba").offset);
  const auto point_step = static_cast<std::size_t>(number_at(cloud, "point_step"));
  for (const PointField& field : {x, y, z}) {
    if (field.offset + field.bytes <= point_step) continue;
    throw std::runtime_error(
        "the cloud has no float32 or float64 fields x, y, z within its points");
  }
  const MessageRows rows = rows_of(cloud, "row_step", point_step);
  const bool has_colour = image.empty() && rgb + sizeof(float) <= point_step;
  points = PointCloud(rows.width, rows.height, no_point());
  if (has_colour) image = GrayImage(rows.width, rows.height);
  for (int v = 0; v < rows.height; ++v) {
    for (int u = 0; u < rows.width; ++u) {
      const std::size_t at = static_cast<std::size_t>(u) * point_step;
      const float px = float_at(rows, v, at, x), py = float_at(rows, v, at, y),
                  pz = float_at(rows, v, at, z);
      if (std::isfinite(px) && std::isfinite(py) && std::isfinite(pz)) points(u, v) << px, py, pz;
      if (!has_colour) continue;
      constexpr unsigned kByte = 0xff;
      const auto c = rows.at(v, at + rgb).number<std::uint32_t>();
      image(u, v) =
          static_cast<std::uint8_t>(brightness((c >> 16) & kByte, (c >> 8) & kByte, c & kByte));
    }
  }
}

/// Pixels of an encoding: their values, and which of these are red, green and blue; all the same
/// for gray, or for brightness beside two colours.
struct PixelForm {
  std::string_view name;
  std::size_t values, red, green, blue;
  std::size_t bytes = 1;  ///< of a value
};

inline constexpr std::array kPixelForms = {
    PixelForm{"mono8", 1, 0, 0, 0},       PixelForm{"8UC1", 1, 0, 0, 0},
    PixelForm{"rgb8", 3, 0, 1, 2},        PixelForm{"8UC3", 3, 2, 1, 0},
    PixelForm{"bgr8", 3, 2, 1, 0},        PixelForm{"rgba8", 4, 0, 1, 2},
    PixelForm{"bgra8", 4, 2, 1, 0},       PixelForm{"8UC4", 4, 2, 1, 0},
    PixelForm{"yuv422", 2, 1, 1, 1},      PixelForm{"uyvy", 2, 1, 1, 1},
    PixelForm{"yuv422_yuy2", 2, 0, 0, 0}, PixelForm{"yuyv", 2, 0, 0, 0},
    PixelForm{"nv12", 1, 0, 0, 0},        PixelForm{"nv21", 1, 0, 0, 0},
    PixelForm{"nv24", 1, 0, 0, 0},        PixelForm{"mono16", 1, 0, 0, 0, 2},
    PixelForm{"16UC1", 1, 0, 0, 0, 2},    PixelForm{"rgb16", 3, 0, 1, 2, 2},
    PixelForm{"bgr16", 3, 2, 1, 0, 2},    PixelForm{"16UC3", 3, 2, 1, 0, 2},
    PixelForm{"rgba16", 4, 0, 1, 2, 2},   PixelForm{"bgra16", 4, 2, 1, 0, 2},
    PixelForm{"16UC4", 4, 2, 1, 0, 2}};

inline constexpr std::array<std::string_view, 4> kBayer = {"bayer_rggb", "bayer_bggr", "bayer_gbrg",
                                                           "bayer_grbg"};

/// @throws std::runtime_error  if the encoding is not one of gray or colour images
[[nodiscard]] inline PixelForm pixel_form(std::string_view encoding) {
  for (const std::string_view bayer : kBayer) {
    if (!encoding.starts_with(bayer)) continue;
    const std::string_view bits = encoding.substr(bayer.size());
    if (bits == "8") return {bayer, 1, 0, 0, 0, 1};
    if (bits == "16") return {bayer, 1, 0, 0, 0, 2};
  }
  for (const PixelForm& form : kPixelForms) {
    if (form.name == encoding) return form;
  }
  throw std::runtime_error("images of encoding '" + printable(encoding) +
                           "' are not supported; expected gray, colour, Bayer or YUV 4:2:2 of 8 or "
                           "16 bits");
}

/// Brightness of all pixels, 0 to 255, or to 65535 for 16 bits.
[[nodiscard]] inline Image<std::uint16_t> values_of(const MessageRows& rows,
                                                    const PixelForm& form) {
  Image<std::uint16_t> image(rows.width, rows.height);
  const std::size_t low = form.bytes == 2 && rows.order == std::endian::big ? 1 : 0;
  const auto value = [&](const std::byte* pixel, std::size_t i) {
    const std::byte* at = pixel + i * form.bytes;
    if (form.bytes == 1) return std::to_integer<unsigned>(*at);
    return std::to_integer<unsigned>(at[low]) | std::to_integer<unsigned>(at[1 - low]) << 8U;
  };
  for (int v = 0; v < rows.height; ++v) {
    const std::byte* pixel = rows.data.data() + static_cast<std::size_t>(v) * rows.step;
    for (int u = 0; u < rows.width; ++u, pixel += form.values * form.bytes) {
      const unsigned red = value(pixel, form.red);
      image(u, v) = static_cast<std::uint16_t>(
          form.red == form.blue
              ? red
              : brightness(red, value(pixel, form.green), value(pixel, form.blue)));
    }
  }
  return image;
}

/// Weights 1 2 1 along rows and columns: on a mosaic, red and blue have a quarter and green a half
/// of every pixel, whatever its colour.
[[nodiscard]] inline Image<std::uint16_t> smoothed(const Image<std::uint16_t>& mosaic) {
  Image<std::uint16_t> smooth(mosaic.width, mosaic.height);
  const auto mirrored = [](int i, int size) {  // at the border; keeps the colour
    return size < 2 ? 0 : i < 0 ? 1 : i >= size ? size - 2 : i;
  };
  for (int v = 0; v < mosaic.height; ++v) {
    const std::array<int, 3> rows = {mirrored(v - 1, mosaic.height), v,
                                     mirrored(v + 1, mosaic.height)};
    for (int u = 0; u < mosaic.width; ++u) {
      const int left = mirrored(u - 1, mosaic.width), right = mirrored(u + 1, mosaic.width);
      unsigned sum = 8;  // half of the divisor
      for (int k = 0; k < 3; ++k) {
        const int row = rows[static_cast<std::size_t>(k)];
        const unsigned line = mosaic(left, row) + 2U * mosaic(u, row) + mosaic(right, row);
        sum += k == 1 ? 2 * line : line;
      }
      smooth(u, v) = static_cast<std::uint16_t>(sum / 16);
    }
  }
  return smooth;
}

/// Number of used bits beyond 8 in 16-bit values: cameras of 10, 12 and 14 bits leave the upper
/// ones unused.
[[nodiscard]] inline int spare_bits(const Image<std::uint16_t>& image) {
  const auto most = *std::max_element(image.pixels.begin(), image.pixels.end());
  int bits = 2;
  while (bits < 8 && most >> (8 + bits) != 0) bits += 2;
  return bits;
}

GrayImage gray_image(const MessageFields& message) {
  if (const auto file = compressed(message)) {
    const std::string_view format = text_at(message, "format");
    const bool is_video = format.find("264") != std::string_view::npos ||
                          format.find("265") != std::string_view::npos ||
                          format.find("hevc") != std::string_view::npos;
    if (is_video) {
      throw std::runtime_error("its images are video, '" + printable(format) +
                               "', which is not read; record image_raw or JPEG instead");
    }
    return decode_image(*file, "the image");
  }
  const std::string_view encoding = text_at(message, "encoding");
  const PixelForm form = pixel_form(encoding);
  Image<std::uint16_t> values = values_of(rows_of(message, "step", form.values * form.bytes), form);
  if (encoding.starts_with("bayer_")) values = smoothed(values);
  const int shift = form.bytes == 1 ? 0 : spare_bits(values);
  GrayImage image(values.width, values.height);
  std::transform(values.pixels.begin(), values.pixels.end(), image.pixels.begin(),
                 [shift](std::uint16_t x) { return static_cast<std::uint8_t>(x >> shift); });
  return image;
}

}  // namespace kinecal::detail
