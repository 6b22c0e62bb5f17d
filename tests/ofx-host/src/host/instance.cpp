// What the instance of an effect answers to the plugin.

#include "instance.h"

#include <algorithm>

namespace rototoon_host {

int TestEffect::abort() {
  int left = controls().aborts_left;
  if (left < 0) return 0;
  return controls().aborts_left.fetch_sub(left > 0 ? 1 : 0) <= 0;
}

void TestEffect::getProjectSize(double &x, double &y) const {
  TestClip *out = clip("Output");
  x = (out->settings.x2 - out->settings.x1) * out->settings.aspect, y = out->settings.y2 - out->settings.y1;
}

void TestEffect::getProjectOffset(double &x, double &y) const {
  TestClip *out = clip("Output");
  x = out->settings.x1 * out->settings.aspect, y = out->settings.y1;
}

bool TestEffect::progressUpdate(double t) {
  controls().progress = std::max(controls().progress.load(), t);
  while (!meanwhile.empty()) {
    std::function<std::string()> event = meanwhile.front();
    meanwhile.pop_front();
    meanwhile_statuses.push_back(event());
  }
  int left = controls().cancels_left;
  if (left < 0) return true;
  return controls().cancels_left.fetch_sub(left > 0 ? 1 : 0) > 0;
}

void TestEffect::timeLineGotoTime(double time) {
  gone_to = time;
  OfxRectD region = {0, 0, 0, 0};
  getRegionOfDefinitionAction(time, {1, 1}, region);
}

} // namespace rototoon_host
