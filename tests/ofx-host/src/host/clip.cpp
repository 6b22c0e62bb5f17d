// The pictures of a clip.

#include "instance.h"

#include <algorithm>
#include <cmath>

namespace rototoon_host {

namespace {

class FetchedImage : public fx::Image {
public:
  FetchedImage(fx::ClipInstance &clip, double scale, std::shared_ptr<Buffer> buffer, const OfxRectI &rod)
      : Image(clip, scale, scale, buffer->lowest_row(), buffer->bounds, rod, buffer->row_bytes(), kOfxImageFieldNone,
              "image"),
        buffer(buffer) {
    ++controls().live_images;
  }
  ~FetchedImage() override { --controls().live_images; }

private:
  std::shared_ptr<Buffer> buffer;
};

} // namespace

TestClip::TestClip(TestEffect *effect, fx::ClipDescriptor *descriptor)
    : ClipInstance(effect, *descriptor), effect_(effect) {
  ClipSettings s;
  s.depth = kOfxBitDepthFloat, s.components = kOfxImageComponentRGBA, s.premultiplication = kOfxImagePreMultiplied;
  s.connected = descriptor->isOutput() || !descriptor->isOptional();
  s.x1 = s.y1 = 0, s.x2 = 64, s.y2 = 48, s.aspect = 1, s.first = 0, s.last = 10;
  s.padding = s.margin = 0, s.top_down = false;
  adopt(s);
}

const std::string &TestClip::getPremult() const {
  return isOutput() ? effect_->getOutputPreMultiplication() : premult_;
}

void TestClip::set_format(const Bounds &format) {
  static const ofx::Property::PropSpec natron[] = {{"OfxImageClipPropFormat", ofx::Property::eInt, 4, false, "0"},
                                                   ofx::Property::propSpecEnd};
  if (!getProps().fetchProperty(natron[0].name)) getProps().addProperties(natron);
  const int sides[] = {format.x1, format.y1, format.x2, format.y2};
  for (int i = 0; i < 4; ++i) getProps().setIntProperty(natron[0].name, sides[i], i);
}

fx::Image *TestClip::getImage(OfxTime time, const OfxRectD *region) {
  if (controls().no_images || !settings.connected) return nullptr;
  if (!controls().temporal && time != effect_->now) return nullptr;
  // A host may give pixels at another scale than it says.
  double scale = effect_->scale * controls().real_scale;
  if (isOutput()) return target ? new FetchedImage(*this, scale, target, pixels(scale, time)) : nullptr;
  OfxRectI whole = pixels(scale, time), bounds = whole;
  const OfxRectD *asked = region ? region : has_interest ? &interest : nullptr;
  if (asked) {
    double x = scale / settings.aspect;
    bounds.x1 = std::max(whole.x1, int(std::floor(asked->x1 * x)) - settings.margin);
    bounds.y1 = std::max(whole.y1, int(std::floor(asked->y1 * scale)) - settings.margin);
    bounds.x2 = std::min(whole.x2, int(std::ceil(asked->x2 * x)) + settings.margin);
    bounds.y2 = std::min(whole.y2, int(std::ceil(asked->y2 * scale)) + settings.margin);
    if (bounds.x1 >= bounds.x2 || bounds.y1 >= bounds.y2) return nullptr;
  }
  return new FetchedImage(*this, scale, draw(time, bounds, scale), whole);
}

// The frame's picture at a scale. Each pixel is the mean of the full-size pixels that it covers. Pixels outside the frame
// are transparent.
std::shared_ptr<Buffer> TestClip::draw(OfxTime time, const OfxRectI &bounds, double scale) {
  auto buffer = std::make_shared<Buffer>(bounds, depth_of(getPixelDepth()), channels_of(getComponents()),
                                         settings.padding, settings.top_down);
  auto found = frames.find(time);
  OfxRectI own = region(time);
  int step = std::max(1, int(std::lround(1 / scale)));
  for (int y = bounds.y1; y < bounds.y2; ++y) {
    for (int x = bounds.x1; x < bounds.x2; ++x) {
      float pixel[4] = {0, 0, 0, 0};
      for (int j = 0; j < step * step && found != frames.end(); ++j) {
        int u = x * step + j % step - own.x1, v = y * step + j / step - own.y1;
        const Frame &frame = found->second;
        if (u < 0 || v < 0 || u >= frame.width || v >= frame.height) continue;
        for (int c = 0; c < 4; ++c) pixel[c] += frame.rgba[4 * (size_t(v) * frame.width + u) + c] / (step * step);
      }
      unsigned char *out = buffer->bytes.data() + buffer->offset(x, y);
      size_t n = buffer->channels;
      for (size_t c = 0; c < n; ++c) encode(buffer->depth, n == 1 ? pixel[3] : pixel[c], out + c * buffer->depth.size);
    }
  }
  return buffer;
}

} // namespace rototoon_host
