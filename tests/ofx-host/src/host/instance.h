// The instance of an effect and its clips, as the library wants them from a host.
#pragma once

#include "rototoon-ofx-host/src/host.h"
#include "rototoon-ofx-host/src/bridge.rs.h"
#include "library.h"
#include "controls.h"
#include "params.h"
#include "pixels.h"

#include <atomic>
#include <cmath>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace rototoon_host {

struct Frame {
  int width, height;
  std::vector<float> rgba;
};

class TestEffect;

class TestClip : public fx::ClipInstance {
public:
  TestClip(TestEffect *effect, fx::ClipDescriptor *descriptor);

  ClipSettings settings;
  std::map<double, Frame> frames;
  // Regions of definition on single frames, in pixels.
  std::map<double, OfxRectI> regions;
  std::shared_ptr<Buffer> target;
  bool has_interest = false;
  OfxRectD interest;

  const std::string &getUnmappedBitDepth() const override { return depth_; }
  const std::string &getUnmappedComponents() const override { return components_; }
  const std::string &getPremult() const override;
  double getAspectRatio() const override { return settings.aspect; }
  double getFrameRate() const override { return 24; }
  void getFrameRange(double &first, double &last) const override { first = settings.first, last = settings.last; }
  const std::string &getFieldOrder() const override { return none_; }
  bool getConnected() const override { return settings.connected; }
  double getUnmappedFrameRate() const override { return 24; }
  void getUnmappedFrameRange(double &first, double &last) const override { getFrameRange(first, last); }
  bool getContinuousSamples() const override { return false; }
  OfxRectD getRegionOfDefinition(OfxTime time) const override {
    OfxRectI r = region(time);
    return {r.x1 * settings.aspect, double(r.y1), r.x2 * settings.aspect, double(r.y2)};
  }
  // Sets Natron's property of the format.
  void set_format(const Bounds &format);
  fx::Image *getImage(OfxTime time, const OfxRectD *bounds) override;
  const std::string &findSupportedComp(const std::string &s) const override {
    // The library has no mapping for RGB.
    return isSupportedComponent(s) ? s : ClipInstance::findSupportedComp(s);
  }
  void adopt(const ClipSettings &s) {
    settings = s;
    depth_ = s.connected ? std::string(s.depth) : kOfxBitDepthNone;
    components_ = s.connected ? std::string(s.components) : kOfxImageComponentNone;
    premult_ = std::string(s.premultiplication);
  }
  OfxRectI region(OfxTime time) const {
    auto own = regions.find(time);
    return own == regions.end() ? OfxRectI{settings.x1, settings.y1, settings.x2, settings.y2} : own->second;
  }
  OfxRectI pixels(double scale, OfxTime time) const {
    OfxRectI r = region(time);
    return {int(std::floor(r.x1 * scale)), int(std::floor(r.y1 * scale)), int(std::ceil(r.x2 * scale)),
            int(std::ceil(r.y2 * scale))};
  }

private:
  TestEffect *effect_;
  std::string depth_, components_, premult_, none_ = kOfxImageFieldNone;
  std::shared_ptr<Buffer> draw(OfxTime time, const OfxRectI &bounds, double scale);
};

// Records the messages to the user.
template <class Base> class Recording : public Base {
public:
  using Base::Base;
  OfxStatus vmessage(const char *type, const char *, const char *format, va_list args) override {
    say(type, format, args);
    return kOfxStatOK;
  }
  OfxStatus setPersistentMessage(const char *type, const char *, const char *format, va_list args) override {
    say(type, format, args);
    return kOfxStatOK;
  }
  OfxStatus clearPersistentMessage() override { return kOfxStatOK; }
};

class TestEffect : public Recording<fx::Instance> {
public:
  TestEffect(fx::ImageEffectPlugin *plugin, fx::Descriptor &descriptor, const std::string &context)
      : Recording(plugin, descriptor, context, false) {}

  std::atomic<double> scale{1};
  // The time of the action.
  std::atomic<double> now{0};
  double gone_to = NAN;
  // What happens at the next update of a progress display, and the statuses of what has happened.
  std::deque<std::function<std::string()>> meanwhile;
  std::vector<std::string> meanwhile_statuses;

  TestClip *clip(const std::string &name) const { return dynamic_cast<TestClip *>(getClip(name)); }
  const std::string &getDefaultOutputFielding() const override {
    static const std::string none(kOfxImageFieldNone);
    return none;
  }
  int abort() override;
  fx::ClipInstance *newClipInstance(fx::Instance *, fx::ClipDescriptor *descriptor, int) override {
    return new TestClip(this, descriptor);
  }
  void getProjectSize(double &x, double &y) const override;
  void getProjectOffset(double &x, double &y) const override;
  void getProjectExtent(double &x, double &y) const override { getProjectSize(x, y); }
  double getProjectPixelAspectRatio() const override { return clip("Output")->settings.aspect; }
  double getEffectDuration() const override { return 100; }
  double getFrameRate() const override { return 24; }
  double getFrameRecursive() const override { return 0; }
  void getRenderScaleRecursive(double &x, double &y) const override { x = y = scale; }
  ofx::Param::Instance *newParam(const std::string &, ofx::Param::Descriptor &descriptor) override {
    return new_param(descriptor, this);
  }
  OfxStatus editBegin(const std::string &label) override { return history().begin(label), kOfxStatOK; }
  OfxStatus editEnd() override { return history().end(), kOfxStatOK; }
  void progressStart(const std::string &, const std::string &) override {}
  void progressEnd() override {}
  bool progressUpdate(double t) override;
  double timeLineGetTime() override { return 0; }
  // As in a real host, the viewer asks for the picture of the new time before this returns.
  void timeLineGotoTime(double time) override;
  void timeLineGetBounds(double &first, double &last) override { first = 0, last = 100; }
};

} // namespace rototoon_host
