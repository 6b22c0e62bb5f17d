// Pixels from numbers, and numbers from pixels.

#include "rototoon-ofx-host/src/host.h"
#include "rototoon-ofx-host/src/bridge.rs.h"
#include "pixels.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace rototoon_host {

Depth depth_of(const std::string &name) {
  if (name == kOfxBitDepthByte) return {name, 1};
  if (name == kOfxBitDepthShort || name == kOfxBitDepthHalf) return {name, 2};
  return {name, 4};
}

size_t channels_of(const std::string &components) {
  if (components == kOfxImageComponentRGBA) return 4;
  if (components == kOfxImageComponentRGB) return 3;
  return 1;
}

void encode(const Depth &depth, float value, unsigned char *out) {
  float held = std::min(std::max(value, 0.0f), 1.0f);
  if (depth.name == kOfxBitDepthByte) {
    *out = static_cast<unsigned char>(std::lround(held * 255));
  } else if (depth.name == kOfxBitDepthShort) {
    unsigned short v = static_cast<unsigned short>(std::lround(held * 65535));
    memcpy(out, &v, 2);
  } else if (depth.name == kOfxBitDepthHalf) {
    uint16_t v = to_half(value);
    memcpy(out, &v, 2);
  } else {
    memcpy(out, &value, 4);
  }
}

float decode(const Depth &depth, const unsigned char *in) {
  uint16_t two;
  float four;
  if (depth.name == kOfxBitDepthByte) return *in / 255.0f;
  memcpy(&two, in, 2);
  if (depth.name == kOfxBitDepthShort) return two / 65535.0f;
  if (depth.name == kOfxBitDepthHalf) return from_half(two);
  memcpy(&four, in, 4);
  return four;
}

} // namespace rototoon_host
