// Renders a window of an effect as hosts do, in tiles on several threads, and gives the picture to Rust.

#include "effect.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <thread>
#include <vector>

namespace rototoon_host {

rust::String Effect::render(double time, const Bounds &bounds, double scale, int threads, int tile_rows) {
  TestEffect *effect = impl->effect.get();
  TestClip *out = effect->clip("Output");
  effect->scale = scale, effect->now = time;
  OfxPointD scales = {scale, scale};
  OfxRectI window = rect(bounds), larger = window;
  int margin = out->settings.margin;
  larger.x1 -= margin, larger.y1 -= margin, larger.x2 += margin, larger.y2 += margin;
  out->target = std::make_shared<Buffer>(larger, depth_of(out->getPixelDepth()), channels_of(out->getComponents()),
                                         out->settings.padding, out->settings.top_down);
  impl->output = out->target;
  impl->window = window;
  double aspect = out->settings.aspect;
  OfxRectD region = {window.x1 / scale * aspect, window.y1 / scale, window.x2 / scale * aspect, window.y2 / scale};
  std::map<fx::ClipInstance *, OfxRectD> interests;
  effect->getRegionOfInterestAction(time, scales, region, interests);
  for (auto &entry : interests) {
    TestClip *clip = dynamic_cast<TestClip *>(entry.first);
    clip->interest = entry.second, clip->has_interest = true;
  }
  OfxStatus begun = effect->beginRenderAction(time, time, 1, false, scales, true, false);
  if (begun != kOfxStatOK && begun != kOfxStatReplyDefault) return status_name(begun);
  std::vector<OfxRectI> tiles;
  int rows = tile_rows > 0 ? tile_rows : std::max(window.y2 - window.y1, 1);
  for (int y = window.y1; y < window.y2 || tiles.empty(); y += rows)
    tiles.push_back({window.x1, y, window.x2, std::min(y + rows, window.y2)});
  std::atomic<size_t> next{0};
  std::atomic<int> worst{kOfxStatOK};
  auto work = [&] {
    for (size_t i = next++; i < tiles.size(); i = next++) {
      OfxStatus status = effect->renderAction(time, kOfxImageFieldNone, tiles[i], scales, true, false, false);
      if (status != kOfxStatOK) worst = status;
    }
  };
  // Hosts draw the overlay on their own thread, also before and after the tiles.
  std::atomic<bool> done{false};
  std::thread viewer([&] {
    while (controls().viewer_draws && !done)
      if (text_of(overlay("OfxInteractActionDraw", true, time, Pen{0, 0, 1, 0, 1})) != "kOfxStatOK") worst = kOfxStatFailed;
  });
  std::vector<std::thread> pool;
  for (int i = 1; i < threads; ++i) pool.emplace_back(work);
  work();
  for (std::thread &thread : pool) thread.join();
  done = true;
  viewer.join();
  effect->endRenderAction(time, time, 1, false, scales, true, false);
  out->target.reset();
  for (auto &entry : interests) dynamic_cast<TestClip *>(entry.first)->has_interest = false;
  effect->scale = 1;
  return status_name(worst);
}

Picture Effect::output() const {
  Picture picture;
  picture.damage = picture.untouched = picture.width = picture.height = picture.channels = 0;
  if (!impl->output) return picture;
  Buffer &buffer = *impl->output;
  std::vector<unsigned char> rest = buffer.bytes;
  OfxRectI w = impl->window;
  size_t n = buffer.channels, pixel = n * buffer.depth.size;
  picture.width = std::max(w.x2 - w.x1, 0), picture.height = std::max(w.y2 - w.y1, 0), picture.channels = n;
  for (int y = w.y1; y < w.y2; ++y) {
    for (int x = w.x1; x < w.x2; ++x) {
      unsigned char *at = rest.data() + buffer.offset(x, y);
      // A short pixel may have the canary's value by chance.
      bool touched = pixel < 12;
      for (size_t i = 0; i < pixel; ++i) touched = touched || at[i] != kCanary;
      picture.untouched += !touched;
      for (size_t c = 0; c < n; ++c) picture.values.push_back(decode(buffer.depth, at + c * buffer.depth.size));
      std::fill(at, at + pixel, kCanary);
    }
  }
  for (unsigned char byte : rest) picture.damage += byte != kCanary;
  return picture;
}

} // namespace rototoon_host
