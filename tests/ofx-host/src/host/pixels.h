// Pixels in memory, in the depths of OpenFX.
#pragma once

#include "library.h"

#include <string>
#include <vector>

namespace rototoon_host {

const unsigned char kCanary = 0xCD;
const size_t kGuard = 4096;

struct Depth {
  std::string name;
  size_t size;
};

Depth depth_of(const std::string &name);
size_t channels_of(const std::string &components);
void encode(const Depth &depth, float value, unsigned char *out);
float decode(const Depth &depth, const unsigned char *in);

// Pixels in memory. Rows begin with the bottom or the top row, unused bytes follow each row, and guard bytes are on both
// sides.
struct Buffer {
  OfxRectI bounds;
  Depth depth;
  size_t channels, stride;
  bool top_down;
  std::vector<unsigned char> bytes;

  Buffer(OfxRectI b, Depth d, size_t c, int padding, bool top_down)
      : bounds(b), depth(d), channels(c), stride((b.x2 - b.x1) * c * d.size + padding), top_down(top_down),
        bytes(2 * kGuard + stride * std::max(b.y2 - b.y1, 0), kCanary) {}

  int rows() const { return bounds.y2 - bounds.y1; }
  size_t offset(int x, int y) const {
    int row = top_down ? bounds.y2 - 1 - y : y - bounds.y1;
    return kGuard + row * stride + (x - bounds.x1) * channels * depth.size;
  }
  unsigned char *lowest_row() { return bytes.data() + (rows() > 0 ? offset(bounds.x1, bounds.y1) : kGuard); }
  int row_bytes() const { return top_down ? -int(stride) : int(stride); }
};

} // namespace rototoon_host
